"""What acts, its work and its stiffness, against differences and integrals of the wrench alone."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose.kernels.algebra.pose import quaternion_about, quaternion_product, rotated
from cagepose.kernels.algebra.record import empty_record, empty_rows
from cagepose.kernels.contact.load_curvature import add_circulation, add_load_curvature
from cagepose.kernels.contact.loads import (
    CARDAN_MOMENT,
    DEAD_FORCE,
    DEAD_MOMENT,
    FIXED_FORCE,
    FOLLOWING_FORCE,
    FOLLOWING_MOMENT,
    SPRING,
    Action,
    PhaseLoad,
    acting,
    joining_twist,
    longest_pull,
    work_done,
    write_load,
)
from cagepose.kernels.contact.metric import Body, frame_at, moved_along_twist
from cagepose.kernels.contact.tolerances import ROUNDING_OF_ENDS

KINDS = {
    "dead force": DEAD_FORCE,
    "following force": FOLLOWING_FORCE,
    "dead moment": DEAD_MOMENT,
    "following moment": FOLLOWING_MOMENT,
    "spring": SPRING,
    "cardan moment": CARDAN_MOMENT,
    "fixed force": FIXED_FORCE,
}


def body() -> Body:
    found = empty_record(Body)
    found.axes_object[:] = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    found.radii[:] = 0.4, 0.7, 1.1
    return found


def unit(random: np.random.Generator) -> np.ndarray:
    vector = random.normal(size=3)
    return np.array(vector / np.linalg.norm(vector))


def load(kind: int, random: np.random.Generator) -> PhaseLoad:
    actions = empty_rows(Action, 1)
    action = actions[0]
    action.kind = kind
    action.vector[:] = random.normal(size=3)
    action.arm_object[:] = random.normal(size=3)
    if kind == SPRING:
        action.anchor[:] = 3.0 * random.normal(size=3)
        action.stiffness, action.tension_at_zero = random.uniform(0.5, 2.0), random.normal()
    if kind == FIXED_FORCE:
        action.anchor[:], action.arm_object[:] = random.normal(size=3), 0.0
    if kind == CARDAN_MOMENT:
        action.anchor[:] = unit(random)
        action.arm_object[:] = unit(random)
    return actions


def pose(random: np.random.Generator) -> tuple:
    axis = random.normal(size=3)
    turned = quaternion_about(tuple(axis / np.linalg.norm(axis)), random.uniform(0, 3))
    return tuple(random.normal(size=3)), turned


def scaled_wrench(load: PhaseLoad, at: tuple) -> np.ndarray:
    out = np.zeros(7)
    write_load(load, *at, frame_at(body(), at[1]), out)
    return out[:6]


def moved(at: tuple, y: np.ndarray) -> tuple:
    """The pose after a small scaled twist: the centre of gravity goes straight, and the object turns about it."""
    frame = frame_at(body(), at[1])
    turn = (y[3:] / frame.radii) @ np.array(frame.axes)
    angle = float(np.linalg.norm(turn))
    turned = quaternion_product(quaternion_about(tuple(turn / angle), angle), at[1]) if angle else at[1]
    return tuple(np.array(at[0]) + y[:3]), turned


def power(load: PhaseLoad, at: tuple, velocity: np.ndarray, spin: np.ndarray) -> float:
    one = acting(load[0], *at)
    return one.share * float(np.dot(one.force, velocity) + np.dot(one.moment, spin))


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS.keys())
def test_stiffness_is_what_the_wrench_loses(kind: int) -> None:
    """S + A: minus the derivative of the wrench that is conjugate to exponential coordinates."""
    random = np.random.default_rng(kind)
    for _ in range(5):
        acts, at = load(kind, random), pose(random)
        frame, h = frame_at(body(), at[1]), 1e-5
        symmetric, circulation = np.zeros((6, 6)), np.zeros((6, 6))
        add_load_curvature(acts, *at, frame, symmetric)
        add_circulation(acts, *at, frame, circulation)
        assert np.array_equal(symmetric, symmetric.T) or np.allclose(symmetric, symmetric.T, atol=1e-14)
        assert np.allclose(circulation, -circulation.T, atol=1e-14)
        found = np.zeros((6, 6))
        for k, unit in enumerate(np.eye(6)):
            for j, other in enumerate(np.eye(6)):
                # d/dh of the power along the coordinate j, at the pose h along k: its twist there from a difference
                rates = []
                for step in (h * unit, -h * unit):
                    ahead, behind = moved(at, step + 1e-4 * other), moved(at, step - 1e-4 * other)
                    velocity, spin = joining_twist(*behind, *ahead)
                    middle = moved(at, step)
                    velocity = (np.array(ahead[0]) - behind[0]) / 2e-4
                    rates.append(power(acts, middle, velocity, np.array(spin) / 2e-4))
                found[j, k] = -(rates[0] - rates[1]) / (2.0 * h)
        assert np.allclose(found, symmetric + circulation, atol=2e-5 * max(1.0, np.abs(symmetric).max()))


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS.keys())
def test_work_is_the_integral_of_the_power_along_a_screw(kind: int) -> None:
    random = np.random.default_rng(10 + kind)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for size in (1.0, 1e-3):
        acts, at = load(kind, random), pose(random)
        velocity, spin = size * random.normal(size=3), size * random.normal(size=3)
        end = moved_along_twist(*at, tuple(velocity), tuple(spin), 1.0)
        total = 0.0
        for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
            there = moved_along_twist(*at, tuple(velocity), tuple(spin), float(node))
            turn = quaternion_about(tuple(spin / np.linalg.norm(spin)), float(np.linalg.norm(spin) * node))
            total += weight * power(acts, there, np.array(rotated(turn, tuple(velocity))), spin)
        assert work_done(acts, *at, *end) == pytest.approx(total, abs=1e-14, rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 0.02, 1.0, 3.0])
def test_the_joining_twist_leads_to_the_pose(angle: float) -> None:
    random = np.random.default_rng(5)
    at = pose(random)
    velocity, spin = random.normal(size=3), random.normal(size=3)
    spin *= angle / np.linalg.norm(spin)
    end = moved_along_twist(*at, tuple(velocity), tuple(spin), 1.0)
    found = joining_twist(*at, *end)
    assert np.allclose(found[0], velocity, atol=1e-13)
    assert np.allclose(found[1], spin, atol=1e-15)


def test_a_spring_whose_tension_is_its_length_times_stiffness_is_linear_also_at_length_zero() -> None:
    acts = load(SPRING, np.random.default_rng(1))
    action = acts[0]
    action.tension_at_zero, action.arm_object[:] = 0.0, 0.0
    here = tuple(action.anchor)
    upright = (1.0, 0.0, 0.0, 0.0)
    out = np.zeros(7)
    terms = write_load(acts, here, upright, frame_at(body(), upright), out)
    assert terms == pytest.approx(ROUNDING_OF_ENDS * 2.0 * action.stiffness * np.linalg.norm(here))
    assert not out.any()
    hessian = np.zeros((6, 6))
    add_load_curvature(acts, here, upright, frame_at(body(), upright), hessian)
    assert np.allclose(hessian[:3, :3], action.stiffness * np.eye(3))
    away = (here[0] + 1e-3, here[1], here[2])
    assert work_done(acts, away, upright, here, upright) == pytest.approx(0.5e-6 * action.stiffness, rel=1e-10)
    assert longest_pull(acts, away, upright, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.02, 1.5, 0.5) == 1.5
