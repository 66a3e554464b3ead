"""Ask a page of the viewer what it shows, and move its sliders."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Page


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
