"""Questions that the live page asks about its run, in a real browser."""

from __future__ import annotations

import http.client
import json
from typing import Any

import pytest

from cagepose import load_scene, run
from cagepose.files.answers import friction
from cagepose.files.words import LengthWords
from cagepose.questions.friction import friction_limits
from driving import opened, served, slide, wait_until
from our_scenes import SCENES

GROOVE, SAMPLE = (next(path for path in SCENES if path.stem == name) for name in ("v-groove", "sample"))
ANSWERED = "document.querySelector('#answer dt')?.innerText === 'at the end of'"


def test_the_page_tells_what_the_command_prints_until_another_run_is_shown(watched: Any) -> None:
    with served(GROOVE) as server:
        page = opened(watched, server)
        page.get_by_role("button", name="How much friction does it need?").click()
        wait_until(page, ANSWERED)
        scene = load_scene(GROOVE)
        lines = friction.lines(friction_limits(run(scene)), LengthWords("mm", scene.size_m))
        assert page.locator("#answer dt").all_inner_texts() == [name for name, _ in lines]
        assert page.locator("#answer dd").all_inner_texts() == [text for _, text in lines]
        slide(page, "cage: pitch", 0.1)
        assert page.locator("#answer dt").count() == 0


def test_rests_in_the_cage_are_told_as_a_table(watched: Any) -> None:
    with served(SAMPLE) as server:
        page = opened(watched, server)
        page.get_by_role("button", name="Where else may it come to rest?").click()
        wait_until(page, "document.querySelectorAll('#answertable tbody tr').length > 0")
        head = page.locator("#answertable th").all_inner_texts()
        assert head[:2] == ["#", "share"]
        assert page.locator("#answertable tbody tr").first.locator("td").count() == len(head)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"question": "nothing", "phase": 0}, "that cannot be asked here"),
        ({"question": "friction", "phase": 7}, "the question is about a phase that was not run"),
        ({"question": "friction"}, "the question is about a phase that was not run"),
    ],
)
def test_what_cannot_be_asked_is_refused(asked: dict[str, object], told: str) -> None:
    with served(GROOVE) as server:
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
        connection.request("POST", f"{server.root}/ask", json.dumps(asked), {"Content-Type": "application/json"})
        response = connection.getresponse()
        assert response.status == 422
        assert json.loads(response.read())["problems"] == [told]
        connection.close()
