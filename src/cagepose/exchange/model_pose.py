"""Where the joints of a compiled model are: `set_pose`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from cagepose.model.wording import few

MOST_NAMES = 12
"""So many names in a message."""
WANTED = {
    1: "one number",
    4: "4 numbers with commas between, its quaternion",
    7: "7 numbers with commas between, position and quaternion",
}
"""What a joint takes, by its number of coordinates."""


def set_pose(mujoco: Any, model: Any, data: Any, keyframe: str | None, qpos: str | None) -> None:
    """Place all bodies.

    Parameters
    ----------
    mujoco, model, data
        The library and its structures.
    keyframe
        The name of one in the model, or its number from 0; None: the pose without any.
    qpos
        All coordinates of the joints, as numbers; or joint=number of some, where a joint of several coordinates has
        them with commas between.

    Raises
    ------
    ValueError
        There is no such keyframe or joint, or too few or too many numbers.
    """
    if keyframe is not None:
        mujoco.mj_resetDataKeyframe(model, data, _keyframe(model, keyframe))
    if qpos is not None:
        _set_coordinates(mujoco, model, data.qpos, qpos.split())
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)


def _keyframe(model: Any, wanted: str) -> int:
    names = [model.key(number).name or str(number) for number in range(model.nkey)]
    if wanted in names:
        return names.index(wanted)
    if wanted.isdecimal() and int(wanted) < len(names):
        return int(wanted)
    has = f"its keyframes: {few(names, MOST_NAMES)}" if names else "it has none; place joints with --qpos"
    raise ValueError(f"has no keyframe {wanted!r}; {has}")


def _set_coordinates(mujoco: Any, model: Any, coordinates: Any, words: Sequence[str]) -> None:
    joints = {model.joint(number).name or f"joint {number}": number for number in range(model.njnt)}
    if not any("=" in word for word in words):
        if len(words) != model.nq:
            known = f"give one for each, or JOINT=NUMBER for some; its joints: {few(joints, MOST_NAMES) or 'none'}"
            raise ValueError(f"has {model.nq} coordinates of joints, and --qpos {len(words)}; {known}")
        coordinates[:] = [_number(word) for word in words]
        return
    for word in words:
        name, _, values = word.rpartition("=")
        if name not in joints:
            raise ValueError(f"has no joint {name!r}; its joints: {few(joints, MOST_NAMES) or 'none'}")
        first = int(model.jnt_qposadr[joints[name]])
        kind = model.jnt_type[joints[name]]
        count = {mujoco.mjtJoint.mjJNT_FREE: 7, mujoco.mjtJoint.mjJNT_BALL: 4}.get(mujoco.mjtJoint(kind), 1)
        numbers = [_number(value) for value in values.split(",")]
        if len(numbers) != count:
            wanted = WANTED[count]
            raise ValueError(f"has a joint {name!r} that takes {wanted}, and --qpos {len(numbers)}; give so many")
        coordinates[first : first + count] = numbers


def _number(word: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"is given {word!r} in --qpos, which is no finite number; correct it")
    return number
