"""What ends a step is searched where contacts are on their faces: drawn mechanisms come to an end, exactly there."""

from __future__ import annotations

import pytest

from audit.families import make_case
from cagepose import run


@pytest.mark.parametrize(("family", "first"), [("v-rollers", 315), ("tapered-pin", 320), ("square-hole", 0)])
def test_drawn_mechanisms_come_to_an_end(family, first, cases):
    """Where events were searched on the screw, 4, 4 and 1 of so many stalled or took all steps."""
    n_cases = cases({"v-rollers": 40, "tapered-pin": 90, "square-hole": 30}[family], 200)
    verdicts = {index: run(make_case(family, index).scene).verdict for index in range(first, first + n_cases)}
    assert {index: verdict for index, verdict in verdicts.items() if verdict in ("stalled", "limit")} == {}


@pytest.mark.parametrize("index", [193, 336, 337])
def test_a_cam_reaches_its_pin_with_both_ends_at_once(index):
    """Both ends of the pin are reached by one turn: no rounding lets one of them carry all of the load."""
    ended = run(make_case("cam", index).scene)
    assert ended.verdict in ("rests", "may rest")
    gaps = [contact.gap_m for contact in ended.contacts if contact.point.startswith("pin")]
    assert len(gaps) == 2
    assert max(abs(gap) for gap in gaps) < 1e-16


def test_a_shaft_that_friction_stops_in_its_bush_ends_in_the_balance():
    """It went to and fro about it, at the limit of friction, up to the limit of steps."""
    ended = run(make_case("ordinary", 814).scene)
    assert ended.verdict == "may rest"
    assert ended.phases[-1].proof.residual < 1e-9
