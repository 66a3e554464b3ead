from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from cagepose import Scene, load_scene


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium without a window, drawing WebGL in software."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        message = "no browser to test with; on Debian: apt install chromium"
        pytest.fail(message) if os.environ.get("CI") else pytest.skip(message)
    flags = ["--no-sandbox", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=program, args=flags)
        yield chromium
        chromium.close()


class Watched:
    """A page, and what it complained of and asked for."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.expected: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda message: self.complaints.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def expect(self, words: str) -> None:
        """Take what the browser itself says in these words for no complaint, whenever it says it."""
        self.expected.append(words)

    def unexpected(self) -> list[str]:
        return [text for text in self.complaints if not any(words in text for words in self.expected)]


@pytest.fixture
def watched(browser: Browser) -> Iterator[Watched]:
    """A new page of the browser; complaints of the page fail the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 800}, accept_downloads=True)
    watched = Watched(context.new_page())
    yield watched
    context.close()
    assert watched.unexpected() == []


@pytest.fixture(scope="session")
def crowded_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Fifty boxes in a row, held from below and from the sides by two hundred points."""
    boxes = [
        {"size": [9.0, round(30.0 + 0.4 * i, 1), 20.0], "position": [10.0 * i - 245.0, 0.0, 0.0]} for i in range(50)
    ]
    below = [[5.0 * i - 247.5, 10.0 * (-1) ** i, -10.5] for i in range(100)]
    beside = [[5.0 * i - 247.5, 30.0 * (-1) ** i, 0.0] for i in range(100)]
    scene = {
        "name": "crowded",
        "object": {"boxes": boxes},
        "cage": {"points": below + beside},
        "loads": [{"name": "weight", "gravity": [0.0, 0.2, -1.0]}],
    }
    file = tmp_path_factory.mktemp("crowded") / "crowded.yaml"
    file.write_text(json.dumps(scene), encoding="utf-8")
    return file


@pytest.fixture(scope="session")
def crowded(crowded_file: Path) -> Scene:
    """The scene of `crowded_file`."""
    return load_scene(crowded_file)
