"""What the names of attributes say: their frame, ``pose_world_object``, and their unit, ``gap_m``. Scene files, saved
runs and the documents of ``--json`` are read and written by it.
"""

from __future__ import annotations

import re
from functools import cache
from inspect import Parameter, signature
from typing import Any, NamedTuple, get_type_hints

FRAME = re.compile("_(world|object|cage|box|body|shape)(?![a-z])")
UNIT = re.compile("_(m|rad)$")
ENDINGS = ("_n_per_m", "_nm", "_rad", "_m", "_j", "_n", "_s")
"""Units at the end of a name."""
PLACES = {"through_world", "place_world", "places_world", "at_object"}
"""Attributes without a unit in their name that are places, metres."""


class Attribute(NamedTuple):
    """What a constructor takes, and where it stands then: under the same name, or under that name with a frame
    (``pose`` in ``pose_world_object``) or a unit (``travel`` in ``travel_m``).
    """

    argument: str
    name: str
    kind: Any
    is_required: bool


@cache
def attributes_of(kind: type) -> tuple[Attribute, ...]:
    """Return what makes the things of a class, in the order in which its constructor takes it."""
    kinds = get_type_hints(kind, include_extras=True)
    parameters = signature(kind).parameters
    framed = {without_frame(name): name for name in kinds if name not in parameters}
    names = {UNIT.sub("", key): name for key, name in framed.items()} | framed | {name: name for name in kinds}
    return tuple(
        Attribute(argument, names[argument], kinds[names[argument]], parameter.default is Parameter.empty)
        for argument, parameter in parameters.items()
        if argument in names
    )


def parted(name: str) -> tuple[str, str]:
    """Return a name without the unit at its end, and that: empty, if there is none.

    >>> parted("stiffness_n_per_m"), parted("follows")
    (('stiffness', '_n_per_m'), ('follows', ''))
    """
    ending = next((ending for ending in ENDINGS if name.endswith(ending)), "")
    return name.removesuffix(ending), ending


def without_frame(name: str) -> str:
    """Return a name without the frame that it tells.

    >>> without_frame("axis_world"), without_frame("at_object_m")
    ('axis', 'at_m')
    """
    return FRAME.sub("", name)
