"""How many random cases tests draw."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cagepose.kernels.native.library import kernel_library

FULL = 20_000
"""Random scenes of the largest sweep at full size; all others are as large in proportion."""
IS_PLAIN_PYTHON = kernel_library() is None


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--scenes",
        type=int,
        metavar="N",
        help=f"run only the tests that draw random cases, the largest of them with N of {FULL:,} scenes",
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("scenes") is None:
        return
    drawing = [item for item in items if "cases" in getattr(item, "fixturenames", ())]
    config.hook.pytest_deselected(items=[item for item in items if item not in set(drawing)])
    items[:] = drawing


@pytest.fixture(scope="session")
def cases(request: pytest.FixtureRequest) -> Callable[[int, int], int]:
    """Says how many cases to draw: few, or in ``make test-deep`` the share of many that is asked for.

    With kernels as plain Python there are fewer: they are about a hundred times slower.
    """
    n_scenes: int | None = request.config.getoption("scenes")

    def number(few: int, many: int) -> int:
        if n_scenes is not None:
            return max(few, many * n_scenes // FULL)
        return max(min(few, 10), few // 5) if IS_PLAIN_PYTHON else few

    return number
