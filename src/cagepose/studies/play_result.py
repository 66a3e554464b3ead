"""How far the object can move inside its cage, and what limits it: `Play`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import coordinates, few, number_of
from cagepose.studies.cage_verdict import CageVerdict
from cagepose.studies.play_limits import Clearance

EndStatus = Literal["proven", "local", "not converged", "open"]


@dataclass(frozen=True, eq=False)
class PlayEnd:
    """One end of a range; angles in radians, lengths in metres.

    Attributes
    ----------
    linear
        Over the polytope (7.1); None: without end, or not found, as of shapes other than boxes and points.
    reached
        The farthest that the searches came (7.5), beyond all points; None: without end.
    certified
        No motion inside the cage passes this (7.7); None: not proven.
    status
        "local": no motion nearby goes farther, to first order (7.14); "proven": besides, `certified` says that none
        inside the cage goes farther by more than a hundredth; "not converged": neither is known, and the end may lie
        beyond `reached`; "open": there is no end.
    """

    linear: float | None
    reached: float | None
    certified: float | None
    status: EndStatus
    _find_pose: Callable[[], Pose | None] = field(repr=False)
    _find_clearances: Callable[[], tuple[Clearance, ...]] = field(repr=False)

    def __repr__(self) -> str:
        return f"<PlayEnd: {_end(self)} ({self.status})>"

    @property
    def exact(self) -> float | None:
        """The end, local or proven; None: without end, or not converged."""
        return self.reached if self.status in ("local", "proven") else None

    @property
    def is_open(self) -> bool:
        """Whether the end is known to lie nowhere."""
        return self.status == "open"

    @cached_property
    def pose_world_object(self) -> Pose | None:
        """Has the value ``reached``; None: there is no end."""
        return self._find_pose()

    @cached_property
    def clearances(self) -> tuple[Clearance, ...]:
        """The gaps that limit the exact end, the one first that is best to close; found when first asked for."""
        return self._find_clearances()


@dataclass(frozen=True, eq=False)
class PlayRange:
    """The least and the greatest value of a freedom."""

    low: PlayEnd
    high: PlayEnd

    def __repr__(self) -> str:
        return f"<PlayRange: {_end(self.low)} to {_end(self.high)}>"


@dataclass(frozen=True, eq=False)
class PointPlay:
    """How far a point of the object can go: ``at_object`` (3,) metres, along the unit vector ``direction_cage``."""

    at_object: FloatArray
    direction_cage: FloatArray
    low: PlayEnd
    high: PlayEnd

    def __repr__(self) -> str:
        line = f"{coordinates(self.at_object)} m along {coordinates(self.direction_cage, 4)}"
        return f"<PointPlay of {line}: {_end(self.low)} to {_end(self.high)}>"


@dataclass(frozen=True, eq=False)
class Play:
    """All ranges, measured from the start pose in the cage's axes.

    Attributes
    ----------
    scene
        What was asked.
    freedoms
        "x", "y", "z": displacement of the object's origin; "roll", "pitch", "yaw": ZYX angles.
    points
        In the order asked.
    cage
        Whether it can get out; None where it is seated.
    held
        Freedoms that are held, by the scene's plane or as asked.
    seated
        The phase whose load holds it in its seat, from where all ranges are measured; None: none, from the start pose.
    analysis_s, certificate_s
        How long both took, seconds, without the search for a way out.
    """

    scene: Scene
    freedoms: dict[str, PlayRange]
    points: tuple[PointPlay, ...]
    cage: CageVerdict | None
    held: tuple[str, ...]
    seated: str | None
    analysis_s: float
    certificate_s: float

    def __repr__(self) -> str:
        asked = f"{few(self.freedoms, 6)}, {number_of(len(self.points), 'point')}"
        return f"<Play of {self.scene.name!r}: {self.verdict}; {asked}>"

    @property
    def verdict(self) -> str:
        """That of the cage, or "seated"."""
        return "seated" if self.cage is None else self.cage.verdict


def _end(end: PlayEnd) -> str:
    return "no end" if end.reached is None else f"{end.reached:.6g}"
