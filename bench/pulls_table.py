"""Pulls by hand in the live viewer, in a real browser: how soon the picture answers, and how deep the part ends."""

from __future__ import annotations

import math
import shutil
import statistics
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from audit.overlap import Bodies
from bench.rows import Row
from cagepose import Pose, Run, Scene, run
from cagepose.files.scene_file import read_scene_text
from cagepose.runs.drives import displaced_after

SCENES = Path(__file__).resolve().parents[1] / "scenes"
PULLED = (
    *("connector", "dock", "drawer", "grip", "insertion"),
    *("phone-dock", "plate-on-pins", "rail-pitch", "rollers", "v-groove"),
)
"""Points and shapes, holes, springs, what was driven and what presses."""
N_PULLS, N_MOVES = 30, 5
"""Of each scene; the pointer rests so often on the way of each."""
LONGEST = 200.0
"""Pixels that the pointer goes, twice the greatest force that acts besides."""
MOST_TRIES = 2_000
WAIT_MS, MOST_WAITS = 15, 2_000


def pull_rows() -> Iterator[Row]:
    """Pull at the part of each scene of `PULLED`, at places and in directions that are drawn."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    try:
        playwright = import_module("playwright.sync_api")
    except ImportError:
        program = None
    if program is None:
        yield Row("pulls", "all", "page", skipped="no browser, or no playwright to drive it")
        return
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox", "--enable-unsafe-swiftshader"])
        for name in PULLED:
            tab = browser.new_page(viewport={"width": 1440, "height": 900})
            yield _pulled(tab, name)
            tab.close()
        browser.close()


def _pulled(tab: Any, name: str) -> Row:
    draw, complaints = np.random.default_rng(PULLED.index(name)), list[str]()
    tab.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    tab.on("pageerror", lambda error: complaints.append(str(error)))
    scene_path = SCENES / f"{name}.yaml"
    found = run(read_scene_text(scene_path).scene_file().scene)
    times_ms, depths, ends, stale = list[float](), list[float](), Counter[str](), 0
    with _served(scene_path) as address:
        tab.goto(address)
        _wait(tab, "cagepose.state().drawn > 0")
        box = tab.locator("#scene").bounding_box()
        for _ in range(N_PULLS):
            x, y = _place_on_object(tab, box, draw)
            angle, length = draw.uniform(0.0, 2.0 * math.pi), draw.uniform(0.1, 1.0) * LONGEST
            tab.mouse.move(box["x"] + x, box["y"] + y)
            tab.mouse.down()
            for step in range(1, N_MOVES + 1):
                way = length * step / N_MOVES
                tab.mouse.move(box["x"] + x + way * math.cos(angle), box["y"] + y + way * math.sin(angle))
                stale += not _answered(tab, times_ms)
                depths.append(_depth(found, tab))
            ends[tab.locator("#verdict").inner_text()] += 1
            tab.mouse.up()
            stale += not _answered(tab, times_ms)
            depths.append(_depth(found, tab))
    details = {
        "answers": len(times_ms),
        "slowest_s": max(times_ms) / 1e3,
        "stale": stale,
        "errors": len(complaints),
        "depth_of_size": max(depths),
        "verdicts": ", ".join(f"{verdict} {count}" for verdict, count in sorted(ends.items())),
    }
    return Row("pulls", name, "page", statistics.median(times_ms) / 1e3, details=details)


def _place_on_object(tab: Any, box: Mapping[str, float], draw: np.random.Generator) -> list[float]:
    """Return a pixel at which the part is seen, clear of what lies over the picture."""
    for _ in range(MOST_TRIES):
        place = [draw.uniform(0.05, 0.95) * box["width"], draw.uniform(0.15, 0.8) * box["height"]]
        if tab.evaluate("([x, y]) => cagepose.isOnObject(x, y)", place):
            return place
    raise AssertionError("the part is nowhere on the picture")


def _answered(tab: Any, times_ms: list[float]) -> bool:
    """Wait for the answer and note how long it took; return whether the picture shows it, and it is the hand's."""
    _wait(tab, "!cagepose.state().isBusy && cagepose.state().drawnAnswers === cagepose.state().answers")
    state = tab.evaluate("cagepose.state()")
    hand = state["hand"]
    if hand is None:  # not yet pulled far enough to be no click
        return True
    times_ms.append(state["answerMs"])
    says_so = bool(tab.locator("#problems").inner_text())
    return says_so or hand["force"] == hand["shownForce"]


def _depth(found: Run, tab: Any) -> float:
    """Return how deep the part is in its cage where the hand has led it to, in sizes; below zero: a gap.

    The scene is made anew with all where it is then: it refuses what is inside by more than the touch tolerance.
    """
    hand = tab.evaluate("cagepose.state().hand") or {"phase": len(found.phases) - 1, "way": []}
    phase = found.phases[hand["phase"]]
    begun = [*phase.pose.position_m, *phase.pose.quaternion_wxyz, *[0.0] * len(found.scene.loads[hand["phase"]].press)]
    return depth_of_size(found, hand["phase"], hand["way"][-1] if hand["way"] else begun)


def depth_of_size(found: Run, phase: int, row: list[float]) -> float:
    """Return how deep the part is in its cage at a place to which a hand has led it from the end of a phase, in sizes,
    by signed distances that share no code with the kernels.

    Raises
    ------
    SceneError
        By the kernels it is deeper than the touch tolerance.
    """
    scene, displaced = found.scene, displaced_after(found, phase)
    changes: dict[str, Any] = {"object.pose": _pose(Pose(row[:3], row[3:7]))}
    gone = dict(zip(scene.loads[phase].press, row[7:], strict=True))
    for number, body in enumerate(scene.cage.bodies, start=1):
        moved = Pose(displaced[number, :3], displaced[number, 3:])
        if body.name in gone:
            moved = Pose(gone[body.name] * scene.loads[phase].press[body.name].along_cage) @ moved
        changes[f"cage.bodies.{body.name}.pose"] = _pose(moved @ body.pose_cage_body)
    there: Scene = scene.changed(changes)
    return max(overlap.depth_m for overlap in Bodies(there).overlaps([there.object.pose_world_object])) / scene.size_m


def _pose(pose: Pose) -> dict[str, list[float]]:
    return {"position": pose.position_m.tolist(), "quat_wxyz": pose.quaternion_wxyz.tolist()}


def _wait(tab: Any, condition: str) -> None:
    for _ in range(MOST_WAITS):
        if tab.evaluate(condition):
            return
        tab.wait_for_timeout(WAIT_MS)
    raise AssertionError(f"never became true: {condition}")


@contextmanager
def _served(scene_path: Path) -> Iterator[str]:
    """Yield the address of a viewer in a process of its own, as users have it."""
    command = [sys.executable, "-m", "cagepose", "view", str(scene_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer:
        assert viewer.stdout is not None
        yield next(line for line in viewer.stdout if ": open " in line).split(": open ")[1].split()[0]
        viewer.terminate()
