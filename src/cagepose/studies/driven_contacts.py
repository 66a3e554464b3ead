"""What touches at a place of a drive, and how it goes on there: `DrivenContacts`, in plain NumPy, from a run's scene.

Contacts of points with boxes, drifts and growth of the load, (8.1), are found anew: none of this is shared with the
kernels. Where other shapes touch is what the kernels find.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice, product
from typing import Any

import numpy as np

from cagepose.errors import CertificateError
from cagepose.kernels.boundary.geometry import empty_cage
from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.kernels.contact.loads import SPRING
from cagepose.kernels.driven.bodies import BEFORE_LEG_ENDS
from cagepose.kernels.outcome.at_pose import find_touching
from cagepose.kernels.stability.proof import empty_proof_workspace
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import actions_of, cage_middle
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.drives import PhaseWay, displaced_at, way_in
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run
from cagepose.studies.contact_problem import ContactProblem, problem_of
from cagepose.studies.touched_faces import touched_faces
from cagepose.studies.touched_shapes import touches_of


@dataclass(frozen=True, eq=False)
class DrivenContacts:
    """Contacts at one place of a drive.

    Attributes
    ----------
    problem
        The contacts that count there, and the load.
    drifts
        How fast each closes, and slips along its two tangents, where the object stands still, (n, 3), metres for all of
        the drive (8.1).
    growth
        How the load grows as springs ride on bodies, force and moment about the centre of gravity in the world, (6,),
        newtons and newton metres for all of the drive; zero: it does not.
    fastest
        How fast the fastest body goes, metres for all of the drive; what turns, at the object's reach.
    """

    problem: ContactProblem
    drifts: FloatArray
    growth: FloatArray
    fastest: float

    @property
    def speed(self) -> float:
        """What a motion is measured by: the fastest drift, or where there is none, the fastest body; metres."""
        return float(np.linalg.norm(self.drifts, axis=1).max(initial=0.0)) or self.fastest or 1.0

    @property
    def growth_size(self) -> float:
        """Length of the growth, scaled as in (5.3)."""
        return float(np.linalg.norm(self.problem.scaled(self.growth)))

    def choices(self) -> list[tuple[int, ...]] | None:
        """Return all choices of one contact of each group; None: there are more than 729."""
        found = list(islice(product(*reversed(self.problem.groups)), CHOICES_LIMIT + 1))
        return None if len(found) > CHOICES_LIMIT else [tuple(reversed(choice)) for choice in found]


class DriveContacts:
    """All places of the drive of a phase of a run, by their rows in `Curve`."""

    def __init__(self, run: Run, phase: int) -> None:
        drive = run.phases[phase].drive
        assert drive is not None
        self.phase, self.scene, self.curve = phase, run.scene, drive.curve
        self.ways = [way_in(one) for one in run.phases[:phase]]
        self.friction = chosen_method(run.scene, run.method).friction(run.scene)
        self.cage, self.at = empty_cage(run.scene.geometry), empty_proof_workspace(run.scene.geometry)

    def rows(self) -> list[int]:
        """Return the rows of the curve, one for each pose and share."""
        kept, before = list[int](), None
        for row, (share, position, turned) in enumerate(
            zip(self.curve.share, self.curve.position_m, self.curve.quaternion_wxyz, strict=True)
        ):
            place = (float(share), *position.tolist(), *turned.tolist())
            if place != before:
                kept.append(row)
            before = place
        return kept

    def share_of(self, row: int) -> float:
        """Return how much of the drive is done at a row of the curve."""
        return float(self.curve.share[row])

    def stand(self, row: int) -> Pose:
        """Let the kernels find what touches at a row of the curve; return the object's pose there.

        Raises
        ------
        CertificateError
            There are more contacts than there is memory for.
        """
        pose = Pose.from_unit(self.curve.position_m[row], self.curve.quaternion_wxyz[row])
        cases = cases_of(self.scene, self.friction, pose, self._displaced(row))
        if not find_touching(self.phase, part_of(self.scene), cases, self.cage, self.at):
            raise CertificateError(f"drive, row {row}: more faces touch at one place than a proof has room for")
        return pose

    def _displaced(self, row: int) -> FloatArray:
        return displaced_at(self.scene, [*self.ways, PhaseWay(self.share_of(row), {})])

    def at_row(self, row: int) -> DrivenContacts:
        """Return what touches at a row of the curve.

        Raises
        ------
        CertificateError
            There are more contacts than there is memory for.
        """
        scene, phase, share, displaced = self.scene, self.phase, self.share_of(row), self._displaced(row)
        pose = self.stand(row)
        if scene.has_other_shapes:
            contacts: Any = self.at.contacts
            touched = touches_of(scene, pose, self.at, int(contacts.used[0]))
        else:
            touched = touched_faces(scene, pose, displaced)
        problem = problem_of(scene, pose, phase, touched, self.friction, displaced)
        twists = _twists(scene, phase, share)
        elements = {name: number for number, name in enumerate(scene.cage.element_names)}
        bodies = [scene.cage.element_bodies[elements[face.point]] for face in problem.faces]
        velocities = np.array(
            [_velocity(twists[body], place) for body, place in zip(bodies, problem.places, strict=True)]
        )
        drifts = -np.einsum("ijk,ik->ij", problem.directions, velocities.reshape(-1, 3))
        speeds = [np.linalg.norm(_velocity(twist, cage_middle(scene))) for twist in twists]
        turns = [scene.object.reach_m * np.linalg.norm(twist[3:]) for twist in twists]
        growth = _growth(scene, phase, pose, displaced, twists)
        return DrivenContacts(problem, drifts, growth, float(max(*speeds, *turns)))


def _twists(scene: Scene, phase: int, share: float) -> FloatArray:
    """Return how each body goes on after a share of a phase, for all of it: velocity of its material at the world's
    origin and spin, in the world, (n_bodies, 6); the first is what stands still.
    """
    found, cage, drives = (
        np.zeros((1 + len(scene.cage.bodies), 6)),
        scene.cage.pose_world_cage,
        scene.loads[phase].drive,
    )
    for number, body in enumerate(scene.cage.bodies, start=1):
        legs = drives.get(body.name, ())
        if not legs:
            continue
        leg = legs[min(int((share + BEFORE_LEG_ENDS) * len(legs)), len(legs) - 1)]
        velocity = np.zeros(3) if leg.travel_m is None else cage.rotation @ leg.travel_m
        if leg.about_cage is not None and leg.through_cage_m is not None and leg.angle_rad is not None:
            spin = leg.angle_rad * (cage.rotation @ leg.about_cage)
            found[number, 3:] = spin
            velocity = velocity - np.cross(spin, cage.transform(leg.through_cage_m))
        found[number, :3] = velocity
        found[number] *= len(legs)
    return found


def _velocity(twist: FloatArray, place: FloatArray) -> FloatArray:
    return np.asarray(twist[:3] + np.cross(twist[3:], place))


def _growth(scene: Scene, phase: int, pose: Pose, displaced: FloatArray, twists: FloatArray) -> FloatArray:
    """Return how the load grows as the far ends of springs go along with bodies, see `DrivenContacts.growth`."""
    found, middle = np.zeros(6), cage_middle(scene)
    for action in actions_of(scene, displaced)[phase]:
        if action["kind"] != SPRING or action["body"] == 0:
            continue
        end, arm = action["anchor"] + middle, pose.rotation @ action["arm_object"]
        way = end - pose.transform(scene.object.center_of_gravity_m) - arm
        moves, stretched = _velocity(twists[action["body"]], end), float(np.linalg.norm(way))
        force = action["stiffness"] * moves
        if action["tension_at_zero"] != 0.0 and stretched > 0.0:  # what it pulls with beside turns with it
            across = moves - way * (way @ moves) / stretched**2
            force = force + action["tension_at_zero"] / stretched * across
        found[:3] += force
        found[3:] += np.cross(arm, force)
    return found
