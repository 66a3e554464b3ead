"""Serve a scene to a browser, ask a page of the viewer what it shows, and move its sliders."""

from __future__ import annotations

import itertools
import os
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from cagepose import run
from cagepose.files.scene_file import read_scene_text
from cagepose.views.viewer.editing import Desk
from cagepose.views.viewer.page import page as page_text
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.server import ViewServer, open_server

HOST = "127.0.0.1"
_WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
_PORTS = itertools.count(20_000 + 250 * _WORKER)
"""Below those that the system hands out, and of this process alone, so that tests side by side do not meet."""


def free_port() -> int:
    """A port that nobody listens on."""
    for port in _PORTS:
        with suppress(OSError), socket.create_server((HOST, port)):
            return port
    raise AssertionError("no port is free")


@contextmanager
def served(scene_path: Path, set_values: tuple[str, ...] = (), *, can_change: bool = True) -> Iterator[ViewServer]:
    """A server in this process, with or without controls."""
    text = read_scene_text(scene_path)
    scene_file = text.scene_file(set_values)
    desk = Desk(scene_path, set_values) if can_change else None
    film = playback(run(scene_file.scene), scene_file.length_unit)
    with open_server(page_text(film, desk), desk, HOST, free_port()) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield server
        server.shutdown()


def opened(watched: Any, server: ViewServer) -> Page:
    """The server's page, once it has drawn."""
    page: Page = watched.page
    page.goto(server.address)
    wait_until(page, "cagepose.state().drawn > 0")
    return page


def slide(page: Page, label: str, value: float) -> None:
    """Move a slider by its number box, and wait for the answer or the complaint."""
    before = state(page)["answers"]
    page.get_by_label(label, exact=True).last.fill(str(value))
    wait_until(page, f"cagepose.state().drawnAnswers > {before} || problems.innerText !== ''")


def shown_angles(page: Page) -> list[float]:
    """Yaw, pitch and roll beside the picture, degrees."""
    text = page.locator("#pose dd").nth(1).inner_text()
    return [float(word) for word in text.removesuffix(" deg").split(", ")]


def state(page: Page) -> Any:
    return page.evaluate("cagepose.state()")


def wait_until(page: Page, condition: str) -> None:
    """Ask again and again from outside: the page itself must not evaluate text."""
    for _ in range(400):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(50)
    pytest.fail(f"never became true: {condition}")


def set_range(page: Page, name: str, value: float) -> None:
    page.evaluate(f"(v) => {{ {name}.value = v; {name}.dispatchEvent(new Event('input')); }}", value)


def pretend_graphics_card(page: Page) -> None:
    """What the page draws from now on, it draws as for a machine that has one."""
    page.add_init_script("""
        const told = WebGL2RenderingContext.prototype.getParameter;
        WebGL2RenderingContext.prototype.getParameter = function (name) {
            return name === 0x9246 ? "some graphics card" : told.call(this, name);
        };
    """)


def count_drawing(page: Page) -> None:
    """The page counts its draws from now on, a copy of a shape as one, and their triangles."""
    page.add_init_script("""
        window.goes = { drawn: 0, triangles: 0 };
        const count = (name, cornersAt, copiesAt) => {
            const draw = WebGL2RenderingContext.prototype[name];
            WebGL2RenderingContext.prototype[name] = function (...told) {
                const copies = copiesAt === null ? 1 : told[copiesAt];
                goes.drawn += copies;
                if (told[0] === this.TRIANGLES) goes.triangles += copies * told[cornersAt] / 3;
                return draw.apply(this, told);
            };
        };
        count("drawArrays", 2, null);
        count("drawElements", 1, null);
        count("drawArraysInstanced", 2, 3);
        count("drawElementsInstanced", 1, 4);
    """)


def drawn_for_a_picture(page: Page) -> dict[str, float]:
    """Draws and triangles of each of the pictures while the view is turned; `count_drawing` came first."""
    page.evaluate("() => { pull.checked = false; }")  # else this drags the object
    ask = "[{ ...goes }, cagepose.state().drawn]"
    before, drawn = page.evaluate(ask)
    page.locator("#scene").drag_to(page.locator("#scene"), target_position={"x": 300, "y": 300})
    wait_until(page, f"cagepose.state().drawn > {drawn}")
    after, drawn_then = page.evaluate(ask)
    return {key: (after[key] - before[key]) / (drawn_then - drawn) for key in after}
