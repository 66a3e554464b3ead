"""What the viewer's server answers about the text of a scene and its file."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cagepose import load_scene, run
from cagepose.errors import SceneFileError
from cagepose.files.scene_file import parse_scene
from cagepose.views.viewer.editing import Desk
from cagepose.views.viewer.server import ViewServer
from cagepose.views.viewer.what_if import WhatIf
from driving import served
from our_scenes import SCENES

PLATE = """\
name: plate
object:
  boxes: [{size: [20, 20, 1]}]
  pose: {position: [0, 0, 5]}
cage: {points: {file: points.csv}}
loads: [{name: weight, gravity: [0, 0, -1]}]
"""
TEXT = next(path for path in SCENES if path.stem == "rollers").read_text(encoding="utf-8")


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "rollers.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture
def server(scene: Path) -> Iterator[ViewServer]:
    with served(scene) as server:
        yield server


def ask(server: ViewServer, path: str, question: object, **headers: str) -> tuple[int, Any]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
    connection.request(
        "POST", server.root + path, json.dumps(question), {"Content-Type": "application/json", **headers}
    )
    response = connection.getresponse()
    content = response.read()
    connection.close()
    return response.status, json.loads(content) if content.startswith(b"{") else content


def test_a_text_is_run_and_nothing_of_it_stays(server: ViewServer, scene: Path) -> None:
    """The next question without a text is about the file as it was."""
    text = TEXT.replace("coefficient: 0.1", "coefficient: 0.3")
    status, answer = ask(server, "/run", {"text": text, "values": {}})
    assert status == 200
    assert next(control for control in answer["controls"] if control["key"] == "friction")["value"] == 0.3
    assert answer["shots"][-1]["origin"] == pytest.approx((run(parse_scene(text)).pose.position_m * 1e3).tolist())
    assert "coefficient: 0.1" in ask(server, "/run", {"values": {}})[1]["text"]
    assert scene.read_text(encoding="utf-8") == TEXT


def test_mistakes_are_told_with_their_lines_in_the_words_of_the_command(server: ViewServer, scene: Path) -> None:
    text = TEXT.replace("size: [400, 40, 10]", "size: [400, 40]").replace("friction:", "frictoin:")
    status, answer = ask(server, "/run", {"text": text})
    scene.write_text(text, encoding="utf-8")
    with pytest.raises(SceneFileError) as raised:
        load_scene(scene)
    assert status == 422
    assert len(answer["mistakes"]) == 2
    told = [f"{scene}:{one['line']}:{one['column']}: {one['words']}" for one in answer["mistakes"]]
    assert told == [str(problem) for problem in raised.value.problems]
    assert text.splitlines()[answer["mistakes"][1]["line"] - 1].startswith("frictoin")


@pytest.mark.parametrize("text", ["", "name: [", "\0", "name: a\tb: 3\n\t- 4", "{" * 500, '{"version": 3}', "\ud800"])
def test_a_text_that_is_no_scene_is_refused_and_the_server_goes_on(server: ViewServer, text: str) -> None:
    status, answer = ask(server, "/run", {"text": text})
    assert status == 422
    assert answer["problems"]
    assert ask(server, "/run", {"values": {}})[0] == 200


def test_a_number_of_the_text_can_be_asked_for_by_its_key_and_nothing_else_can(server: ViewServer) -> None:
    key = "cage.shapes[0].capsule.radius"
    status, answer = ask(server, "/run", {"values": {key: 7.5}})
    assert status == 200
    assert answer["text"] == TEXT.replace("low front, capsule: {radius: 8,", "low front, capsule: {radius: 7.5,")
    for refused in ("cage.shapes[9].capsule.radius", "name", "units.length", "cage", "a..b", "object.boxes"):
        status, answer = ask(server, "/run", {"values": {refused: 1.0}})
        assert (status, answer["problems"]) == (422, [f"{refused} cannot be changed here"])
    assert ask(server, "/run", {"values": {key: "wide"}})[0] == 422


def test_a_number_of_the_start_and_a_moved_cage_hold_both(server: ViewServer) -> None:
    values = {"object.pose.position[2]": 0.3, "cage.pose.position": [0.0, 5.0, 0.0]}
    status, answer = ask(server, "/run", {"values": values})
    assert status == 200
    start = parse_scene(answer["text"]).object.pose_world_object.position_m
    assert (start * 1e3).tolist() == pytest.approx([0.0, 5.0, 0.3], abs=1e-12)


def test_expressions_stay_where_another_component_is_changed(tmp_path: Path) -> None:
    text = PLATE.replace("loads:", "parameters: {tilt: 0.5}\nloads:").replace(
        "{points: {file: points.csv}}",
        '{points: [[5, 0, 0], [-5, 4, 0], [-5, -4, 0]], pose: {euler_zyx_deg: [0, "=tilt", 0]}}',
    )
    (tmp_path / "plate.yaml").write_text(text, encoding="utf-8")
    desk = Desk(tmp_path / "plate.yaml")
    told = desk.answers["/run"]({"values": {"cage.pose.euler_zyx_deg": [0.2, 0.5, 0]}})["text"]
    assert 'pose: {euler_zyx_deg: [0.2, "=tilt", 0]}' in told
    told = desk.answers["/run"]({"values": {"cage.pose.euler_zyx_deg": [0, 0.6, 0]}})["text"]
    assert "euler_zyx_deg: [0, 0.6, 0]" in told


def test_the_file_is_sent_again_only_when_it_was_changed(server: ViewServer, scene: Path) -> None:
    first = ask(server, "/file", {"version": None})[1]
    assert first["text"] == TEXT
    assert "text" not in ask(server, "/file", {"version": first["version"]})[1]
    scene.write_text(TEXT + "# more\n", encoding="utf-8")
    assert ask(server, "/file", {"version": first["version"]})[1]["text"] == TEXT + "# more\n"
    scene.unlink()
    assert ask(server, "/file", {"version": None})[1]["problem"] == "rollers.yaml is not there any more"


def test_files_that_a_text_names_are_watched_and_read_anew(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("5,0,0\n-5,4,0\n-5,-4,0\n", encoding="utf-8")
    (tmp_path / "plate.yaml").write_text(PLATE, encoding="utf-8")
    desk = Desk(tmp_path / "plate.yaml")
    answer = desk.answers["/run"]({})
    names, stamp = answer["beside"]["names"], answer["beside"]["stamp"]
    assert names == ["points.csv"]
    assert desk.answers["/file"]({"beside": names})["stamp"] == stamp
    points.write_text("5,0,1.5\n-5,4,1.5\n-5,-4,1.5\n", encoding="utf-8")
    assert desk.answers["/file"]({"beside": names})["stamp"] != stamp
    assert desk.answers["/run"]({})["shots"][-1]["origin"] == pytest.approx([0.0, 0.0, 2.0])
    with pytest.raises(ValueError, match="no list of names"):
        desk.answers["/file"]({"beside": [3]})


def test_a_file_that_is_written_while_it_is_run_is_another_one_afterwards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = tmp_path / "points.csv"
    points.write_text("5,0,0\n-5,4,0\n-5,-4,0\n", encoding="utf-8")
    (tmp_path / "plate.yaml").write_text(PLATE, encoding="utf-8")
    desk, answer = Desk(tmp_path / "plate.yaml"), WhatIf.answer

    def and_meanwhile(what_if: WhatIf, values: object) -> dict[str, Any]:
        found = answer(what_if, values)
        points.write_text("5,0,1.5\n-5,4,1.5\n-5,-4,1.5\n", encoding="utf-8")
        return found

    monkeypatch.setattr(WhatIf, "answer", and_meanwhile)
    beside = desk.answers["/run"]({})["beside"]
    assert desk.answers["/file"]({"beside": beside["names"]})["stamp"] != beside["stamp"]


def test_saving_writes_the_file_and_refuses_where_it_was_changed_on_disk(server: ViewServer, scene: Path) -> None:
    scene.chmod(0o600)
    version = ask(server, "/file", {"version": None})[1]["version"]
    status, saved = ask(server, "/save", {"text": TEXT + "# mine\n", "version": version})
    assert status == 200
    assert scene.read_text(encoding="utf-8") == TEXT + "# mine\n"
    assert scene.stat().st_mode & 0o777 == 0o600
    scene.write_text(TEXT + "# theirs\n", encoding="utf-8")
    for text, known in (("x", saved["version"]), ("x", None), (None, saved["version"])):
        status, answer = ask(server, "/save", {"text": text, "version": known})
        assert status == 422
    assert scene.read_text(encoding="utf-8") == TEXT + "# theirs\n"
    status, answer = ask(server, "/save", {"text": "x", "version": saved["version"]})
    assert answer["problems"] == ["not saved: rollers.yaml was changed on disk since this page read it"]
    scene.unlink()
    assert "is not there any more" in ask(server, "/save", {"text": "x", "version": saved["version"]})[1]["problems"][0]
    assert not scene.exists()


def test_line_ends_of_the_file_stay_as_they_are(tmp_path: Path) -> None:
    path = tmp_path / "returns.yaml"
    path.write_bytes(TEXT.replace("\n", "\r\n").encode())
    with served(path) as server:
        found = ask(server, "/file", {"version": None})[1]
        assert found["text"] == TEXT
        assert ask(server, "/save", {"text": TEXT + "# a\n", "version": found["version"]})[0] == 200
        assert "\r" not in ask(server, "/run", {"values": {"friction": 0.2}})[1]["text"]
        assert b"\\r" not in server.page.partition(b'id="data">')[2].partition(b"</script>")[0]
    assert path.read_bytes() == (TEXT + "# a\n").replace("\n", "\r\n").encode()


def test_single_returns_are_line_ends_to_the_page_too(tmp_path: Path) -> None:
    """So the text that the page compares with the file's is the one that its editor shows."""
    path = tmp_path / "returns.yaml"
    path.write_bytes(TEXT.replace("\n", "\r").encode())
    assert Desk(path).page_content()["text"] == TEXT


def test_save_as_makes_a_new_file_in_the_same_folder_and_overwrites_none(server: ViewServer, scene: Path) -> None:
    assert ask(server, "/save-as", {"text": TEXT, "name": "other"}) == (200, {"name": "other.yaml"})
    assert (scene.parent / "other.yaml").read_text(encoding="utf-8") == TEXT
    for name in (
        "other",
        "rollers.yaml",
        "../up.yaml",
        "/tmp/up.yaml",
        "..",
        "",
        " ",
        ".hidden",
        "a\0b",
        "a\\b",
        3,
        None,
    ):
        status, answer = ask(server, "/save-as", {"text": "x", "name": name})
        assert status == 422, name
        assert answer["problems"][0].startswith("not saved: "), name
    assert sorted(path.name for path in scene.parent.iterdir()) == ["other.yaml", "rollers.yaml"]
    assert (scene.parent / "other.yaml").read_text(encoding="utf-8") == TEXT


@pytest.mark.parametrize(
    "text", ["half a character: \ud800", "# " + 4 * 1024**2 * "x"], ids=["half a character", "too large"]
)
def test_of_a_text_that_no_file_can_hold_no_empty_file_is_left(server: ViewServer, scene: Path, text: str) -> None:
    version = ask(server, "/file", {"version": None})[1]["version"]
    for path in ("/save-as", "/save"):
        assert ask(server, path, {"text": text, "name": "other", "version": version})[0] == 422
    assert [path.name for path in scene.parent.iterdir()] == ["rollers.yaml"]
    assert scene.read_text(encoding="utf-8") == TEXT


def test_a_file_that_cannot_be_written_is_told_by_its_own_name(server: ViewServer) -> None:
    name = 300 * "x"
    problems = ask(server, "/save-as", {"text": TEXT, "name": name})[1]["problems"]
    assert problems == [f"not saved: {name}.yaml cannot be written: File name too long"]


def test_a_file_that_is_write_protected_stays_as_it_is(server: ViewServer, scene: Path) -> None:
    scene.chmod(0o444)
    version = ask(server, "/file", {"version": None})[1]["version"]
    status, answer = ask(server, "/save", {"text": "x", "version": version})
    assert status == 422
    assert answer["problems"] == ["not saved: rollers.yaml is write-protected; save under another name"]
    assert scene.read_text(encoding="utf-8") == TEXT


def test_nobody_writes_by_another_name_or_without_json(server: ViewServer, scene: Path) -> None:
    version = ask(server, "/file", {"version": None})[1]["version"]
    question = {"text": "x", "version": version, "name": "new"}
    for path in ("/save", "/save-as", "/file"):
        assert ask(server, path, question, Host="evil.example")[0] == 403
        assert ask(server, path, question, **{"Content-Type": "text/plain"})[0] == 422
    assert [path.name for path in scene.parent.iterdir()] == ["rollers.yaml"]
    assert scene.read_text(encoding="utf-8") == TEXT


def test_runs_with_other_numbers_end_as_the_scene_with_these(server: ViewServer) -> None:
    """The upper front roller: lower, it presses on the bar, where no run can begin."""
    key, numbers = "cage.shapes[2].position[2]", [13.5, 13.0, 13.3, 13.9]
    status, answer = ask(server, "/vary", {"text": TEXT, "key": key, "numbers": numbers})
    assert status == 200
    assert (answer["unit"], answer["lengthUnit"]) == ("mm", "mm")
    assert "inside" in answer["runs"][1]["problem"]
    for number, told in zip(numbers, answer["runs"], strict=True):
        if number == 13.0:
            continue
        expected = run(parse_scene(TEXT, set_values=[f"{key}={number}"]))
        center = expected.pose.transform(expected.scene.object.center_of_gravity_m)
        assert told["verdicts"] == [phase.verdict for phase in expected.phases]
        assert told["verdict"] == expected.verdict
        assert told["center"] == pytest.approx((center * 1e3).tolist(), abs=1e-9)
        assert set(told["touching"]) == {contact.point for contact in expected.phases[-1].contacts}


@pytest.mark.parametrize(
    ("key", "numbers"),
    [
        ("name", [1.0]),
        ("cage.shapes[99].position[0]", [1.0]),
        ("friction.coefficient", [1.0] * 65),
        ("friction.coefficient", ["wide"]),
        ("friction.coefficient", [True]),
        ("friction.coefficient", None),
        ("[", [1.0]),
    ],
)
def test_what_cannot_be_varied_is_refused(server: ViewServer, key: str, numbers: object) -> None:
    assert ask(server, "/vary", {"text": TEXT, "key": key, "numbers": numbers})[0] == 422


def test_where_the_network_may_look_no_text_is_taken_and_no_file_written(scene: Path) -> None:
    desk = Desk(scene, can_edit=False)
    assert set(desk.answers) == {"/run", "/pull", "/ask"}
    assert "edit" not in desk.page_content()
    with pytest.raises(ValueError, match="the text cannot be changed from here"):
        desk.answers["/run"]({"text": TEXT})
