"""Whatever stands in a file, the answer is a Scene or a SceneFileError: no crash, no warning, no other error."""

from __future__ import annotations

from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cagepose import Scene, SceneFileError
from cagepose.errors import key_path
from cagepose.files.key_path import parse_key_path
from cagepose.files.scene_file import parse_scene
from cagepose.files.schema import scene_json_schema
from cagepose.files.yaml_source import parse_yaml

SETTINGS = settings(
    max_examples=150, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
KEYS = sorted(
    {key for part in (scene_json_schema(), *scene_json_schema()["$defs"].values()) for key in part["properties"]}
)
NUMBERS = st.one_of(
    st.integers(-20, 20),
    st.floats(width=64),
    st.sampled_from([0.0, -0.0, 1e-320, 1e-12, 1e-11, 1e11, 1e12, 1e308, 10**400, float("nan"), float("inf")]),
)
SCALARS = st.one_of(NUMBERS, st.booleans(), st.none(), st.text(max_size=5), st.sampled_from(["mm", "stepwise", "C1"]))
VECTORS = st.lists(NUMBERS, min_size=3, max_size=3)
VALUES = st.recursive(
    st.one_of(SCALARS, VECTORS),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=3), inner, max_size=4)
    ),
    max_leaves=8,
)


def _is_scene_or_refused(text: str, *changes: str) -> None:
    refusal = None
    try:
        scene = parse_scene(text, "fuzz.yaml", changes)
    except SceneFileError as error:
        refusal = error
    if refusal is None:
        assert isinstance(scene, Scene)
        assert scene.size_m > 0.0
    else:
        lines = str(refusal).splitlines()
        assert len(lines) == len(refusal.problems) > 0
        assert all(line.startswith(("fuzz.yaml", "--set ")) for line in lines)


@SETTINGS
@given(st.text(max_size=200))
def test_any_text(text: str) -> None:
    _is_scene_or_refused(text)


@SETTINGS
@given(st.text(alphabet="ab:-[]{}&*!|>'\"%@`#,?~<. \n\t0123\\\r\u2028\ufeff", max_size=60))
def test_any_text_of_yaml_signs(text: str) -> None:
    _is_scene_or_refused(text)


@SETTINGS
@given(place=st.integers(0, 10_000), length=st.integers(0, 6), put=st.text(max_size=3))
def test_a_good_scene_with_a_piece_replaced(sample_text: str, place: int, length: int, put: str) -> None:
    place %= len(sample_text)
    _is_scene_or_refused(sample_text[:place] + put + sample_text[place + length :])


@SETTINGS
@given(st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=6))
def test_any_data_under_known_keys(data: dict[str, Any]) -> None:
    _is_scene_or_refused(_flow(data))


PATHS = st.sampled_from(
    [
        *("name", "units", "units.length", "object", "object.boxes", "object.boxes[0]", "object.boxes[0].size"),
        *("object.boxes[0].size[1]", "object.boxes[0].position[0]", "object.boxes[0].euler_zyx_deg", "object.pose"),
        *("object.pose.position", "object.pose.position[2]", "object.pose.quat_wxyz", "object.center_of_gravity"),
        *("object.mass", "object.inertia", "cage.points", "cage.points[2]", "cage.points[2][1]", "cage.pose"),
        *("cage.pose.euler_zyx_deg", "cage.pose.position", "loads", "loads[0].gravity", "loads[0].force.direction"),
        *("loads[0].force", "friction", "friction.angle_deg", "method", "tolerances", "tolerances.touch", "adjustable"),
    ]
)


@SETTINGS
@given(st.lists(st.tuples(PATHS, VALUES | VECTORS | NUMBERS), min_size=1, max_size=3))
def test_a_good_scene_with_values_set_to_anything(sample_text: str, changes: list[tuple[str, Any]]) -> None:
    _is_scene_or_refused(sample_text, *(f"{path}={_flow(value)}" for path, value in changes))


@SETTINGS
@given(st.text(max_size=12))
def test_any_key_path_is_read_or_refused(text: str) -> None:
    try:
        path = parse_key_path(text)
    except ValueError:
        return
    assert parse_key_path(key_path(path)) == path


@SETTINGS
@given(VALUES)
def test_data_written_as_flow_yaml_comes_back(value: Any) -> None:
    assert repr(parse_yaml(_flow(value), "x").data) == repr(value).replace(repr(10**400), "inf")


def _flow(value: Any) -> str:
    """Write data as YAML flow, numbers in YAML's spelling and text in double quotes with every character escaped."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case float():
            return {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}.get(repr(value), repr(value))
        case int():
            return f"{value:d}" if abs(value) < 10**300 else "9" * 400
        case str():
            return '"' + "".join(f"\\U{ord(char):08X}" for char in value) + '"'
        case list():
            return f"[{', '.join(_flow(item) for item in value)}]"
        case _:
            return "{" + ", ".join(f"{_flow(key)}: {_flow(item)}" for key, item in value.items()) + "}"
