"""Without friction each rest along a drive is a local minimum of the potential where the bodies stand then: SLSQP.

Potential and gaps are written anew here. Of two convex bodies the gap is that of all corners of one to one face of the
other, the face that parts them most: no pose that keeps it is one in which they overlap.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from scipy.optimize import minimize

from cagepose import Box, Convex, Load, Pose, Scene, Sphere, Spring, run
from cagepose.model.checks import FloatArray
from cagepose.runs.actions import load_size
from cagepose.runs.drives import displaced_by
from driven.driven_scenes import DOWN, jaws, lever, truss, wedge
from driven.insertions import LENGTH, MM, RADIUS, Insertion

PLACES = 10
DISTURBED, NEAR = 2e-3, 0.05
"""By how much, and how far SLSQP may go, in sizes of the part and radians."""
SAME, OUTSIDE = 1e-9, 1e-8
"""Potentials in load times size; and gaps in sizes."""
RIM = 72
"""Points of a circle."""

Gaps = Callable[[Pose], FloatArray]


def planes(shape: Box | Convex) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return corners, outward normals and one point of each face, in the frame of the shape's body."""
    place = shape.pose_body_shape
    if isinstance(shape, Box):
        normals = np.vstack([np.eye(3), -np.eye(3)])
        corners, points = shape.corners_object(), place.transform(0.5 * normals * shape.size_m)
    else:
        corners, normals = place.transform(shape.hull.vertices_m), shape.hull.normals
        points = place.transform(np.array([shape.hull.vertices_m[face[0]] for face in shape.hull.faces]))
    return corners, normals @ place.rotation.T, points


def beyond(face: Box | Convex, points: FloatArray) -> FloatArray:
    """Return how far points, (n, 3), are beyond each of its faces, (faces, n)."""
    _, normals, on_face = planes(face)
    heights: FloatArray = normals @ points.T - np.einsum("ij,ij->i", normals, on_face)[:, None]
    return heights


def gaps_between(part: Box | Convex, other: Box | Convex | Sphere, at: Pose, displaced: Pose) -> Gaps:
    """Return the gaps of a solid of the part to one of the cage, which is displaced, near a pose of the part."""

    def of_part(pose: Pose) -> FloatArray:
        middle = displaced.transform(other.pose_body_shape.position_m)[None] if isinstance(other, Sphere) else None
        corners = displaced.transform(planes(other)[0]) if middle is None else middle
        return beyond(part, pose.inverse_transform(corners)) - (other.radius_m if isinstance(other, Sphere) else 0.0)

    def of_other(pose: Pose) -> FloatArray:
        assert not isinstance(other, Sphere)
        return beyond(other, displaced.inverse_transform(pose.transform(planes(part)[0])))

    found = of_part(at).min(axis=1)
    if not isinstance(other, Sphere):
        others = of_other(at).min(axis=1)
        if others.max() > found.max():
            return lambda pose: of_other(pose)[int(np.argmax(others))]
    return lambda pose: of_part(pose)[int(np.argmax(found))]


def gaps_in_hole(radius_m: float) -> Gaps:
    """Return the gaps of a peg of `Insertion` in its hole: its tip's circle in the wall, the mouth about the peg."""
    angles = np.arange(RIM) * 2.0 * math.pi / RIM
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(RIM)], axis=1)

    def gaps(pose: Pose) -> FloatArray:
        axis = pose.rotation[:, 2]
        across = np.cross(axis, (0.0, -1.0, 0.0))  # it must not matter how far the peg is turned about its axis
        across /= np.linalg.norm(across)
        turned = circle @ np.stack([across, np.cross(axis, across), axis])
        tip = pose.position_m + RADIUS * MM * turned - 0.5 * LENGTH * MM * axis
        mouth = pose.inverse_transform(radius_m * circle)
        return np.concatenate(
            [radius_m - np.hypot(tip[:, 0], tip[:, 1]), np.hypot(mouth[:, 0], mouth[:, 1]) - RADIUS * MM]
        )

    return gaps


def gaps_at(scene: Scene, pose: Pose, displaced: dict[str, Pose]) -> Gaps:
    """Return all gaps of a part near a pose, with the bodies of the cage where they are driven to."""
    if scene.cage.holes:
        return gaps_in_hole(scene.cage.holes[0].radius_m)
    moved = [Pose(), *(displaced[body.name] for body in scene.cage.bodies)]
    bodies = scene.cage.element_bodies[len(scene.cage.names) :]
    every = [
        gaps_between(part, other, pose, moved[body])
        for part in scene.object.parts
        for other, body in zip(scene.cage.shapes, bodies, strict=False)
    ]
    return lambda pose: np.concatenate([gaps(pose) for gaps in every])


def potential(scene: Scene, load: Load, displaced: dict[str, Pose], pose: Pose) -> float:
    """Of weight and springs, joules."""
    held = scene.object
    value = 0.0
    if load.gravity_world is not None:
        value -= (held.mass_kg or 0.0) * float(load.gravity_world @ pose.transform(held.center_of_gravity_m))
    for spring in load.springs:
        end = scene.cage.spring_end_world(spring)
        at_start = float(np.linalg.norm(end - held.pose_world_object.transform(spring.at_object_m)))
        far = end if spring.of is None else displaced[spring.of].transform(end)
        longer = float(np.linalg.norm(far - pose.transform(spring.at_object_m))) - at_start
        value += spring.preload_n * longer + 0.5 * spring.stiffness_n_per_m * longer**2
    return value


def moved(pose: Pose, step: FloatArray, size_m: float) -> Pose:
    """A pose moved by a travel, in sizes, and a turning vector, radians."""
    angle = float(np.linalg.norm(step[3:]))
    half = 0.5 * math.sin(0.5 * angle) / (0.5 * angle) if angle else 0.5
    turn = Pose((0, 0, 0), (math.cos(0.5 * angle), *(half * step[3:])))
    return Pose(pose.position_m + size_m * step[:3], (turn @ Pose((0, 0, 0), pose.quaternion_wxyz)).quaternion_wxyz)


def turned_by_jaws() -> Scene:
    """Frictionless jaws turn a block against two springs at its corners, which pull it back."""
    scene = jaws(angle_deg=20.0, friction=0.0)
    springs = [Spring((0.0, y, 0.0), (8.0 * y, 1.5 * y, 0.01), 300.0) for y in (0.02, -0.02)]
    load = Load("close", gravity=DOWN, springs=springs, drive=scene.loads[0].drive)
    return Scene(scene.object, scene.cage, [load], friction_coefficient=0.0, name="jaws against springs")


SMOOTH = {
    "truss": truss(),
    "lever": lever(),
    "wedge": wedge(friction=0.0, wall_friction=0.0),
    "jaws": turned_by_jaws(),
    "two points": Insertion(5.01, 0.3, math.radians(0.5), 0.0).scene(3.0, [10.0]),
    "one point": Insertion(5.05, 0.4, 0.0, 0.0).scene(3.0, [10.0]),
}


class Place:
    """One place of a drive: the potential there, and the gaps, of poses beside one, z in sizes and radians."""

    def __init__(self, scene: Scene, share: float, pose: Pose) -> None:
        load, cage = scene.loads[0], scene.cage.pose_world_cage
        to_cage = cage.inverse()
        displaced = {
            body.name: cage @ displaced_by(load.drive.get(body.name, ()), share) @ to_cage for body in scene.cage.bodies
        }
        gaps, size_m = gaps_at(scene, pose, displaced), scene.object.reach_m
        unit = load_size(scene, 0, pose) * size_m
        start = potential(scene, load, displaced, pose)
        self.gaps = lambda z: gaps(moved(pose, z, size_m)) / size_m
        self.rise = lambda z: (potential(scene, load, displaced, moved(pose, z, size_m)) - start) / unit

    def descended(self, z: FloatArray) -> FloatArray | None:
        """Return where SLSQP ends within the gaps, and near; None: it ends outside."""
        found = minimize(
            self.rise,
            z,
            method="SLSQP",
            bounds=[(-NEAR, NEAR)] * 6,
            constraints={"type": "ineq", "fun": self.gaps},
            options={"maxiter": 500, "ftol": 1e-15},
        )
        return found.x if self.gaps(found.x).min() >= -OUTSIDE else None


def places(scene: Scene) -> Iterator[tuple[float, Pose]]:
    """Yield ten places that are spread over a drive, and the part's rests there; none at which it snaps."""
    (phase,) = run(scene).phases
    assert phase.drive is not None
    shares = phase.drive.curve.share.tolist()
    steady = [(share, pose) for share, _, pose in phase.drive.curve.places() if shares.count(share) == 1]
    for which in np.linspace(0, len(steady) - 1, PLACES).round().astype(int):
        yield steady[which]


@pytest.mark.parametrize("name", list(SMOOTH))
def test_each_place_of_a_drive_is_a_least_potential(name: str, say: Callable[[str], None]) -> None:
    """SLSQP, from poses beside it, finds none that is lower, and finds that potential again."""
    random, back, lowest = np.random.default_rng(3), 0, 0.0
    for share, pose in places(SMOOTH[name]):
        place = Place(SMOOTH[name], share, pose)
        assert place.gaps(np.zeros(6)).min() >= -OUTSIDE
        for _ in range(3):
            end = place.descended(DISTURBED * random.uniform(-1.0, 1.0, 6))
            rise = math.inf if end is None else place.rise(end)
            assert rise >= -SAME, f"{name} at {share}: a lower pose beside it"
            lowest = min(lowest, rise)
            if rise <= SAME:
                back += 1
                break
    say(f"{name}: SLSQP is back at {back} of {PLACES} rests of a drive, lower by {-lowest:.0e} of load times size")
    assert back >= PLACES - 2


@pytest.mark.parametrize("name", ["wedge", "jaws", "one point"])
def test_a_pose_beside_a_rest_is_no_least_potential(name: str) -> None:
    """What is asked above can be answered with no: higher by 1e-4 of the size SLSQP finds a lower one."""
    share, pose = list(places(SMOOTH[name]))[PLACES // 2]
    higher = Pose(
        pose.position_m + 1e-4 * SMOOTH[name].object.reach_m * np.array([0.0, 0.0, 1.0]), pose.quaternion_wxyz
    )
    end = Place(SMOOTH[name], share, higher).descended(np.zeros(6))
    assert end is not None
    assert Place(SMOOTH[name], share, higher).rise(end) < -10.0 * SAME
