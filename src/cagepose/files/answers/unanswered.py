"""A question that has no answer, as a document and as lines."""

from __future__ import annotations

from typing import Any

from cagepose.questions.unanswered import Unanswered


def document(answer: Unanswered) -> dict[str, Any]:
    return {"unanswered": answer.reason}


def lines(answer: Unanswered) -> list[tuple[str, str]]:
    return [("no answer", answer.reason)]
