"""Normal and second derivative of the gap of rims, tapered sides and walls of holes, against differences in 60 digits.

The gap of two features is the stationary value, over a place along each, of the distance between these places less the
radii there: of the angle along a rim, of the height along a side.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from cagepose import Box, Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.shapes.bend import Bend, curvatures, write_bend
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, VERTEX
from cagepose.kernels.shapes.meeting import both_reach, meeting
from cagepose.model.features import shapes_of
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Shape, Sphere
from shapes.convex_bodies import CUBE
from shapes.test_bends import STEP, digits, length, turned, vector
from shapes.turned_bodies import circles_of, placed_at

__all__ = ["digits"]  # a fixture of these tests, too

SMALL, NEWTON = Decimal("1e-22"), 3
KINDS = {VERTEX: "vertex", EDGE: "edge", FACE: "face", RIM: "rim"}


def turned_parts(pose: Pose | None = None) -> list[Shape]:
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


class Line:
    """A feature as places along one number, zero where it meets another; all in 60 digits."""

    def __init__(self, feature, core) -> None:
        self.is_rim, self.is_edge = feature.kind == RIM, feature.kind == EDGE
        self.point, self.direction = vector(feature.point), vector(feature.direction)
        self.radius, self.taper = Decimal(float(feature.radius)), Decimal(float(feature.taper if self.is_edge else 0.0))
        self.size = Decimal(float(feature.length))
        self.at = Decimal(0)
        if self.is_rim:
            out = (np.array(core) - feature.point) / feature.length
            self.out, self.along = vector(out), vector(np.cross(feature.direction, out))
        elif self.is_edge:
            self.at = Decimal(float(feature.direction @ (np.array(core) - feature.point)))

    def moved(self, travel, spin, center) -> Line:
        other = object.__new__(Line)
        other.__dict__.update(self.__dict__)
        other.point = center + turned(spin, self.point - center) + travel
        other.direction = turned(spin, self.direction)
        if self.is_rim:
            other.out, other.along = turned(spin, self.out), turned(spin, self.along)
        return other

    def place(self, at):
        if self.is_rim:  # at = tan(angle / 2)
            square = at * at
            return self.point + self.size / (1 + square) * ((1 - square) * self.out + 2 * at * self.along)
        return self.point + at * self.direction if self.is_edge else self.point

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


def gap_of(one: Line, other: Line, face_normal, side: int) -> Decimal:
    """The gap of two features, one of them a face with this outward normal of the object, if there is one."""

    def value(at):
        between = other.place(at[1]) - one.place(at[0])
        radii = one.radius_at(at[0]) + other.radius_at(at[1])
        return (side * length(between) if face_normal is None else face_normal @ between) - radii

    return stationary(value, [one.at, other.at])


def touching(rng: np.random.Generator, n_pairs: int):
    """Yield features that reach where they meet, one of them a rim, tapered or of a hole."""
    for index in range(n_pairs):
        if index % 2:
            pose = Pose((*rng.uniform(-0.15, 0.15, 2), rng.uniform(-1.0, 0.3)), (1.0, *rng.normal(size=3) * 0.15))
            part = pegs(pose)[rng.integers(4)]
            chamfer = Chamfer(0.15, 0.6) if index % 4 == 1 else None
            held, cage, least = shapes_of([part]), shapes_of([Hole(0.55, 1.5, chamfer)]), 0.01
        else:
            which, other = rng.integers(7, size=2)
            one, cage_part = (circles_of(turned_parts()[k]) for k in (which, other))
            pose = placed_at(one, cage_part, rng.normal(size=4), rng.normal(size=3), 0.1)
            held, cage, least = shapes_of([turned_parts(pose)[which]]), shapes_of([turned_parts()[other]]), 0.05
        for i in range(len(held.features)):
            for j in range(len(cage.features)):
                kinds = {int(held.features[i].kind), int(cage.features[j].kind)}
                is_new = RIM in kinds or held.features[i].taper != 0.0 or cage.features[j].taper != 0.0
                if not is_new and cage.features[j].radius >= 0.0:
                    continue
                met = meeting(held, i, cage, j)
                if met.is_one and least < met.gap < 1.0 and both_reach(held, i, cage, j, met, 1e-9, 1e-9):
                    yield held, i, cage, j, met


def name_of(feature) -> str:
    kind = KINDS[int(feature.kind)] if feature.taper == 0.0 or feature.kind != EDGE else "tapered"
    return f"hole {kind}" if feature.radius < 0.0 or feature.length < 0.0 else kind


def test_normals_and_second_derivatives_are_those_of_the_gap(cases, say):
    rng, seen, wrong = np.random.default_rng(21), {}, []
    worst = [0.0, 0.0, 0.0]
    for held, i, cage, j, met in touching(rng, cases(40, 800)):
        one, other = held.features[i], cage.features[j]
        normal = np.array(met.normal)
        place, there = np.array(met.place), np.array(met.place) + met.gap * normal
        kinds = f"{name_of(one)}-{name_of(other)}"
        # of an edge whose radius changes, the place on the axis is where its normal comes from
        radii_there = [float(feature.radius) for feature in (one, other)]
        cores = [place, there]
        for k, (feature, out) in enumerate(((one, normal), (other, -normal))):
            if feature.kind == EDGE:
                seen_from = cores[k] - feature.point
                sine = float(feature.taper)
                height = float(feature.direction @ seen_from) - sine * radii_there[k]
                height = height / (1.0 - sine * sine)
                cores[k] = feature.point + height * feature.direction
            else:
                cores[k] = cores[k] - radii_there[k] * out
        lines = Line(one, cores[0]), Line(other, cores[1])
        face = None
        if one.kind == FACE:
            face = "one"
        elif other.kind == FACE:
            face = "other"
        side = -1 if min(float(one.radius), float(other.radius)) < 0.0 else 1
        center, radii = rng.normal(size=3), rng.uniform(0.2, 3.0, 3)
        axes = Pose((0, 0, 0), rng.normal(size=4)).rotation
        y = rng.normal(size=6)
        spin = axes.T @ (y[3:] / radii)
        travel, turn, middle = vector(y[:3]), vector(spin), vector(center)

        def after(step, lines=lines, face=face, side=side, travel=travel, turn=turn, middle=middle):
            moved = lines[0].moved(travel * step, turn * step, middle)
            way = None if face is None else moved.direction if face == "one" else -lines[1].direction
            return gap_of(moved, lines[1], way, side)

        ahead, now, behind = after(STEP), after(Decimal(0)), after(-STEP)
        slope, curve = float((ahead - behind) / (2 * STEP)), float((ahead - 2 * now + behind) / STEP**2)
        arm, bend = place - center, empty_record(Bend)
        frame = tuple(map(tuple, axes.tolist()))
        found = curvatures(held, i, cage, j, met)
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
    say(f"bends of rims and holes: {seen}; worst {worst[0]:.1e}, {worst[1]:.1e}, {worst[2]:.1e}; {len(wrong)} wrong")
    assert not wrong, "\n".join(wrong[:40])
    assert len(seen) >= 10, seen
