"""Parameters, and numbers that are expressions of them: what they come to, and what is refused."""

from __future__ import annotations

import contextlib
import gc
import json
import math
import random
import weakref

import numpy as np
import pytest

from cagepose import SceneFileError
from cagepose.files.expression import Expression
from cagepose.files.parameters import Expressions
from cagepose.files.scene_file import parse_scene, scene_text_of

SCENE = """\
name: =sample
parameters: {half: 4, top: "=half + 6"}
object:
  boxes:
    - {size: [10, "=2*half + 2", 10], position: [0, 0, 0], name: =box}
  pose: {position: [2, "=half", "=top"]}
cage:
  points: [["=half", 4, 0], [4, "=-half", 0], [-4, -4, 0], [-4, 4, 0]]
loads:
  - {name: gravity, gravity: [0, 0, -1]}
friction: {coefficient: "=half/40"}
"""


def problems_of(text: str, *settings: str) -> list[str]:
    with pytest.raises(SceneFileError) as caught:
        parse_scene(text, "s.yaml", settings)
    return str(caught.value).splitlines()


def test_numbers_may_be_expressions_and_text_stays_text() -> None:
    scene = parse_scene(SCENE)
    assert scene.object.boxes[0].size_m.tolist() == [0.01, 0.01, 0.01]
    assert scene.object.pose_world_object.position_m.tolist() == [0.002, 0.004, 0.01]
    assert scene.cage.points_cage[:2].tolist() == [[0.004, 0.004, 0.0], [0.004, -0.004, 0.0]]
    assert (scene.friction_coefficient, scene.name, scene.object.boxes[0].name) == (0.1, "=sample", "=box")


def test_a_parameter_changes_all_that_hangs_on_it() -> None:
    scene = parse_scene(SCENE, "s.yaml", ["parameters.half=4.5"])
    assert scene.object.boxes[0].size_m[1] == 0.011
    assert scene.object.pose_world_object.position_m.tolist() == [0.002, 0.0045, 0.0105]
    assert parse_scene(SCENE, "s.yaml", ["object.mass==half/2"]).object.mass_kg == 2.0


def test_a_name_is_known_in_whichever_form_unicode_has_for_it() -> None:
    """Keyboards have the micro sign, which Python reads as the Greek letter."""
    micro, letter = "\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}"
    for name in (micro, letter):
        text = SCENE.replace("half: 4,", f"half: 4, {name}: 0.2,").replace("=half/40", f"={micro}*half/4 + {letter}")
        assert parse_scene(text).friction_coefficient == 0.4
        assert Expression(f"{micro}.z < 3").value({f"{name}_z": 2.0})


def test_a_number_may_be_an_expression_whatever_its_key_or_its_parameter_is_called() -> None:
    """``length`` is a unit in one place and a number in others; ``in`` holds names, and may be the name of a point."""
    text = """\
name: named like text
units: {length: mm}
parameters: {name: 6, length: "=2*name", file: "=length/3"}
object:
  shapes: [{cylinder: {radius: "=file", length: "=length"}}, {hole: {radius: 1, depth: "=name", in: [cylinder1]},
    position: [0, 0, "=length/2"]}]
  pose: {position: [0, 0, 20]}
cage: {points: {in: ["=name", 0, 0], key: [0, "=length", 0]}}
loads: [{name: weight, gravity: [0, 0, -1]}]
"""
    scene = parse_scene(text)
    (cylinder,), (hole,) = scene.object.shapes, scene.object.holes
    assert (cylinder.radius_m, cylinder.length_m, hole.depth_m) == (0.004, 0.012, 0.006)
    assert scene.cage.points_cage.tolist() == [[0.006, 0.0, 0.0], [0.0, 0.012, 0.0]]
    (problem,) = problems_of(text.replace("length: mm", "length: =mm"))
    assert problem.startswith("s.yaml:2:17: units.length: is text '=mm'; use one of")
    (problem,) = problems_of(text.replace("[cylinder1]", '["=cylinder1"]'))
    assert "object.shapes[1].hole.in" in problem
    assert "=cylinder1" in problem


REFUSED = [
    ('=open("x")', "calls open, which no expression may"),
    ('=__import__("os")', "calls __import__, which no expression may"),
    ("=half.__class__", "has the unknown name half.__class__; known names: half, top"),
    ("=(lambda: 1)()", "calls lambda: 1, which no expression may"),
    ("=[half]", "holds more than arithmetic and comparisons"),
    ("=[x for x in (1, 2)]", "holds more than arithmetic and comparisons"),
    ("={1: 2}", "holds more than arithmetic and comparisons"),
    ("=half[0]", "holds more than arithmetic and comparisons"),
    ("=(x := 3)", "holds more than arithmetic and comparisons"),
    ("=half if half > 1 else 2", "holds more than arithmetic and comparisons"),
    ("=f'{half}'", "holds more than arithmetic and comparisons"),
    ("=True", "holds more than arithmetic and comparisons"),
    ("=1j", "holds more than arithmetic and comparisons"),
    ("=half // 3", "holds the operator FloorDiv"),
    ("=half in top", "holds the operator In"),
    ("=import os", "is no expression"),
    ("=half; 2", "is no expression"),
    ("=half +", "is no expression"),
    ("=", "is no expression"),
    ("=" + "(" * 400 + "1" + ")" * 400, "is no expression"),
    ("=" + "-" * 2000 + "1", "has 2001 characters"),
    ("=9**9**9", "is too large a number"),
    ("=1e308*10", "is infinite"),
    ("=half/0", "divides by zero"),
    ("=(-half)**0.5", "comes to a number that is not real"),
    ("=half < 2", "comes to true or false"),
    ("='a'", "comes to text"),
    ("=abs", "comes to a function"),
    ("=abs(half, 2)", "cannot be worked out"),
    ("=half + 'a'", "cannot be worked out"),
    ("=palf", "has the unknown name palf; known names: half, top"),
    ("=-half", "'=-half' is -4; give a number above 0"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), REFUSED, ids=[text[:20] for text, _ in REFUSED])
def test_what_is_no_number_is_refused_in_place(text: str, message: str) -> None:
    (problem,) = problems_of(SCENE.replace('"=2*half + 2"', json.dumps(text)))
    assert problem.startswith("s.yaml:5:19: object.boxes[0].size[1]: ")
    assert message in problem
    assert ";" in problem  # a remedy stands behind it


def test_parameters_are_numbers_with_names_that_can_be_used() -> None:
    for name, message in (("lambda", "is no name that an"), ("two words", "is no name"), ("min", "is the name of a")):
        (problem,) = problems_of(SCENE.replace("{half: 4", f"{{{name}: 1, half: 4"))
        assert problem.startswith("s.yaml:2:")
        assert f": parameters.{name}: {message}" in problem
    (problem,) = problems_of(SCENE.replace("half: 4", "half: four"))
    assert problem == "s.yaml:2:20: parameters.half: is text 'four'; give a number"
    (problem,) = problems_of(SCENE.replace("=half + 6", "=top + 6"))
    assert problem.startswith("s.yaml:2:28: parameters.top: has the unknown name top; known names: half")


def test_all_wrong_expressions_are_told_at_once_and_right_ones_are_not() -> None:
    found = problems_of(SCENE.replace('"=2*half + 2"', '"=2*helf"').replace('"=-half"', '"=-holf"'))
    assert [problem.split(": ")[1] for problem in found] == ["object.boxes[0].size[1]", "cage.points[1][1]"]


def test_a_wrong_key_is_told_as_one_whatever_stands_there() -> None:
    (problem,) = problems_of(SCENE, "friction.mu==2*half")
    assert problem.startswith("--set friction.mu==2*half: friction.mu: is no known key; did you mean coefficient?")


def test_a_setting_that_is_wrong_is_named() -> None:
    (problem,) = problems_of(SCENE, "object.mass==weight")
    assert problem.startswith("--set object.mass==weight: object.mass: has the unknown name weight")


def test_an_array_of_values_has_the_bits_of_each_value_by_itself() -> None:
    """Random formulas of random numbers, one by one and all at once."""
    rng = random.Random(4)
    values = np.append(np.random.default_rng(4).uniform(-3.0, 3.0, 500), (0.0, -0.0, 1.0))

    def formula(depth: int) -> str:
        if depth == 0:
            return rng.choice(["a", "b", f"{rng.uniform(-2, 2)!r}"])
        one, other = formula(depth - 1), formula(depth - 1)
        return rng.choice(
            [f"({one} {sign} {other})" for sign in "+-*/"]
            + [f"abs({one})**{abs(rng.gauss(0, 1))!r}", f"min({one}, {other})", f"max({one}, {other})", f"(-{one})**2"]
        )

    for _ in range(60):
        expression = Expression(formula(3))
        try:
            together = np.broadcast_to(expression.value({"a": values, "b": 0.7}), values.shape)
        except ValueError:  # of a part without a
            together = np.full(values.shape, np.nan)
        for value, found in zip(values.tolist(), together.tolist(), strict=True):
            try:
                alone = expression.value({"a": value, "b": 0.7})
            except ValueError:
                assert not math.isfinite(found)
            else:
                assert found == alone or (math.isnan(alone) and math.isnan(found))


@pytest.mark.parametrize(
    "text", ["min(1/a, 5)", "max(-3, 1/a)", "1/(1/a)", "min(a**0.5, 2)", "((-1 - a*a)**0.5)**0", "max((1/a)**2, 1)"]
)
def test_what_is_no_number_by_itself_is_none_among_others(text: str) -> None:
    """Not even where a function or an operator would make a number of it again, as of infinity."""
    expression, values = Expression(text), np.array([-1.0, 0.0, 0.5])
    assert np.array_equal(expression.value({"a": values}), [by_itself(expression, a) for a in values], equal_nan=True)


def by_itself(expression: Expression, a: float) -> float:
    try:
        found = expression.value({"a": float(a)})
    except ValueError:
        return math.nan
    return found if isinstance(found, float) else math.nan


def test_a_bare_word_is_told_to_stand_in_quotes():
    with pytest.raises(
        ValueError, match='unknown name rests; known names: verdict; text stands in quotes, as in verdict == "rests"'
    ):
        Expression("rests").value({"verdict": np.array(["rests"])})


def test_comparisons_answer_for_all_rows() -> None:
    verdicts, tilts = np.array(["rests", "escapes", "rests"]), np.array([0.1, 0.0, -0.3])
    expression = Expression("verdict == 'rests' and -0.2 < pitch.deg < 0.2 or not abs(pitch_deg) > 0")
    assert expression.value({"verdict": verdicts, "pitch_deg": tilts}).tolist() == [True, True, False]


def test_parameters_that_vary_reach_what_hangs_on_them() -> None:
    data = {"parameters": {"a": 1, "b": "=2*a"}, "object": {"mass": "=a + b"}, "cage": ["=3"]}
    found = Expressions(data).values({"a": np.array([1.0, 2.0])})
    assert found["object", "mass"].tolist() == [3.0, 6.0]
    assert found["cage", 0] == 3.0


@pytest.mark.parametrize("text", ["play / 2 < 1", "play ** 2", "unknown + play"])
def test_an_expression_lets_its_rows_go_at_once(text: str) -> None:
    # The command line lets Python look for rings so seldom that a million rows would stay in memory.
    rows = np.ones(3)
    kept = weakref.ref(rows)
    gc.disable()
    try:
        with contextlib.suppress(ValueError):
            Expression(text).value({"play": rows})
        del rows
        assert kept() is None
    finally:
        gc.enable()


@pytest.mark.parametrize(("place", "number"), [(("object", "pose", "position", 1), 3.0), (("parameters", "top"), 12.0)])
def test_a_number_in_the_place_of_an_expression_counts(place: tuple[str | int, ...], number: float) -> None:
    text = scene_text_of(SCENE, "s.yaml")
    position = text.scene_with({place: number}).scene.object.pose_world_object.position_m * 1e3
    assert position.tolist() == pytest.approx([2, 3, 10] if place[0] == "object" else [2, 4, 12])
    assert text.scene_with({}).scene.object.pose_world_object.position_m * 1e3 == pytest.approx([2, 4, 10])
    whole = text.scene_with({("object", "pose"): {"position": [1.0, 2.0, 30.0]}}).scene
    assert whole.object.pose_world_object.position_m * 1e3 == pytest.approx([1, 2, 30])
