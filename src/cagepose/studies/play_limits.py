"""The gaps that limit an end of the play, by name (7.11)."""

from __future__ import annotations

from dataclasses import dataclass

from cagepose.kernels.algebra.record import empty_rows
from cagepose.kernels.play.clearances import LimitingGap, find_limiting_gaps
from cagepose.kernels.play.extreme import Extreme
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.model.scene import Scene
from cagepose.studies.play_frame import PlayFrame


@dataclass(frozen=True, eq=False)
class Clearance:
    """A gap that limits an end of the play.

    Attributes
    ----------
    point, box
        Names; of two boxes that are flush there, the first.
    gap_m
        At the start, to the face that limits, metres.
    closing, opening
        How much nearer the end comes for each metre that the gap is closed, and how much farther it goes for each
        metre that it is opened: radians or metres. They differ where other points limit the end as well.
    """

    point: str
    box: str
    gap_m: float
    closing: float
    opening: float

    def __repr__(self) -> str:
        worth = f"closing {self.closing:.4g}, opening {self.opening:.4g}"
        return f"<Clearance of {self.point!r} to {self.box!r}: {self.gap_m:.6g} m; {worth}>"


def limiting_clearances(scene: Scene, frame: PlayFrame, goal: Goal, extreme: Extreme) -> tuple[Clearance, ...]:
    """Return what limits a goal at the extreme that was found for it, the gap that is best to close first."""
    work = empty_play_workspace(frame.geometry)
    gaps = empty_rows(LimitingGap, len(work.faces))
    n_gaps = find_limiting_gaps(frame.geometry, goal, extreme, gaps, work)
    per_metre = 1.0 if goal.kind == SHIFT else 1.0 / frame.length_m
    found = [
        Clearance(
            scene.cage.names[work.points[gap.pair]],
            str(scene.object.boxes[work.boxes[gap.pair]].name),
            frame.length_m * float(gap.gap),
            per_metre * float(gap.closing),
            per_metre * float(gap.opening),
        )
        for gap in (gaps[index] for index in range(n_gaps))
    ]
    return tuple(sorted(found, key=lambda clearance: (-clearance.closing, -clearance.opening)))
