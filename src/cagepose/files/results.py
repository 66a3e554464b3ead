"""The one rule by which results become the plain data that ``--json`` prints: `plain_data`.

A field of a result stands under its name without frame and unit, in the units of people: ``gap_m`` under ``gap`` in the
scene's unit of length, ``angle_rad`` under ``angle_deg``, ``moment_nm`` under ``moment`` in newtons times that length.
So a field that is added to a class is in the document as well. What is not known is null.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from cagepose.files.attributes import PLACES, parted, without_frame
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.pose import Pose
from cagepose.runs.run import Motion

KEYS = {"place_world": "at", "equally_stiff_n": "equally_stiff_normal"}
"""The fields whose key is another one."""
LENGTHS = ("_m", "_nm", "_j")
"""Units, at the end of a name, of what is told in the scene's unit of length."""
INFINITE = {"critical_friction": "none", "balance": "none", "distance_m": None}
"""What stands for an infinite number, which JSON has not, in some fields; in all others, `UNBOUNDED`."""
UNBOUNDED = "unbounded"

Convert = Callable[[Any], Any]


def plain_data(result: object, unit: LengthUnit, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return a dataclass or a named tuple as plain data: only dict, list, str, int, finite float, bool and None.

    ``without``: names of fields that are left out, as are those that begin with an underscore.
    """
    return dict(_item(name, getattr(result, name), unit) for name in _names(result) if name not in without)


def pose_data(pose: Pose, unit: LengthUnit) -> dict[str, Any]:
    """Return where something is, and how it is turned: as angles and as a quaternion."""
    return {
        "position": length_data(pose.position_m, unit),
        "euler_zyx_deg": angle_data(pose),
        "quat_wxyz": (pose.quaternion_wxyz + 0.0).tolist(),
    }


def angle_data(pose: Pose) -> list[float]:
    """Return yaw, pitch and roll in degrees."""
    return [math.degrees(angle) + 0.0 for angle in pose.euler_zyx]


def length_data(lengths_m: Any, unit: LengthUnit) -> Any:
    """Return metres, a number or an array, as plain numbers in a unit."""
    return (from_metres(lengths_m, unit) + 0.0).tolist()  # -0.0 becomes 0.0


def motion_data(motion: Motion | None, unit: LengthUnit) -> dict[str, Any]:
    """Return how something moved, its kind under ``motion``; None: it did not."""
    if motion is None:
        return {"motion": None, **dict.fromkeys(("direction", "axis", "through")), "distance": 0.0, "angle_deg": 0.0}
    return {"motion": motion.kind, **plain_data(motion, unit, without=("kind",))}


def _names(result: object) -> list[str]:
    if is_dataclass(result):
        return [field.name for field in fields(result) if not field.name.startswith("_")]
    return list(getattr(result, "_fields", ()))


def _item(name: str, value: Any, unit: LengthUnit) -> tuple[str, Any]:
    """Return the key and the plain value of a field."""
    key, ending = parted(without_frame(name))
    infinite = INFINITE.get(name, UNBOUNDED)
    if name in PLACES or ending in LENGTHS:
        told = _plain(value, unit, lambda lengths: from_metres(lengths, unit), infinite)
    elif ending == "_n_per_m":
        told = _plain(value, unit, lambda each: each / from_metres(1.0, unit), infinite)
    else:
        told = _plain(value, unit, np.degrees if ending == "_rad" else lambda numbers: numbers, infinite)
    return KEYS.get(name, f"{key}_deg" if ending == "_rad" else key), told


def _plain(value: Any, unit: LengthUnit, convert: Convert, infinite: str | None) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        if math.isfinite(value):
            return float(convert(value)) + 0.0  # -0.0 becomes 0.0
        return None if math.isnan(value) else infinite
    if isinstance(value, np.ndarray) and np.isfinite(value).all():
        return (convert(value) + 0.0).tolist()
    if isinstance(value, Mapping):
        return {key: _plain(item, unit, convert, infinite) for key, item in value.items()}
    if isinstance(value, Pose):
        return pose_data(value, unit)
    if _names(value):
        return plain_data(value, unit)
    return [_plain(item, unit, convert, infinite) for item in value]
