"""Where on the curve of a drive, or among the steps of what presses, a moment of a phase is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cagepose.model.checks import FloatArray

if TYPE_CHECKING:
    from cagepose.runs.run import PhaseRun

DRIVEN = "driven"
"""The rule of the events in which bodies of the cage are driven."""


def share_before(phase: PhaseRun, event_index: int) -> float:
    """Return how much of the phase's drive is done where an event begins."""
    return phase.events[event_index - 1].share if event_index else 0.0


def is_driven_on(phase: PhaseRun, event_index: int) -> bool:
    """Whether the drive goes on in an event."""
    return phase.events[event_index].share > share_before(phase, event_index)


def row_on_curve(phase: PhaseRun, event_index: int, fraction: float) -> float | None:
    """Return where on the curve of the phase's drive, see `shares_of`, it is after ``fraction`` (0 to 1) of an event:
    1.5 is midway between its rows 1 and 2. None: the drive has not begun, or nothing is driven or presses.

    In an event in which the drive goes on it does so evenly; in others, such as a snap, each row takes as long.
    """
    first, of_phase = first_row(phase, event_index), shares_of(phase)
    if of_phase is None or first is None:
        return None
    n_rows = len(phase.events[event_index].path)
    shares = of_phase[first : first + n_rows + 1]
    if is_driven_on(phase, event_index):
        share = float(shares[0] + fraction * (shares[-1] - shares[0]))
        return first + _crossing(shares, share)
    return first + fraction * n_rows


def shares_of(phase: PhaseRun) -> FloatArray | None:
    """Return how much of the phase's drive is done at each row of its curve, or how much of the ways of what presses at
    its start and after each step; None: nothing is driven or presses.
    """
    if phase.press is not None and phase.drive is None:
        return np.concatenate([[0.0], phase.press.share])
    return None if phase.drive is None else phase.drive.curve.share


def first_row(phase: PhaseRun, event_index: int) -> int | None:
    """Return the row of the curve at which an event begins; None: the drive has not begun. The first row is where it
    begins; each pose of the paths of its events adds one.
    """
    events, begins = phase.events, 0
    if phase.press is None or phase.drive is not None:
        begins = next((index for index, event in enumerate(events) if event.rule == DRIVEN), len(events))
    if event_index < begins:
        return None
    return sum(len(event.path) for event in events[begins:event_index])


def value_at(values: FloatArray, row: float) -> float:
    """Return what stands at a row of a curve, between two rows in proportion."""
    return float(np.interp(row, np.arange(len(values)), values))


def _crossing(shares: FloatArray, share: float) -> float:
    """Return the place among shares that never fall at which one is reached."""
    above = int(np.searchsorted(shares, share))
    if above == 0:
        return 0.0
    if above == len(shares):
        return float(len(shares) - 1)
    low, high = float(shares[above - 1]), float(shares[above])
    return above - 1 + (share - low) / (high - low)
