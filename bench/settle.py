"""When a body that an engine moves through time counts as settled: the same rule for every such engine."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from bench.peer_body import PeerBody, PeerLoad
from bench.rail_case import Answer, FloatArray
from cagepose.exchange.settle import windows_until_quiet

QUIET_PART_OF_PLAY = 1e-4
"""A window is quiet if no corner moved by more than this part of the play."""
WINDOW_LIMIT = 4000


class NotSettledError(Exception):
    """A body still moved after `WINDOW_LIMIT` windows, or its pose was no longer a number."""


class TimeStepper(Protocol):
    """An engine that moves a body through time, one window of several steps at a time."""

    def restart(self) -> None:
        """Put the body back to its start, at rest."""

    def push(self, phase: int, torque: FloatArray, force: FloatArray) -> None:
        """Set what acts at the centre of gravity in the next window, per unit load, (3,) each."""

    def advance(self) -> None:
        """Step through one window."""

    def pose(self) -> tuple[FloatArray, FloatArray]:
        """Return the centre of gravity, (3,), mm, and the rotation, (3, 3), in the world."""


def run_to_rest(stepper: TimeStepper, body: PeerBody, play_mm: float) -> Answer:
    """Run all phases, each until it has settled.

    Raises
    ------
    NotSettledError
        As its docstring says.
    """
    stepper.restart()
    rotations = []
    for phase, load in enumerate(body.loads):
        settle(stepper, phase, load, body.corners_mm, play_mm)
        rotations.append(stepper.pose()[1])
    return Answer(tuple(rotations))


def settle(stepper: TimeStepper, phase: int, load: PeerLoad, corners_mm: FloatArray, play_mm: float) -> int:
    """Advance until the body is at rest (`windows_until_quiet`); return how many windows it took.

    Raises
    ------
    NotSettledError
        As its docstring says.
    """

    def places() -> FloatArray:
        position, rotation = stepper.pose()
        return position + corners_mm @ rotation.T

    def advance() -> FloatArray:
        arm = stepper.pose()[1] @ load.arm_mm
        stepper.push(phase, np.cross(arm, load.direction), load.direction)
        stepper.advance()
        return places()

    settled = windows_until_quiet(advance, places(), QUIET_PART_OF_PLAY * play_mm, WINDOW_LIMIT)
    if not np.isfinite(settled.moved):
        raise NotSettledError(f"the pose of phase {phase + 1} is no longer a number")
    if not settled.is_quiet:
        raise NotSettledError(f"phase {phase + 1} still moves after {WINDOW_LIMIT} windows")
    return settled.windows
