"""When a number agrees with a printed one: to the last digit that is printed, and no further."""

from __future__ import annotations

import math

import pytest

from cagepose.paper.comparison import Printed, Row, compared


@pytest.mark.parametrize(
    ("text", "unit", "value", "agrees"),
    [
        ("28.96", "deg", math.acos(7 / 8), True),
        ("28.95", "deg", math.acos(7 / 8), False),
        ("0.313", "deg", math.radians(0.3134), True),
        ("0.313", "deg", math.radians(0.3136), False),
        ("5", "mm", 0.00549, True),
        ("5", "mm", 0.00551, False),
        ("-0.560", "deg", math.radians(-0.5604), True),
        ("-0.560", "deg", math.radians(0.560), False),
        ("C1", "", "C1", True),
        ("C1", "", "C1 C2", False),
    ],
)
def test_a_number_agrees_to_the_last_printed_digit(text, unit, value, agrees):
    assert Printed(text, unit).agrees_with(value) is agrees


def test_an_upper_limit_agrees_with_any_greater_one():
    limit = Printed("5", "deg", is_bound=True)
    assert limit.agrees_with(math.radians(5.78))
    assert not limit.agrees_with(math.radians(4.9))


def test_the_papers_method_and_the_closed_form_must_agree():
    printed = Printed("0.313", "deg")
    right, wrong = math.radians(0.3131), math.radians(0.4)
    assert compared({"stepwise": right, "other": None}, right, printed) == "agrees"
    assert compared({"stepwise": right, "other": wrong}, right, printed) == "agrees"
    assert compared({"stepwise": wrong, "other": right}, right, printed) == "differs"
    assert compared({"stepwise": right}, wrong, printed) == "differs"
    assert compared({"stepwise": None}, None, printed) == "differs"


def test_the_difference_is_that_of_the_papers_method():
    row = Row("I", "angle", Printed("0.5", "rad"), {"stepwise": 0.6, "other": None}, 0.7, "differs", "why")
    assert row.difference() == pytest.approx(0.1)
    assert row.error("stepwise") == pytest.approx(-0.1)
    assert row.error("other") is None


def test_where_the_papers_method_is_silent_it_is_that_of_the_closed_form():
    row = Row("I", "angle", Printed("0.5", "rad"), {"stepwise": None, "other": 0.9}, 0.7, "differs", "why")
    assert row.difference() == pytest.approx(0.2)


def test_words_have_no_difference():
    row = Row("I", "contact", Printed("C1"), {"stepwise": "C1"}, "C1", "agrees", "why")
    assert row.difference() is None
    assert row.error("stepwise") is None
