"""`RestingPoses` as lines and as a table."""

from __future__ import annotations

import math

from cagepose.files.words import LengthWords, names_of
from cagepose.model.wording import components, number_of
from cagepose.questions.resting import RestingPose, RestingPoses


def lines(answer: RestingPoses, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    del words
    certainty = "exact" if answer.is_exact else "what is round stands as 64 sides: shares are within some thousandths"
    return [
        ("rests", f"in {number_of(len(answer.poses), 'way')} on a level plane without friction, let go slowly"),
        ("certainty", certainty),
    ]


def table(answer: RestingPoses, words: LengthWords) -> list[list[str]]:
    """Return rows of texts, the first one the header."""
    unit = words.unit
    head = [
        "#",
        "share",
        "lies on",
        f"height ({unit})",
        f"margin ({unit})",
        f"tips when raised by ({unit})",
        "down",
        "rolls",
    ]
    return [head, *(_row(str(number), pose, words) for number, pose in enumerate(answer.poses, start=1))]


def _row(number: str, pose: RestingPose, words: LengthWords) -> list[str]:
    rise = "never tips" if math.isinf(pose.rise_m) else words.lengths([pose.rise_m])
    rolls = "" if pose.rolls == "no" else pose.rolls
    if pose.axis_object is not None:
        rolls = f"about ({components(pose.axis_object)})"
    return [
        number,
        f"{100.0 * pose.probability:.4g} %",
        names_of(pose.touching),
        words.lengths([pose.height_m]),
        words.lengths([pose.margin_m]),
        rise,
        f"({components(pose.down_object)})",
        rolls,
    ]
