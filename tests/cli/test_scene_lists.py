"""``cagepose run`` of several scenes, and of one on standard input."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Command = Callable[..., Any]


@pytest.fixture
def other(sample: str) -> str:
    """The sample as another scene, which escapes."""
    text = Path(sample).read_text(encoding="utf-8")
    Path("other.yaml").write_text(text.replace("[0, 0, -1]", "[0, 0, 1]").replace("sample", "other"), encoding="utf-8")
    return "other.yaml"


def without_time(document: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in document.items() if key != "timing_s"}


def standard_input(monkeypatch: pytest.MonkeyPatch, content: bytes) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))


def test_several_scenes_print_a_document_on_each_line(command: Command, sample: str, other: str) -> None:
    answer = command("run", sample, other, "--json", "--set", "friction.coefficient=0.2")
    lines = [json.loads(line) for line in answer.out.splitlines()]
    alone = [
        json.loads(command("run", name, "--json", "--set", "friction.coefficient=0.2").out) for name in (sample, other)
    ]
    assert answer.code == 0
    assert list(map(without_time, lines)) == list(map(without_time, alone))
    assert [line["scene"] for line in lines] == ["sample", "other"]


def test_several_scenes_print_their_tables_one_below_the_other(command: Command, sample: str, other: str) -> None:
    lines = command("run", sample, other).out.splitlines()
    firsts = [place for place, line in enumerate(lines) if line.startswith(("sample: ", "other: "))]
    assert firsts[0] == 0
    assert lines[firsts[1] - 1] == ""


def test_the_exit_code_is_the_worst_of_all(command: Command, sample: str, other: str) -> None:
    text = Path(sample).read_text(encoding="utf-8").replace("object:", "object:\n  mass: 1")
    moment = text.replace("gravity: [0, 0, -1]", "moments: [{direction: [0, 0, 1], magnitude: 0.02}]")
    for point in ("4, 4", "4, -4", "-4, -4", "-4, 4"):
        moment = moment.replace(f"[{point}, 0]", f"[{point}, -90]")  # out of reach: it turns for ever
    Path("turned.yaml").write_text(moment, encoding="utf-8")
    answer = command("run", "turned.yaml", other, "--json")
    assert [json.loads(line)["verdict"] for line in answer.out.splitlines()] == ["limit", "escapes"]
    assert answer.code == 1


def test_nothing_runs_if_one_scene_cannot_be_used(command: Command, sample: str) -> None:
    answer = command("run", sample, "none.yaml", "also-none.yaml")
    assert (answer.code, answer.out) == (2, "")
    assert [line.split(":")[0] for line in answer.err.splitlines()] == ["none.yaml", "also-none.yaml"]


def test_a_scene_may_come_on_standard_input(command: Command, sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    content = Path(sample).read_bytes()
    standard_input(monkeypatch, content)
    piped = json.loads(command("run", "--json", "-").out)
    assert without_time(piped) == without_time(json.loads(command("run", sample, "--json").out))
    for wrong, message in (
        (content.replace(b"size", b"sise"), "/dev/stdin:4:7: object.boxes[0].size: is missing"),
        (b"\xff\xfe", "/dev/stdin: is UTF-16 text; save it as UTF-8"),
        (b"", "/dev/stdin: is empty; write a scene into it"),
        (b"#" * (4 * 1024 * 1024 + 1), "/dev/stdin: is larger than 4 MiB"),
    ):
        standard_input(monkeypatch, wrong)
        answer = command("run", "-")
        assert answer.code == 2
        assert answer.err.startswith(message), answer.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--out", "run.json", "other.yaml"), "--out saves one run; name one scene."),
        (("-", "-"), "standard input is read once; name it once."),
        (("a=2",), "too many arguments: a=2; each change needs its own --set."),
    ],
)
@pytest.mark.usefixtures("other")
def test_a_list_that_cannot_be_run_is_said_in_a_line(
    command: Command, sample: str, arguments: tuple[str, ...], message: str
) -> None:
    assert command("run", sample, *arguments) == (2, "", f"cagepose: {message} See: cagepose run --help\n")
