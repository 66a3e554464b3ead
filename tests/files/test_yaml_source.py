"""YAML 1.2 by the letter of its core schema, and the place of every value."""

from __future__ import annotations

import math

import pytest

from cagepose import SceneFileError
from cagepose.files.yaml_source import MAX_DEPTH, parse_yaml, scalar_value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("012", 12),  # YAML 1.1 reads 10
        ("1e-3", 0.001),  # and text here
        ("1.", 1.0),
        (".5", 0.5),
        ("-2.5E+2", -250.0),
        ("0x1F", 31),
        ("0o17", 15),
        ("+7", 7),
        ("1_000", "1_000"),
        ("1:30", "1:30"),  # 90 in YAML 1.1
        ("yes", "yes"),
        ("on", "on"),
        ("True", True),
        ("false", False),
        ("", None),
        ("~", None),
        ("null", None),
        ("-.Inf", -math.inf),
        ("2020-01-01", "2020-01-01"),
        (".", "."),
        ("e5", "e5"),
        ("inf", "inf"),
    ],
)
def test_a_plain_scalar_means_what_yaml_1_2_says(text: str, value: object) -> None:
    read = scalar_value(text)
    assert read == value
    assert type(read) is type(value)


def test_nan_is_read_as_nan() -> None:
    assert math.isnan(float(str(scalar_value(".nan"))))


def test_quoted_scalars_and_blocks_are_text() -> None:
    assert parse_yaml("a: '12'\nb: \"true\"\nc: |\n  3\n", "x").data == {"a": "12", "b": "true", "c": "3\n"}


def test_keys_are_text_whatever_they_look_like() -> None:
    assert parse_yaml("{1: a, true: b, null: c, 1e3: d}", "x").data == {"1": "a", "true": "b", "null": "c", "1e3": "d"}


def test_json_is_yaml_too() -> None:
    assert parse_yaml('{"a": [1, 2.5, null, true, {"b": "c"}]}', "x").data == {"a": [1, 2.5, None, True, {"b": "c"}]}


def test_merge_keys_are_ordinary_keys() -> None:
    assert parse_yaml("<<: {a: 1}\n", "x").data == {"<<": {"a": 1}}


def test_a_scalar_is_found_at_its_value_and_a_block_at_its_key() -> None:
    source = parse_yaml("a: 1\nb:\n  c:\n    - d: 2\n    - [3,  4]\n", "x")
    assert source.mark(("a",)) == (1, 4)
    assert source.mark(("b",)) == (2, 1)
    assert source.mark(("b", "c")) == (3, 3)
    assert source.mark(("b", "c", 0)) == (4, 7)
    assert source.mark(("b", "c", 0, "d")) == (4, 10)
    assert source.mark(("b", "c", 0, "d"), of_key=True) == (4, 7)
    assert source.mark(("b", "c", 1, 1)) == (5, 12)


def test_what_is_not_there_is_looked_for_in_what_should_hold_it() -> None:
    source = parse_yaml("a: 1\nb:\n  c: 2\n", "x")
    assert source.mark(("b", "nothing", 3)) == (2, 1)
    assert source.mark(("nothing",)) == (1, 1)


def test_lines_are_counted_over_comments_blank_lines_and_windows_ends() -> None:
    assert parse_yaml("# one\r\n\r\na: 1 # x\r\nb: 2\r\n", "x").mark(("b",)) == (4, 4)


def test_the_first_of_two_equal_keys_is_kept_and_the_second_reported() -> None:
    source = parse_yaml("a: {b: 1}\nc: 0\na: {b: 2}\n", "x")
    assert source.data == {"a": {"b": 1}, "c": 0}
    assert [str(problem) for problem in source.problems] == [
        "x:3:1: a: stands here for the second time (first in line 1); remove one of the two"
    ]


def test_the_depth_limit_is_where_it_is_said_to_be() -> None:
    parse_yaml("[" * MAX_DEPTH + "]" * MAX_DEPTH, "x")
    with pytest.raises(SceneFileError, match="nests more than 32 levels deep"):
        parse_yaml("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1), "x")
