"""Normal, and second derivative of the gap, of all pairs of features, against differences of the gap in 60 digits.

The gap of two features is the stationary value, over a place along each, of the distance between these places less the
radii there: of the angle along a circle, of the height along a line. The mouths of holes are circles, too.
"""

from __future__ import annotations

from decimal import Decimal, localcontext
from itertools import chain, product

import numpy as np
import pytest

from boundary.lathe import rounded_hole, rounded_rod
from cagepose import Box, Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.boundary.bend import Bend, curvatures, write_bend
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, empty_placed, place_boundary, place_feature
from cagepose.kernels.boundary.meeting import both_reach
from cagepose.kernels.boundary.meetings import can_touch, find_circle_places, meeting_at
from cagepose.kernels.boundary.touching import empty_meetings
from cagepose.kernels.circles.places import GREATEST, SADDLE, WHOLE
from cagepose.model.boundary.features import boundary_of
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Shape, Sphere
from shapes.convex_bodies import CUBE
from shapes.turned_bodies import Circles, circles_of, placed_at

TOUCH_M, FARTHEST = 1e-9, 1.0
STEP, SMALL, NEWTON = Decimal("1e-15"), Decimal("1e-22"), 3
KINDS = {VERTEX: "vertex", LINE: "line", FACE: "face", CIRCLE: "circle"}
PAIRS = {"vertex-vertex", "vertex-line", "vertex-face", "vertex-circle", "line-line", "line-circle", "face-circle"}
PAIRS |= {"circle-circle", "circle-tapered", "line-tapered", "tapered-vertex", "mouth-vertex", "mouth-circle"}
PAIRS |= {"line-mouth", "tapered-mouth", "circle-wall", "vertex-wall", "circle-tapered wall"}
PAIRS |= {"vertex-tapered wall", "tube-vertex", "tube-line", "face-tube", "tube-tube", "tube-circle", "tube-tapered"}
PAIRS |= {"inner tube-vertex", "inner tube-line", "inner tube-circle", "inner tube-tube"}


@pytest.fixture(autouse=True)
def digits():
    with localcontext(prec=60):
        yield


def vector(values) -> np.ndarray:
    return np.array([Decimal(float(value)) for value in values])


def length(a):
    return (a @ a).sqrt()


def turned(spin, point):
    """A point after a turn by the small vector ``spin``, to second order; what is left cancels or is 1e-30."""
    along = np.cross(spin, point)
    return point + along + np.cross(spin, along) / 2


def parts(pose: Pose | None = None) -> list[Shape]:
    return [
        Cylinder(0.4, 1.2, pose),
        Cone(0.5, 0.2, 0.9, pose),
        Disc(0.6, pose),
        Sphere(0.3, pose),
        Capsule(0.2, 1.5, pose),
        Box((0.7, 1.0, 1.3), pose),
        Convex(CUBE * (0.3, 0.4, 0.5), 0.25, pose),
    ]


def pegs(pose: Pose) -> list[Shape]:
    return [Cylinder(0.4, 1.2, pose), Cone(0.3, 0.45, 1.0, pose), Sphere(0.35, pose), Capsule(0.3, 1.0, pose)]


def over_hole(pose: Pose) -> list[Shape]:
    """Parts that reach over the mouth of a hole: faces, edges, balls and rims."""
    return [Box((1.5, 0.3, 0.2), pose), Sphere(0.7, pose), Cone(0.2, 0.9, 0.8, pose), Disc(0.7, pose)]


def bodies(rng: np.random.Generator, n: int):
    """Yield the object and the cage, near each other; at first an edge of a box beside a cone and a tilted edge."""
    on_edge = Pose((1.15, 0.0, 0.0), euler_zyx=(0.0, 0.25 * np.pi, 0.1))
    yield Box((1.0, 1.0, 1.0), on_edge), parts()[1]
    yield Box((1.0, 1.0, 1.0), on_edge), Box((0.5, 0.5, 2.0), Pose((0.0, 0.0, 0.0), euler_zyx=(0.7, 0.0, 0.0)))
    for index in range(n):
        if index % 3 == 0:
            which, other = rng.integers(7, size=2) if index % 2 else (1, rng.choice([0, 2, 4, 5]))
            one, cage_part = (circles_of(parts()[k]) for k in (which, other))
            pose = placed_at(one, cage_part, rng.normal(size=4), rng.normal(size=3), 0.1)
            yield parts(pose)[which], parts()[other]
            continue
        chamfer = Chamfer(0.15, 0.6) if rng.random() < 0.5 else None
        if index % 3 == 1:
            pose = Pose((*rng.uniform(-0.15, 0.15, 2), rng.uniform(-1.0, 0.3)), (1.0, *rng.normal(size=3) * 0.15))
            part = pegs(pose)[rng.integers(4)]
        else:
            pose = Pose((*rng.uniform(-0.4, 0.4, 2), rng.uniform(0.0, 0.6)), (1.0, *rng.normal(size=3) * 0.4))
            part = over_hole(pose)[rng.integers(4)]
        hole = Hole(0.55, 1.5, chamfer)
        yield (hole, part) if rng.random() < 0.2 else (part, hole)


def tubes(rng: np.random.Generator, n: int):
    """Yield the object and the cage, near each other: one has a rounded rim, or a hole with a rounded mouth."""
    rod, plate = rounded_rod(0.5, 1.2, 0.2), rounded_hole(0.55, 0.2, 4.0, 1.5)
    core = circles_of(Cylinder(0.3, 0.8))
    around = Circles(core.centers, core.axes, core.radii, 0.2)
    for index in range(n):
        if index % 2 == 0:
            which = int(rng.integers(8))
            other, beside = (rod, around) if which == 7 else (parts()[which], circles_of(parts()[which]))
            pose = placed_at(around, beside, rng.normal(size=4), rng.normal(size=3), 0.1)
            yield rod.moved(pose), other
            continue
        pose = Pose((*rng.uniform(-0.15, 0.15, 2), rng.uniform(-0.6, 0.5)), (1.0, *rng.normal(size=3) * 0.2))
        part = rod.moved(pose) if rng.random() < 0.4 else [*pegs(pose), *over_hole(pose)][rng.integers(8)]
        yield (plate, part) if rng.random() < 0.2 else (part, plate)


def placed(part: Shape):
    body = empty_placed(boundary_of([part], TOUCH_M))
    place_boundary(body, *Pose().as_tuples())
    for i in range(len(body.features)):
        place_feature(body, i)
    return body


def meetings(held, cage):
    """Yield (i, j, meeting) of all places where features reach."""
    memory = empty_meetings(1).places
    for i, j in product(range(len(held.features)), range(len(cage.features))):
        one, other = held.features[i], cage.features[j]
        if not can_touch(one, other):
            continue
        n_places = find_circle_places(one, other, TOUCH_M, memory)
        for k in range(0 if n_places == WHOLE else n_places):
            if memory[k].kind in (GREATEST, SADDLE):
                continue
            met = meeting_at(held, i, cage, j, memory[k])
            least = 0.01 if one.kind == CIRCLE or other.kind == CIRCLE else -1e-9
            if met.is_one and least < met.gap < FARTHEST and both_reach(held, i, cage, j, met, 1e-9, 1e-9):
                yield i, j, met


class Curve:
    """A feature as places along one number, zero where it meets another; all in 60 digits."""

    def __init__(self, feature, place, normal) -> None:
        """Of a line whose radius changes, zero is the place on the axis that the normal there comes from."""
        self.is_circle, self.is_line = feature.kind == CIRCLE, feature.kind == LINE
        self.point, self.direction = vector(feature.point), vector(feature.direction)
        self.radius, self.taper = Decimal(float(feature.radius)), Decimal(float(feature.taper))
        self.size, self.at = Decimal(float(feature.length)), Decimal(0)
        seen = place - feature.point
        if self.is_circle:
            out = seen - feature.radius * normal
            out = out - (out @ feature.direction) * feature.direction
            out = out / np.linalg.norm(out)
            self.out, self.along = vector(out), vector(np.cross(feature.direction, out))
        elif self.is_line:
            sine = float(feature.taper)
            height = float(feature.direction @ seen) - sine * float(feature.radius)
            self.at = Decimal(height / (1.0 - sine * sine))

    def moved(self, travel, spin, center) -> Curve:
        other = object.__new__(Curve)
        other.__dict__.update(self.__dict__)
        other.point = center + turned(spin, self.point - center) + travel
        other.direction = turned(spin, self.direction)
        if self.is_circle:
            other.out, other.along = turned(spin, self.out), turned(spin, self.along)
        return other

    def place(self, at):
        if self.is_circle:  # at = tan(angle / 2)
            square = at * at
            return self.point + self.size / (1 + square) * ((1 - square) * self.out + 2 * at * self.along)
        return self.point + at * self.direction if self.is_line else self.point

    def radius_at(self, at):
        return self.radius - self.taper * at


def stationary(value, at: list) -> Decimal:
    """Return the stationary value of a function of two numbers near a place: Newton's method, by differences."""
    units = [np.array([SMALL, Decimal(0)]), np.array([Decimal(0), SMALL])]
    at = np.array(at)
    for _ in range(NEWTON):
        slope = [(value(at + unit) - value(at - unit)) / (2 * SMALL) for unit in units]
        ((a, b), (_, d)) = [
            [
                (value(at + x + y) - value(at + x - y) - value(at - x + y) + value(at - x - y)) / (4 * SMALL * SMALL)
                for y in units
            ]
            for x in units
        ]
        size = abs(a) + abs(d)
        a, d = (1 if a == 0 else a), (1 if d == 0 else d)  # nothing depends on it
        whole = a * d - b * b
        assert size == 0 or abs(whole) > Decimal("1e-12")
        at = at - np.array([d * slope[0] - b * slope[1], a * slope[1] - b * slope[0]]) / whole
    return value(at)


def gap_of(one: Curve, other: Curve, face_normal, way) -> Decimal:
    """The gap of two features: along a face's normal, out of the object, if one is a face; else along the way between
    them, of which ``way`` tells the sense.
    """

    def value(at):
        between = other.place(at[1]) - one.place(at[0])
        radii = one.radius_at(at[0]) + other.radius_at(at[1])
        if face_normal is not None:
            return face_normal @ between - radii
        return (1 if between @ way > 0 else -1) * length(between) - radii

    return stationary(value, [one.at, other.at])


def name_of(feature, out: np.ndarray, place: np.ndarray) -> str:
    if feature.kind == CIRCLE and feature.radius > 0.0:
        return "inner tube" if out @ (place - feature.radius * out - feature.point) < 0.0 else "tube"
    if feature.kind == CIRCLE:
        return "mouth" if out @ (place - feature.point) < 0.0 else "circle"
    if feature.kind == LINE:
        kind = "wall" if feature.radius < 0.0 else "line"
        return kind if feature.taper == 0.0 else "tapered" if kind == "line" else f"tapered {kind}"
    return KINDS[int(feature.kind)]


def test_normals_and_second_derivatives_are_those_of_the_gap(cases, say):
    rng, seen, wrong = np.random.default_rng(31), dict[str, int](), list[str]()
    worst = [0.0, 0.0, 0.0]
    for held_part, cage_part in chain(bodies(rng, cases(60, 1000)), tubes(rng, cases(40, 1000))):
        held, cage = placed(held_part), placed(cage_part)
        for i, j, met in meetings(held, cage):
            one, other = held.features[i], cage.features[j]
            normal, place = np.array(met.normal), np.array(met.place)
            there = place + met.gap * normal
            kinds = f"{name_of(one, normal, place)}-{name_of(other, -normal, there)}"
            curves = Curve(one, place, normal), Curve(other, there, -normal)
            center, radii = rng.normal(size=3), rng.uniform(0.2, 3.0, 3)
            axes = Pose((0, 0, 0), rng.normal(size=4)).rotation
            y = rng.normal(size=6)
            spin = axes.T @ (y[3:] / radii)
            travel, turn, middle, way = vector(y[:3]), vector(spin), vector(center), vector(normal)
            face = "one" if one.kind == FACE else "other" if other.kind == FACE else None

            def after(step, curves=curves, face=face, travel=travel, turn=turn, middle=middle, way=way):
                moved = curves[0].moved(travel * step, turn * step, middle)
                along = None if face is None else moved.direction if face == "one" else -curves[1].direction
                return gap_of(moved, curves[1], along, way)

            ahead, now, behind = after(STEP), after(Decimal(0)), after(-STEP)
            slope, curve = float((ahead - behind) / (2 * STEP)), float((ahead - 2 * now + behind) / STEP**2)
            arm, bend = place - center, empty_record(Bend)
            found = curvatures(held, i, cage, j, met, False)
            frame = tuple(map(tuple, axes.tolist()))
            write_bend(found, met.normal, tuple(arm.tolist()), frame, tuple(radii.tolist()), bend)
            velocity, rolls = y[:3] + np.cross(spin, arm), np.cross(normal, spin)
            face_over_point = -normal @ np.cross(spin, np.cross(spin, arm)) + 2.0 * velocity @ rolls
            size = 1.0 + abs(curve) + float(np.abs(bend.sliding).max())
            errors = (
                abs(float(now) - met.gap),
                abs(slope + normal @ velocity),
                abs(curve - face_over_point - y @ bend.sliding @ y) / size,
            )
            seen[kinds] = seen.get(kinds, 0) + 1
            if errors[0] > 1e-13 or errors[1] > 1e-12 or errors[2] > 1e-9:
                wrong.append(f"{kinds}: gap {errors[0]:.1e}, slope {errors[1]:.1e}, curve {errors[2]:.1e}")
            worst = [max(pair) for pair in zip(worst, errors, strict=True)]
    say(f"bends of boundaries: {seen}; worst {worst[0]:.1e}, {worst[1]:.1e}, {worst[2]:.1e}; {len(wrong)} wrong")
    assert not wrong, "\n".join(wrong[:40])
    both_ways = seen.keys() | {"-".join(reversed(kinds.split("-"))) for kinds in seen}
    assert both_ways >= PAIRS or cases(60, 1000) < 200, PAIRS - both_ways
