"""The gaps that limit an end of the play, by name (7.11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.kernels.algebra.linear_program import N_UNKNOWNS, OPTIMAL, Program, solve_program
from cagepose.kernels.algebra.record import empty_record, empty_rows
from cagepose.kernels.play.clearances import REACH_OF_PROGRAM, LimitingGap, find_limiting_gaps
from cagepose.kernels.play.extreme import Extreme
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.kernels.play.tolerances import LEAST_PRICE
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.studies.contact_cones import contact_cones
from cagepose.studies.play_frame import PlayFrame


@dataclass(frozen=True, eq=False)
class Clearance:
    """A gap that limits an end of the play.

    Attributes
    ----------
    point, box
        Names; of several boxes that touch the point or the shape, the first.
    gap_m
        At the start, to the face that limits, metres; None: not known, as of other shapes than boxes and points.
    closing, opening
        How much nearer the end comes for each metre that the gap is closed, and how much farther it goes for each
        metre that it is opened: radians or metres. They differ where other points limit the end as well.
    """

    point: str
    box: str
    gap_m: float | None
    closing: float
    opening: float

    def __repr__(self) -> str:
        worth = f"closing {self.closing:.4g}, opening {self.opening:.4g}"
        gap = "" if self.gap_m is None else f"{self.gap_m:.6g} m; "
        return f"<Clearance of {self.point!r} to {self.box!r}: {gap}{worth}>"


def limiting_clearances(scene: Scene, frame: PlayFrame, goal: Goal, extreme: Extreme) -> tuple[Clearance, ...]:
    """Return what limits a goal at the extreme that was found for it, the gap that is best to close first."""
    work = empty_play_workspace(frame.geometry, frame.held)
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


def pressed_clearances(
    scene: Scene, pose: Pose, contacts: np.ndarray, push: FloatArray, held: FloatArray
) -> tuple[Clearance, ...]:
    """Return what limits a push that rests: the work of forces that balance it is how far its end moves (7.11).

    Parameters
    ----------
    pose
        Where it rests.
    contacts
        That touch there, rows of `ContactRecord`.
    push
        Force, and moment about the centre of gravity, in the world, (6,), whose work is what the end is measured in.
    held
        1 for each freedom that is held, else 0, (6,).
    """
    cones = contact_cones(
        -contacts["normal"],
        contacts["place"] - pose.transform(scene.object.center_of_gravity_m),
        np.zeros(len(contacts)),
    )
    load = push / np.repeat([1.0, cones.length_m], 3)
    size = float(np.linalg.norm(load))
    found = []
    for point in np.unique(contacts["cage_part"]):
        together = contacts["cage_part"] == point
        closing = _loss(cones.columns[:, 0], load / size, together.astype(np.float64), held)
        if closing <= REACH_OF_PROGRAM * LEAST_PRICE:
            continue
        opening = -_loss(cones.columns[:, 0], load / size, -together.astype(np.float64), held)
        box = contacts["part"][together][0]
        names = scene.cage.element_names[point], scene.object.element_names[box]
        found.append(Clearance(*names, None, size * closing, size * max(opening, 0.0)))
    return tuple(sorted(found, key=lambda clearance: (-clearance.closing, -clearance.opening)))


def _loss(normals: FloatArray, push: FloatArray, gaps: FloatArray, held: FloatArray) -> float:
    """Return how much less far a push comes when gaps are closed by so much, (n,); inf: they cannot be.

    Contacts in one line but for rounding would share their push uniquely, with arms that only a turn far beyond the
    play makes up for: no motion is greater than `REACH_OF_PROGRAM`.
    """
    program = empty_record(Program)
    program.objective[:] = push
    rows = np.concatenate([-normals, np.eye(N_UNKNOWNS), -np.eye(N_UNKNOWNS)])
    reach = np.where(held == 1.0, 0.0, REACH_OF_PROGRAM)
    bounds = np.concatenate([-gaps, reach, reach])
    outcome = solve_program(rows, bounds, program)
    return -float(push @ program.x) if outcome == OPTIMAL else np.inf
