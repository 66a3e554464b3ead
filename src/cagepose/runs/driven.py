"""What came of a drive, `DriveRun`: how far it got and which forces it took; and of what presses, `PressRun`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.wording import number_of


@dataclass(frozen=True, eq=False)
class BodyRun:
    """How far a body of the cage was driven, or went as it pressed, in a phase, and what drives it at the end.

    Attributes
    ----------
    pose_cage_body
        Where it is at the end, in the cage's frame.
    travel_m, angle_rad
        How far it got: all its travels, and all its turns. Of what presses below zero where it gave way.
    force_n, moment_nm
        What the driver does to it, in the world, (3,) each, the moment about the body's origin. Newtons, or unit loads
        as `Contact.force_normal_n`.
    along
        The work of these for a unit of travel (of a pure turn: for a radian), above zero where the driver pushes. Of
        what presses: with how much force; the rest of ``force_n`` comes from what guides it.
    """

    pose_cage_body: Pose
    travel_m: float
    angle_rad: float
    force_n: FloatArray
    moment_nm: FloatArray
    along: float

    def __repr__(self) -> str:
        return f"<BodyRun: {self.travel_m:.6g} m, {self.angle_rad:.6g} rad, {self.along:.6g} along>"


@dataclass(frozen=True, eq=False)
class Curve:
    """What was found along a drive, one row for each place that was asked.

    Attributes
    ----------
    share
        How much of the drive was done, (n,), from 0 to 1; where the object snaps the same number comes again.
    along
        The sum of the drivers' forces along their ways, (n,).
    position_m, quaternion_wxyz
        The object's pose in the world, (n, 3) and (n, 4).
    """

    share: Annotated[FloatArray, (-1,)]
    along: Annotated[FloatArray, (-1,)]
    position_m: Annotated[FloatArray, (-1, 3)]
    quaternion_wxyz: Annotated[FloatArray, (-1, 4)]

    def __repr__(self) -> str:
        return f"<Curve of {number_of(len(self.share), 'place')}>"

    def places(self) -> Iterator[tuple[float, float, Pose]]:
        """Yield share, sum of the forces along their ways, and the object's pose, place by place."""
        poses = map(Pose.from_unit, self.position_m, self.quaternion_wxyz)
        yield from zip(self.share.tolist(), self.along.tolist(), poses, strict=True)


@dataclass(frozen=True, eq=False)
class DriveRun:
    """A drive as far as it went.

    Attributes
    ----------
    share
        How much of it was done, from 0 to 1.
    along
        The sum of the drivers' forces along their ways at the end.
    greatest_along, greatest_share
        The greatest such sum, and where.
    work_j
        Work of the drivers.
    friction_j, snaps_j
        What of it friction took, and what was lost where the object snapped.
    bodies
        By name, those that were driven.
    curve
        All along the way.
    jam_possible
        From which shares to which it could jam: forces in the cones could stand against the drive and grow without
        bound, though it went on. Each place of the curve is asked, with the contacts that it has.
    critical_jam_friction
        The least coefficient of friction with which it could jam at one of these places; None: it cannot at any. Below
        it a jam is ruled out there: some motion gives way to every force that the contacts could have.
    """

    share: float
    along: float
    greatest_along: float
    greatest_share: float
    work_j: float
    friction_j: float
    snaps_j: float
    bodies: dict[str, BodyRun]
    curve: Curve
    jam_possible: tuple[tuple[float, float], ...] = ()
    critical_jam_friction: float | None = None

    def __repr__(self) -> str:
        return f"<DriveRun: {self.share:.6g} of the way, {self.along:.6g} along, at most {self.greatest_along:.6g}>"


@dataclass(frozen=True, eq=False)
class PressRun:
    """What the bodies did that press in a phase.

    Attributes
    ----------
    bodies
        By name: where each is at the end, and what pushes it there.
    share, travels_m
        How much of all their ways was done at each step, (n,), from 0 to 1, and how far each had gone, (n, n_bodies).
    """

    bodies: dict[str, BodyRun]
    share: Annotated[FloatArray, (-1,)]
    travels_m: Annotated[FloatArray, (-1, -1)]

    def __repr__(self) -> str:
        ways = ", ".join(f"{name} {body.travel_m:.6g} m, {body.along:.6g}" for name, body in self.bodies.items())
        return f"<PressRun: {ways}>"

    def ways_at(self, share: float) -> dict[str, float]:
        """Return how far each body has gone, metres, after a share of all their ways."""
        ways = [float(np.interp(share, [0.0, *self.share], [0.0, *travels])) for travels in self.travels_m.T]
        return dict(zip(self.bodies, ways, strict=True))
