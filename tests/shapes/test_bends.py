"""Normal, and second derivative of the gap of two features, against differences of the gap in 60 digits."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
import pytest

from cagepose import Box, Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.shapes.bend import Bend, curvatures, write_bend
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Shapes
from cagepose.kernels.shapes.meeting import both_reach, meeting
from cagepose.model.features import shapes_of
from cagepose.model.shapes import Capsule, Convex, Sphere
from shapes.convex_bodies import CUBE, body_of, placed_at

STEP = Decimal("1e-15")
BALL, BAR = Sphere(0.3), Capsule(0.2, 1.5)
SHARP, ROUND = Box((0.7, 1.0, 1.3)), Convex(CUBE * (0.3, 0.4, 0.5), 0.25)
PLATE = Convex(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.2, 0.8, 0.0)]), 0.15)
PARTS = (BALL, BAR, SHARP, ROUND, PLATE)
KINDS = {VERTEX: "vertex", EDGE: "edge", FACE: "face"}


def vector(values) -> np.ndarray:
    return np.array([Decimal(float(value)) for value in values])


def length(a):
    return (a @ a).sqrt()


def turned(spin, point):
    """A point after a turn by the small vector ``spin``, to second order; what is left cancels or is 1e-30."""
    along = np.cross(spin, point)
    return point + along + np.cross(spin, along) / 2


def gap_of(one, other, outward, travel, spin, center):
    """The gap of two features after a travel and a turn of the first about a centre; out is along ``outward``."""
    p = center + turned(spin, vector(one.point) - center) + travel
    u, q, w = turned(spin, vector(one.direction)), vector(other.point), vector(other.direction)
    radii = Decimal(float(one.radius)) + Decimal(float(other.radius))
    kinds = (one.kind, other.kind)
    if kinds == (VERTEX, FACE):
        return w @ (p - q) - radii
    if kinds == (FACE, VERTEX):
        return u @ (q - p) - radii
    if kinds == (EDGE, EDGE):
        crossed = np.cross(u, w)
        return abs(crossed @ outward) / (crossed @ outward) * ((q - p) @ crossed) / length(crossed) - radii
    between = p - q
    if kinds[0] == EDGE:
        between = between - u * (between @ u) / (u @ u)
    elif kinds[1] == EDGE:
        between = between - w * (between @ w) / (w @ w)
    return length(between) - radii


def touching(rng: np.random.Generator, n_pairs: int):
    """Yield pairs of parts at a pose, and their features that reach where they meet."""
    for _ in range(n_pairs):
        part, cage_part = (PARTS[rng.integers(len(PARTS))] for _ in range(2))
        other = body_of(cage_part)
        pose = placed_at(body_of(part), other, rng.normal(size=4), rng.normal(size=3), float(rng.choice([0.0, 0.1])))
        held, cage = placed(part, pose), shapes_of([cage_part])
        for i in range(len(held.features)):
            for j in range(len(cage.features)):
                met = meeting(held, i, cage, j)
                if met.gap > -1e-9 and both_reach(held, i, cage, j, met, 1e-9, 1e-9):  # not on their far sides
                    yield held, i, cage, j, met


def placed(part, pose: Pose) -> Shapes:
    """The features of a part that stands at a pose."""
    if isinstance(part, Box):
        return shapes_of([Box(part.size_m, pose @ part.pose_object_box)])
    if isinstance(part, Sphere):
        return shapes_of([Sphere(part.radius_m, pose)])
    if isinstance(part, Capsule):
        return shapes_of([Capsule(part.radius_m, part.length_m, pose)])
    return shapes_of([Convex(part.vertices_m, part.radius_m, pose)])


@pytest.fixture(autouse=True)
def digits():
    with localcontext(prec=60):
        yield


def test_normals_and_second_derivatives_are_those_of_the_gap(say):
    rng, seen = np.random.default_rng(20), {}
    worst = [0.0, 0.0, 0.0]
    for held, i, cage, j, met in touching(rng, 150):
        one, other = held.features[i], cage.features[j]
        center, radii = rng.normal(size=3), rng.uniform(0.2, 3.0, 3)
        axes = Pose((0, 0, 0), rng.normal(size=4)).rotation
        y = rng.normal(size=6)
        spin = axes.T @ (y[3:] / radii)
        travel, turn, middle, out = vector(y[:3]), vector(spin), vector(center), vector(met.normal)

        def after(step, one=one, other=other, out=out, travel=travel, turn=turn, middle=middle):
            return gap_of(one, other, out, travel * step, turn * step, middle)

        ahead, now, behind = after(STEP), after(Decimal(0)), after(-STEP)
        slope, curve = float((ahead - behind) / (2 * STEP)), float((ahead - 2 * now + behind) / STEP**2)

        normal, arm = np.array(met.normal), np.array(met.place) - center
        bend = empty_record(Bend)
        frame_axes = tuple(map(tuple, axes.tolist()))
        write_bend(
            curvatures(held, i, cage, j, met), met.normal, tuple(arm.tolist()), frame_axes, tuple(radii.tolist()), bend
        )
        velocity, rolls = y[:3] + np.cross(spin, arm), np.cross(normal, spin)
        face_over_point = -normal @ np.cross(spin, np.cross(spin, arm)) + 2.0 * velocity @ rolls
        size = 1.0 + abs(curve)
        errors = (
            abs(float(now) - met.gap),
            abs(slope + normal @ velocity),
            abs(curve - face_over_point - y @ bend.sliding @ y) / size,
        )
        worst = [max(pair) for pair in zip(worst, errors, strict=True)]
        kinds = f"{KINDS[int(one.kind)]}-{KINDS[int(other.kind)]}"
        seen[kinds] = seen.get(kinds, 0) + 1
    assert len(seen) == 6, seen  # all kinds that can touch
    assert worst[0] < 1e-14
    assert worst[1] < 1e-13
    assert worst[2] < 1e-10
    say(f"bends: {seen}; gap, slope, curve wrong by at most {worst[0]:.1e}, {worst[1]:.1e}, {worst[2]:.1e}")
