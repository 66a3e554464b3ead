"""The live viewer in a real browser: a slider moves the object as the solver says, and windows do not meet."""

from __future__ import annotations

import http.client
import json
import re
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cagepose import load_scene, run
from cagepose.files.scene_edit import edited_text
from cagepose.files.scene_file import parse_scene, read_scene_text
from cagepose.runs.run import CONTRADICTED
from cagepose.views.viewer.server import ViewServer
from cagepose.views.viewer.what_if import WhatIf
from driving import opened, pretend_graphics_card, served, shown_angles, slide, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"
RAIL = SCENES / "rail-pitch.yaml"


@pytest.fixture(scope="module")
def server() -> Iterator[ViewServer]:
    with served(RAIL) as server:
        yield server


def expected_angles(*set_values: str) -> list[float]:
    return np.degrees(run(load_scene(RAIL, set_values)).pose.euler_zyx).tolist()


def post(server: ViewServer, path: str, body: bytes, **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
    connection.request("POST", server.root + path, body, {"Content-Type": "application/json", **headers})
    response = connection.getresponse()
    answer = response.status, response.read()
    connection.close()
    return answer


def test_a_slider_moves_the_object_as_the_solver_says_and_nothing_outside_is_asked(watched, server):
    page = opened(watched, server)
    slide(page, "cage: pitch", 0.25)
    expected = expected_angles("cage.pose.euler_zyx_deg=[0,0.25,0]")
    assert shown_angles(page) == pytest.approx(expected, abs=1e-5)
    slide(page, "push: direction y", -0.3)
    assert set(watched.requests) == {server.address, server.address + "run", server.address + "file"}


def test_undo_goes_back_to_the_values_of_the_file(watched, server):
    page = opened(watched, server)
    first = shown_angles(page)
    slide(page, "cage: yaw", 0.2)
    page.locator("#undo").click()
    wait_until(page, "cagepose.state().drawnAnswers === 2")
    assert shown_angles(page) == pytest.approx(first, abs=1e-6)
    assert page.get_by_label("cage: yaw", exact=True).last.input_value() == "0"


def test_a_value_that_cannot_be_is_told_in_the_page_and_the_last_scene_stays(watched, server):
    page = opened(watched, server)
    before = shown_angles(page)
    slide(page, "push: direction x", 0)
    told = page.locator("#problems").inner_text()
    assert "is all zeros, which points nowhere" in told
    assert "The picture shows the last scene that could be run" in told
    assert shown_angles(page) == before
    watched.expect("status of 422")
    page.locator("#undo").click()
    wait_until(page, "problems.innerText === ''")


def test_the_start_can_be_dragged_and_the_picture_stays_where_it_is(watched, tmp_path):
    """The start follows the pointer, and the run from there is that of the scene which is saved."""
    with served(SCENES / "sample.yaml") as server:
        page = opened(watched, server)
        before = load_scene(SCENES / "sample.yaml").object.pose_world_object.position_m
        page.locator("#start").check()
        page.locator("#first").click()
        points = page.evaluate("cagepose.state().points.map(cagepose.project)")
        box = page.locator("#scene").bounding_box()
        x, y = page.evaluate("cagepose.project(cagepose.state().shownPose.p)")
        page.mouse.move(box["x"] + x, box["y"] + y)
        page.mouse.down()
        page.mouse.move(box["x"] + x + 10, box["y"] + y - 20)
        wait_until(page, "cagepose.state().drawnAnswers === 1")
        assert page.evaluate("cagepose.state().drawnTime") == 0
        moved = page.evaluate("cagepose.project(cagepose.state().shownPose.p)")
        assert np.array(moved) - (x, y) == pytest.approx(
            [10, -20], abs=2.0
        )  # perspective: it is beside what one looks at
        assert np.array(page.evaluate("cagepose.state().points.map(cagepose.project)")) == pytest.approx(
            np.array(points), abs=1.0
        )
        page.mouse.up()
        wait_until(page, "cagepose.state().drawnTime > 0")
        with page.expect_download() as saved:
            page.locator("#save").click()
        saved.value.save_as(tmp_path / "dragged.yaml")
        scene = load_scene(tmp_path / "dragged.yaml")
        assert np.linalg.norm(scene.object.pose_world_object.position_m - before) > 1e-4
        assert shown_angles(page) == pytest.approx(np.degrees(run(scene).pose.euler_zyx).tolist(), rel=1e-5)


def test_sliders_that_leave_shapes_alone_build_none_anew(watched):
    """Building them took half of the time from a slider to its picture."""
    with served(SCENES / "drawer.yaml") as server:
        page = opened(watched, server)
        for pitch in (0.1, 0.2, -0.1):
            slide(page, "cage: pitch", pitch)
        assert state(page)["built"] == 1
    with served(SCENES / "peg-in-hole.yaml") as server:
        page = opened(watched, server)
        slide(page, "adjustable: radius of the hole", 6.5)
        assert state(page)["built"] == 2


def test_two_windows_do_not_disturb_each_other(watched, server):
    one = opened(watched, server)
    other = one.context.new_page()
    other.goto(server.address)
    wait_until(other, "cagepose.state().drawn > 0")
    untouched = shown_angles(other)
    slide(one, "cage: pitch", -0.2)
    slide(other, "cage: yaw", 0.1)
    assert shown_angles(one) == pytest.approx(expected_angles("cage.pose.euler_zyx_deg=[0,-0.2,0]"), abs=1e-5)
    assert shown_angles(other) == pytest.approx(expected_angles("cage.pose.euler_zyx_deg=[0.1,0.1,0]"), abs=1e-5)
    assert shown_angles(other) != pytest.approx(untouched, abs=1e-5)


def test_a_rest_that_the_mechanics_contradicts_is_not_green(watched):
    with served(SCENES / "sample.yaml") as server:
        page = opened(watched, server)
        assert page.locator("#contradicted").inner_text() == CONTRADICTED
        assert page.locator("#verdict").get_attribute("class") == "elsewhere"
        page.locator("#controls select").select_option("quasistatic")
        wait_until(page, "cagepose.state().drawnAnswers === 1")
        assert page.locator("#contradicted").is_hidden()
        assert page.locator("#verdict").get_attribute("class") == "rest"


def test_the_saved_scene_is_the_one_on_screen(watched, server, tmp_path):
    page = opened(watched, server)
    slide(page, "cage: pitch", 0.25)
    slide(page, "contacts: friction", 0.2)
    with page.expect_download() as download:
        page.locator("#save").click()
    assert download.value.suggested_filename == "rail-pitch-changed.yaml"
    download.value.save_as(tmp_path / "saved.yaml")
    saved = load_scene(tmp_path / "saved.yaml")
    assert saved.friction_coefficient == 0.2
    assert np.degrees(saved.cage.pose_world_cage.euler_zyx) == pytest.approx([0.0, 0.25, 0.0])


def test_another_method_is_run_when_chosen(watched, server):
    page = opened(watched, server)
    page.locator("#controls select").select_option("stepwise")
    wait_until(page, "method.innerText.startsWith('stepwise')")
    assert state(page)["answers"] == 1


def test_a_saved_run_is_shown_without_controls(watched):
    with served(RAIL, can_change=False) as server:
        page = opened(watched, server)
        assert not page.locator("#panel").is_visible()
        assert post(server, "/run", b"{}")[0] == 404


def test_the_server_answers_nobody_who_comes_by_another_name_or_without_json(server):
    assert post(server, "/run", b"{}")[0] == 200
    assert post(server, "/run", b"{}", Host="evil.example")[0] == 403
    assert post(server, "/run", b"{}", **{"Content-Type": "text/plain"})[0] == 422
    assert post(server, "/run", b"{" * 100_000)[0] == 422


REFUSED = {
    "another name": "POST {root}/run HTTP/1.1\r\nHost: evil.example\r\nContent-Length: {length}\r\n\r\n",
    "another path": "POST {root}/nowhere HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n\r\n",
    "without the key": "POST /run HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n\r\n",
    "no length": "POST {root}/run HTTP/1.1\r\nHost: {host}\r\n\r\n",
    "a length that is none": "POST {root}/run HTTP/1.1\r\nHost: {host}\r\nContent-Length: -5\r\n\r\n",
}


@pytest.mark.parametrize("head", REFUSED.values(), ids=REFUSED)
def test_what_a_refused_request_sent_is_not_read_as_the_next_one(server, head):
    host = f"127.0.0.1:{server.server_port}"
    hidden = f"GET {server.root}/ HTTP/1.1\r\nHost: {host}\r\n\r\n"
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=30) as connection:
        connection.sendall((head.format(root=server.root, host=host, length=len(hidden)) + hidden).encode())
        answer = b"".join(iter(lambda: connection.recv(65536), b""))
    assert answer.count(b"HTTP/1.1 ") == 1
    assert answer.startswith((b"HTTP/1.1 403", b"HTTP/1.1 404", b"HTTP/1.1 422"))


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"cage.points.file": "/etc/passwd"}, "cage.points.file cannot be changed here"),
        ({"friction": {"coefficient": 1}}, "friction is no number, no word and no list of numbers"),
        ({"cage.pose.position": [0, 0]}, "has 2 values; give 3"),
        ({"friction": -1}, "friction"),
        ([], "the values are no mapping"),
        ({"loads[1].force.direction": [0, 0, 0]}, "points nowhere"),
    ],
)
def test_bad_values_are_refused_with_the_reason(server, values, told):
    status, body = post(server, "/run", json.dumps({"values": values}).encode())
    assert status == 422
    assert told in " ".join(json.loads(body)["problems"])


def test_a_start_that_was_dragged_into_the_cage_is_told_without_its_numbers(server):
    status, body = post(server, "/run", json.dumps({"values": {"start": [-3.0, -2.0, -2.0]}}).encode())
    assert status == 422
    problems = json.loads(body)["problems"]
    assert all(re.match(r"cage\.points\.C\d+: starts \S+ mm inside object\.boxes", problem) for problem in problems)


def test_from_slider_to_new_pose_takes_less_than_50_ms_on_the_server():
    """In processor time, which does not hang on what else the machine does."""
    what_if = WhatIf(read_scene_text(RAIL))
    what_if.answer({})
    times = []
    for step in range(15):
        start = time.process_time()
        json.dumps(what_if.answer({"cage.pose.euler_zyx_deg": [0.0, 0.1 + 0.01 * step, 0.0]}))
        times.append(time.process_time() - start)
    assert np.median(times) < 0.050


def test_a_saved_scene_keeps_its_comments_and_changes_nothing_else():
    text = read_scene_text(RAIL)
    edited = edited_text(text, ["friction.coefficient=0.3"])
    lines = {"".join(line.split()) for line in text.text.splitlines()}  # but for spaces within a line
    assert [line for line in edited.splitlines() if "".join(line.split()) not in lines] == [
        "friction:",
        "  coefficient: 0.3",
    ]
    assert parse_scene(edited).friction_coefficient == 0.3


def test_a_server_that_is_gone_is_told_and_the_last_answer_stays(watched, server):
    page = opened(watched, server)
    before = shown_angles(page)
    page.context.set_offline(True)
    page.get_by_label("cage: pitch", exact=True).last.fill("0.2")
    wait_until(page, "!problems.hidden")
    assert "The viewer's server does not answer" in page.locator("#problems").inner_text()
    assert shown_angles(page) == before
    page.locator("#first").click()
    assert state(page)["time"] == 0
    watched.expect("net::ERR")


def test_an_answer_is_drawn_before_the_browser_asks_for_a_picture_but_once_for_each(watched, server):
    """In a browser that asks for pictures when it is told to. It need not wait for them then, nor do any queue up."""
    page = opened(watched, server)
    page.evaluate("() => { window.asked = []; window.requestAnimationFrame = (draw) => asked.push(draw); }")
    slide(page, "cage: pitch", 0.2)
    assert state(page)["drawnAnswers"] == 1
    page.get_by_label("cage: pitch", exact=True).last.fill("0.25")
    wait_until(page, "cagepose.state().answers === 2")
    assert state(page)["drawnAnswers"] == 1
    page.evaluate("asked.splice(0).forEach((draw) => draw())")
    assert state(page)["drawnAnswers"] == 2
    assert shown_angles(page) == pytest.approx(expected_angles("cage.pose.euler_zyx_deg=[0,0.25,0]"), abs=1e-5)


def test_shadows_go_where_pictures_come_slowly(watched):
    """A machine that says it has a graphics card, and takes 60 ms more for each picture."""
    pretend_graphics_card(watched.page)
    watched.page.add_init_script("""
        const next = window.requestAnimationFrame.bind(window);
        window.requestAnimationFrame = (draw) => next(() => setTimeout(() => draw(performance.now()), 60));
    """)
    with served(SCENES / "sample.yaml") as server:
        page = opened(watched, server)
        assert state(page)["hasShadows"]
        page.locator("#play").click()
        wait_until(page, "!cagepose.state().hasShadows")
        before = state(page)["drawn"]
        wait_until(page, f"cagepose.state().drawn > {before}")
