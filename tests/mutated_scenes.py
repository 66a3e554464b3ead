"""Scene files that somebody spoiled: scenes of ``scenes/`` with one to four seeded mistakes, and a command for each."""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random
from typing import NamedTuple

from our_scenes import OF_BOXES_AND_POINTS, SCENES

TEXTS = [path.read_text(encoding="utf-8") for path in OF_BOXES_AND_POINTS]
SHAPED = [path.read_text(encoding="utf-8") for path in SCENES if path not in OF_BOXES_AND_POINTS]
"""Apart, so that seeds of the others keep their scenes."""
LINES = sorted({line for text in TEXTS for line in text.splitlines()})
COMMANDS = [
    *[("run",)] * 8,
    ("run", "--method", "stepwise"),
    ("run", "--critical-friction", "--check-tolerance"),
    ("run", "--json"),
    ("compare",),
    ("play",),
    ("check",),
]
NUMBER = re.compile(r"-?\b\d+(?:\.\d+)?(?:e-?\d+)?\b")
ROW = re.compile(r"^( *- |.*: )\[[^][]*\]$", re.MULTILINE)
VALUE = re.compile(r"(?<=: )[^\s,}\]][^,}\]\n]*|\[[^][]*\]")
ODD_NUMBERS = ["0", "-0.0", ".nan", ".inf", "-.inf", "1e308", "-1e308", "1e-320", "1e12", "1e-12", "9" * 400, "0x1F"]
ODD_VALUES = [
    "[]",
    "{}",
    "null",
    "true",
    "text",
    "[1, 2]",
    "[[1, 2, 3]]",
    "{a: 1}",
    '"\\u202e"',
    "*a",
    "&a 1",
    "!!x 1",
    "-",
]
ODD_TEXT = [
    "\u202e",
    "\u00e9",
    "\U0001f600",
    "\ufeff",
    "\t",
    "\x00",
    "\x1b[2J",
    "\u2028",
    "#",
    ":",
    "{",
    "]",
    "'",
    "|",
    "%",
]


class Mutant(NamedTuple):
    """A spoiled scene, and the command with its options, without the file's name."""

    text: str
    command: tuple[str, ...]


def mutant(seed: int, texts: list[str] = TEXTS) -> Mutant:
    """Return the spoiled scene of a seed."""
    dice = Random(seed)
    text = dice.choice(texts)
    for _ in range(dice.choice([1, 1, 2, 3, 4])):
        text = dice.choice(MISTAKES)(text, dice)
    return Mutant(text, dice.choice(COMMANDS))


def _without_a_line(text: str, dice: Random) -> str:
    lines = text.splitlines(keepends=True)
    place = dice.randrange(max(len(lines), 1))
    return "".join(lines[:place] + lines[place + 1 :])


def _with_a_line_twice(text: str, dice: Random) -> str:
    lines = text.splitlines(keepends=True) or ["\n"]
    place = dice.randrange(len(lines))
    return "".join([*lines[:place], lines[place], *lines[place:]])


def _with_a_line_of_another(text: str, dice: Random) -> str:
    lines = text.splitlines(keepends=True) or ["\n"]
    lines[dice.randrange(len(lines))] = dice.choice(LINES) + "\n"
    return "".join(lines)


def _with_lines_swapped(text: str, dice: Random) -> str:
    lines = text.splitlines(keepends=True) or ["\n"]
    one, other = dice.randrange(len(lines)), dice.randrange(len(lines))
    lines[one], lines[other] = lines[other], lines[one]
    return "".join(lines)


def _with_a_number_scaled(text: str, dice: Random) -> str:
    factor = dice.choice([-1.0, 0.5, 2.0, 1.0 + 1e-9, 1.0 + 1e-6, *(10.0**k for k in (*range(-15, 0), *range(1, 16)))])
    return _replaced(NUMBER, lambda found: repr(float(found) * factor), text, dice)


def _with_a_number_moved(text: str, dice: Random) -> str:
    shift = dice.choice([-1.0, 1.0]) * 10.0 ** dice.uniform(-10, 2)
    return _replaced(NUMBER, lambda found: repr(float(found) + shift), text, dice)


def _with_an_odd_number(text: str, dice: Random) -> str:
    return _replaced(NUMBER, lambda _: dice.choice(ODD_NUMBERS), text, dice)


def _with_an_odd_value(text: str, dice: Random) -> str:
    return _replaced(VALUE, lambda _: dice.choice(ODD_VALUES), text, dice)


def _with_odd_text(text: str, dice: Random) -> str:
    place = dice.randrange(len(text) + 1)
    return text[:place] + dice.choice(ODD_TEXT) + text[place + dice.randrange(3) :]


def _cut_off(text: str, dice: Random) -> str:
    return text[: dice.randrange(len(text) + 1)]


def _with_a_row_many_times(text: str, dice: Random) -> str:
    """A list of the same row, or of rows a little apart."""
    n_rows, apart = dice.choice([2, 10, 100, 1000]), dice.choice([0.0, 0.0, 1e-12, 1e-3, 1.0])

    n_moved = dice.choice([1, 1, 3])

    def moved(row: str, by: float) -> str:
        return NUMBER.sub(lambda found: repr(float(found[0]) + by), row, count=n_moved)

    def many(row: str) -> str:
        return "\n".join(moved(row, apart * index) for index in range(n_rows))

    return _replaced(ROW, many, text, dice)


def _replaced(pattern: re.Pattern[str], new: Callable[[str], str], text: str, dice: Random) -> str:
    found = list(pattern.finditer(text))
    if not found:
        return text
    place = dice.choice(found)
    return text[: place.start()] + new(place[0]) + text[place.end() :]


MISTAKES: list[Callable[[str, Random], str]] = [
    _without_a_line,
    _with_a_line_twice,
    _with_a_line_of_another,
    _with_lines_swapped,
    *[_with_a_number_scaled] * 4,
    *[_with_a_number_moved] * 4,
    _with_an_odd_number,
    _with_an_odd_value,
    _with_odd_text,
    _cut_off,
    _with_a_row_many_times,
]
