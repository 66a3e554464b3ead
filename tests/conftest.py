"""How many random cases tests draw, and what they say of them."""

from __future__ import annotations

import importlib
from collections.abc import Callable

import pytest

from cagepose import Problem, SceneError
from cagepose.files.own_process import ask
from cagepose.kernels.native.library import kernel_library

FULL = 20_000
"""Random scenes of the largest sweep at full size; all others are as large in proportion."""
IS_PLAIN_PYTHON = kernel_library() is None


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--scenes",
        type=int,
        metavar="N",
        help=f"draw many random cases: N of {FULL:,} scenes in the largest test, as many in proportion in others",
    )
    parser.addoption("--only-random", action="store_true", help="run only the tests that draw random cases")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if not config.getoption("only_random"):
        return
    drawing = [item for item in items if "cases" in getattr(item, "fixturenames", ())]
    config.hook.pytest_deselected(items=[item for item in items if item not in set(drawing)])
    items[:] = drawing


@pytest.fixture
def say(record_property: Callable[[str, object], None]) -> Callable[[str], None]:
    """Say what people want to see of a test: below all tests, whichever process it ran in."""
    return lambda text: record_property("said", text)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = [report for reports in terminalreporter.stats.values() for report in reports]
    said = {
        (report.nodeid, text)
        for report in reports
        for name, text in getattr(report, "user_properties", ())
        if name == "said"
    }
    if said:
        terminalreporter.section("random cases")
        terminalreporter.write_line("\n".join(text for _, text in sorted(said)))


@pytest.fixture(scope="session")
def cases(request: pytest.FixtureRequest) -> Callable[[int, int], int]:
    """Says how many cases to draw: few, or the share of many that is asked for.

    With kernels as plain Python there are fewer: they are about a hundred times slower.
    """
    n_scenes: int | None = request.config.getoption("scenes")

    def number(few: int, many: int) -> int:
        if n_scenes is not None:
            return max(few, many * n_scenes // FULL)
        return max(min(few, 10), few // 5) if IS_PLAIN_PYTHON else few

    return number


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """trimesh and Open CASCADE answer in this process, which spares their starts: half a second and two each time."""

    def ask_here(module: str, given: bytes, *_: object) -> bytes:
        try:
            return importlib.import_module(module)._answer(given)
        except (ValueError, RuntimeError) as error:
            raise SceneError([Problem((), " ".join(str(error).split()))]) from None

    for name in ("exchange.step_writer", "files.step.solids", "files.meshes.run_trimesh"):
        module = importlib.import_module(f"cagepose.{name}")
        assert module.ask is ask
        monkeypatch.setattr(module, "ask", ask_here)
