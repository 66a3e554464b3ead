"""Numbers of a scene's text written anew: nothing else changes, and what is read then is what was meant."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from cagepose.files.key_path import Path as KeyPath
from cagepose.files.key_path import set_value
from cagepose.files.numbers_in_text import with_numbers
from cagepose.files.yaml_source import parse_yaml
from our_scenes import SCENES

TEXT = """\
# size: 12 is told here, too
name: "12"
size:   [ 12,1.50 , -3e-1]   # 12 mm
nested: {a: +7, b: {c: .5}, d: =12}
rows:
- 12
- {deep: 012}
"""


def changed(changes: Mapping[KeyPath, object], text: str = TEXT) -> str | None:
    return with_numbers(text, parse_yaml(text, "text.yaml"), changes)


def test_only_the_number_itself_changes() -> None:
    assert changed({("size", 1): 2.25}) == TEXT.replace("1.50", "2.25")
    assert changed({("size", 2): 4.0, ("nested", "b", "c"): -1e-7}) == TEXT.replace("-3e-1", "4").replace(
        ".5}", "-1e-07}"
    )
    assert changed({("rows", 1, "deep"): 13, ("rows", 0): 3}) == TEXT.replace("- 12", "- 3").replace("012", "13")


def test_a_number_that_stays_keeps_its_writing() -> None:
    assert changed({("size",): [12, 1.5, 8]}) == TEXT.replace("-3e-1", "8")


def test_of_two_changes_of_one_number_the_later_one_counts() -> None:
    assert changed({("size",): [1, 2, 3], ("size", 0): 12}) == TEXT.replace("1.50 , -3e-1", "2 , 3")


@pytest.mark.parametrize(
    "changes",
    [
        {("size",): [1, 2]},
        {("name",): 12},
        {("nested", "d"): 12},
        {("size", 0): "wide"},
        {("size", 0): True},
        {("missing",): 1.0},
        {("nested", "b"): {"c": 1, "e": 2}},
        {("nested",): [1, 2, 3]},
    ],
    ids=str,
)
def test_what_is_no_number_in_the_place_of_a_number_is_left_to_others(changes: Mapping[KeyPath, object]) -> None:
    assert changed(changes) is None


def test_line_ends_of_all_kinds_are_counted_as_the_parser_counts_them() -> None:
    text = "a: 1\r\nb: '\u2028'\r\nc: [2, 3]\nd: é # ä\n\re: 5\n"
    assert changed({("c", 1): 4, ("e",): 6}, text) == text.replace("3]", "4]").replace("5", "6")


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_each_number_of_our_scenes_can_be_written_and_is_read_again(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    source = parse_yaml(text, path.name)
    rng = np.random.default_rng(0)
    numbers = [place for place, value in places(source.data, ()) if type(value) in (int, float)]
    for place in [numbers[index] for index in rng.choice(len(numbers), min(20, len(numbers)), replace=False)]:
        value = float(rng.normal())
        written = with_numbers(text, source, {place: value})
        assert written is not None, place
        set_value(expected := parse_yaml(text, path.name).data, place, value)
        assert parse_yaml(written, path.name).data == expected
        steps = difflib.SequenceMatcher(None, text.splitlines(), written.splitlines(), autojunk=False).get_opcodes()
        assert [step[2] - step[1] for step in steps if step[0] != "equal"] == [1]


def places(here: object, path: KeyPath) -> list[tuple[KeyPath, object]]:
    pairs = here.items() if isinstance(here, dict) else enumerate(here) if isinstance(here, list) else None
    return [(path, here)] if pairs is None else [found for key, value in pairs for found in places(value, (*path, key))]
