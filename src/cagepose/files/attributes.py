"""What the name of an attribute says of it: its frame, ``pose_world_object``, and its unit, ``gap_m``. Saved runs and
the documents of ``--json`` read it.
"""

from __future__ import annotations

import re

FRAME = re.compile("_(world|object|cage|box|body|shape)(?![a-z])")
PLACES = {"through_world", "place_world", "places_world", "at_object"}
"""Attributes without a unit in their name that are places, metres."""


def without_frame(name: str) -> str:
    """Return a name without the frame that it tells.

    >>> without_frame("axis_world"), without_frame("at_object_m")
    ('axis', 'at_m')
    """
    return FRAME.sub("", name)
