"""Numbers and motions as people read them: in tables, beside pictures, in lists."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.drive import Drive
from cagepose.model.load import Load
from cagepose.model.wording import components, short
from cagepose.runs.changes import Seen
from cagepose.runs.drives import way_of
from cagepose.runs.proof import FreeMotion
from cagepose.runs.run import Motion, PhaseRun

SIDEWAYS_OF_NORMAL = 1e-9
"""Fraction of a normal force. A smaller force across it is rounding."""


class LengthWords:
    """Writes the lengths of one scene; what is rounding beside its size is 0."""

    def __init__(self, unit: LengthUnit, size_m: float) -> None:
        self.unit: LengthUnit = unit
        self.noise = 1e-10 * float(from_metres(size_m, unit))

    def lengths(self, lengths_m: Iterable[float]) -> str:
        """Return lengths in metres as ``1, 2.5, 0``, in the unit."""
        return ", ".join(short(float(from_metres(length, self.unit)), 6, self.noise) for length in lengths_m)

    def amount(self, motion: Motion | Seen, digits: int = 6) -> str:
        """Return how far a motion goes."""
        angle = f"{short(math.degrees(motion.angle_rad), digits, 1e-10)} deg"
        if motion.kind == "turn":
            return angle
        if not math.isfinite(motion.distance_m):
            return "no contact ahead"
        distance = f"{short(float(from_metres(motion.distance_m, self.unit)), digits, self.noise)} {self.unit}"
        return f"{distance}, {angle}" if motion.angle_rad else distance

    def scaled(self, value: float, noise: float) -> str:
        """Return a moment or a work, which have a length in them, of newtons and metres."""
        return short(float(from_metres(value, self.unit)), 6, float(from_metres(noise, self.unit)))

    def way(self, legs: Sequence[Drive], share: float) -> str:
        """Return how far a body got after a share of its legs, as ``12.5 mm`` or ``30 deg``, or both."""
        travel, angle = way_of(legs, share)
        told = [f"{self.lengths([travel])} {self.unit}"] if any(not leg.is_turn for leg in legs) else []
        if any(leg.about_cage is not None for leg in legs):
            told.append(f"{short(math.degrees(angle), 6, 1e-10)} deg")
        return ", ".join(told)

    def onset(self, motion: FreeMotion) -> str:
        """Return how an object begins to move, as ``travel along (0, 1, 0)`` or ``turn about ... through ...``."""
        if motion.direction_world is not None:
            return f"travel along ({components(motion.direction_world)})"
        assert motion.axis_world is not None
        assert motion.through_world is not None
        line = f"({components(motion.axis_world)}) through ({self.lengths(motion.through_world)}) {self.unit}"
        pitch = f", {self.lengths([motion.pitch_m])} {self.unit} along it per radian" if motion.kind == "screw" else ""
        return f"{motion.kind} about {line}{pitch}"

    def depth(self, load: Load, share: float) -> str:
        """Return how far a phase's drive got: the way of the one body that is driven, or the share of several."""
        if len(load.drive) == 1:
            (legs,) = load.drive.values()
            return self.way(legs, share)
        return f"{short(100.0 * share, 4, 1e-10)} %"


def force_words(normal: float, tangential: float) -> str:
    """Return a contact force, along the normal and across it; ``0`` of one that bears nothing.

    >>> force_words(72.28, 9.757), force_words(0.3431, 1e-15)
    ('72.28 + 9.757 friction', '0.3431')
    """
    if not normal:
        return "0"
    beside = f" + {tangential:.4g} friction" if tangential > SIDEWAYS_OF_NORMAL * normal else ""
    return f"{normal:.4g}{beside}"


def friction_words(coefficient: float, scale: float | None, digits: int = 10) -> str:
    """Return a coefficient of friction; where there are several, of which ``scale`` is the greatest, how many times
    each of them.

    >>> friction_words(0.12, None), friction_words(0.12, 0.2)
    ('0.12', '0.6 times each coefficient')
    """
    return f"{coefficient / scale:.7g} times each coefficient" if scale else f"{coefficient:.{digits}g}"


def force_notes(phase: PhaseRun) -> list[str]:
    """Return what has to be known of the contact forces that are told of the end of a phase."""
    shared = phase.proof.shared
    told = [f"statically indeterminate, one of many solutions is shown for {names_of(shared)}"] if shared else []
    if phase.verdict in ("blocked", "jams"):
        told.append("forces of the load alone; the drive can add forces of any size")
    return told


def line_of(motion: Motion | Seen) -> str:
    """Return the direction that a motion goes along or turns about."""
    return f"({components(motion.line_world)})"


def names_of(names: Iterable[str]) -> str:
    """Return names in a row, told apart by commas where a blank could be one of a name; one with a comma is quoted.

    >>> names_of(["C1", "C2"]), names_of(["pin left", "pin right"]), names_of(["C1", "a,b"])
    ('C1 C2', 'pin left, pin right', 'C1, "a,b"')
    """
    all_names = [f'"{name}"' if "," in name else name for name in names]
    return (", " if any(" " in name or "," in name for name in all_names) else " ").join(all_names)
