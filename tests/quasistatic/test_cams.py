"""A cam on a pin is turned against a wall: two pairs of contacts, each nearly one, share forces that nearly jam it."""

from __future__ import annotations

from audit.families import make_case
from cagepose import run


def test_a_cam_on_a_pin_comes_to_rest_at_a_wall(cases):
    """Sweeps over the contacts go round between one end of the pin and the other; what begins is found all the same."""
    verdicts = {index: run(make_case("cam", index).scene).verdict for index in range(cases(20, 200))}
    assert {index for index, verdict in verdicts.items() if verdict not in ("rests", "may rest")} == set()
