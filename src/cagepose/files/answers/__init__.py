"""Answers of `cagepose.questions` as people read them: `told`, by ``lines`` and ``table`` in a module a question."""

from __future__ import annotations

from typing import Protocol, TypeVar, runtime_checkable

from cagepose.files.words import LengthWords
from cagepose.questions.unanswered import Unanswered

Answer = TypeVar("Answer")
Told = TypeVar("Told", contravariant=True)


class AnswerModule(Protocol[Told]):
    """A module of this package."""

    def lines(self, answer: Told, words: LengthWords, /) -> list[tuple[str, str]]:
        """Return the answer as people read it: names and texts."""


@runtime_checkable
class TableModule(Protocol[Told]):
    """One whose answer has rows, too."""

    def table(self, answer: Told, words: LengthWords, /) -> list[list[str]]:
        """Return rows of texts for people, the first one the header."""


def told(
    answer: Answer | Unanswered, module: AnswerModule[Answer], words: LengthWords
) -> tuple[list[tuple[str, str]], list[list[str]]]:
    """Return the lines and the rows of an answer, or why there is none; no rows: it has none."""
    if isinstance(answer, Unanswered):
        return [("no answer", answer.unanswered)], []
    return module.lines(answer, words), module.table(answer, words) if isinstance(module, TableModule) else []
