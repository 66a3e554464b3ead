"""What verdicts look like on a terminal."""

from __future__ import annotations

import pytest

from cagepose.cli.styles import verdict_style


@pytest.mark.parametrize(
    ("verdict", "style"),
    [("rests", "bold green"), ("may rest", "bold yellow"), ("escapes", "bold yellow"), ("stalled", "bold red")],
)
def test_what_only_may_rest_is_not_as_green_as_what_rests(verdict: str, style: str) -> None:
    assert verdict_style(verdict) == style
