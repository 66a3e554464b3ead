"""What stands in the place of an answer where a question does not apply: `Unanswered`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Unanswered:
    """A question that does not apply to a scene.

    Attributes
    ----------
    unanswered
        Why, in a sentence without its full stop.
    """

    unanswered: str
