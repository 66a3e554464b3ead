"""Results as columns, and as pandas data frames where the user has pandas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from cagepose.errors import MissingExtraError
from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.runs.load_scaling import force_unit

if TYPE_CHECKING:
    from cagepose.runs.run import Contact, Event, PhaseRun

POSITION, ANGLES = ("x_m", "y_m", "z_m"), ("yaw_rad", "pitch_rad", "roll_rad")
CONTACT_COLUMNS = (
    "phase", "point", "box", "force_normal_n", *(f"force_tangential_n_{axis}" for axis in "xyz"),
    *(f"normal_{axis}" for axis in "xyz"), *POSITION, "gap_m", "near_edge", "group",
    "force_unit",
)  # fmt: skip
"""A run without contacts has these columns, too."""
DRIVE_COLUMNS = ("phase", "share", "along", *POSITION, *ANGLES)
"""A run that drives nothing has these, too."""
NOWHERE = np.full(3, np.nan)


def data_frame(columns: Mapping[str, object]) -> Any:
    """Return columns of one length as a ``pandas.DataFrame``.

    Raises
    ------
    MissingExtraError
        There is no pandas.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        message = "to_frame needs pandas, which is not installed; install it: pip install pandas"
        raise MissingExtraError(message) from None
    return pandas.DataFrame(dict(columns))


def event_columns(phases: Sequence[PhaseRun]) -> dict[str, list[object]]:
    """Return a row for each event."""
    rows = [_event(phase, number, event) for phase in phases for number, event in enumerate(phase.events, start=1)]
    return {key: [row[key] for row in rows] for key in rows[0]}


def contact_columns(scene: Scene, phases: Sequence[PhaseRun]) -> dict[str, list[object]]:
    """Return a row for each contact at the end of each phase."""
    rows = [
        {"phase": phase.name, **_contact(contact), "force_unit": force_unit(scene, load)}
        for phase, load in zip(phases, scene.loads, strict=False)
        for contact in phase.contacts
    ]
    return {key: [row[key] for row in rows] for key in CONTACT_COLUMNS}


def drive_columns(phases: Sequence[PhaseRun]) -> dict[str, list[object]]:
    """Return a row for each place that was asked along the drive of each phase."""
    rows = [
        {
            "phase": phase.name,
            "share": share,
            "along": along,
            **dict(zip(POSITION, pose.position_m.tolist(), strict=True)),
            **dict(zip(ANGLES, pose.euler_zyx, strict=True)),
        }
        for phase in phases
        if phase.drive is not None
        for share, along, pose in phase.drive.curve.places()
    ]
    return {key: [row[key] for row in rows] for key in DRIVE_COLUMNS}


def _event(phase: PhaseRun, number: int, event: Event) -> dict[str, object]:
    motion, pose = event.motion, event.pose_world_object
    along = None if motion is None else motion.direction_world if motion.axis_world is None else motion.axis_world
    return {
        "phase": phase.name,
        "event": number,
        "rule": event.rule,
        "motion": "" if motion is None else motion.kind,
        "distance_m": 0.0 if motion is None else motion.distance_m,
        "angle_rad": 0.0 if motion is None else motion.angle_rad,
        **_named("along", NOWHERE if along is None else along),
        **dict(zip(POSITION, pose.position_m.tolist(), strict=True)),
        **dict(zip(ANGLES, pose.euler_zyx, strict=True)),
        "hit": event.hit,
        "contacts": event.contacts,
        "share": np.nan if phase.drive is None and phase.press is None else event.share,
        "verdict": phase.verdict if event is phase.events[-1] else "",
    }


def _contact(contact: Contact) -> dict[str, object]:
    place, across = contact.place_world, contact.force_tangential_n
    return {
        "point": contact.point,
        "box": contact.box,
        "force_normal_n": np.nan if contact.force_normal_n is None else contact.force_normal_n,
        **_named("force_tangential_n", NOWHERE if across is None else across),
        **_named("normal", contact.normal_world),
        **dict(zip(POSITION, (NOWHERE if place is None else place).tolist(), strict=True)),
        "gap_m": contact.gap_m,
        "near_edge": contact.near_edge,
        "group": contact.group,
    }


def _named(name: str, vector: FloatArray) -> dict[str, object]:
    return {f"{name}_{axis}": value for axis, value in zip("xyz", vector.tolist(), strict=True)}
