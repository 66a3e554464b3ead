"""An L bracket laid on the edge of a block without play: in its hollow corner either leg holds by itself."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, run

TOP = Box((0.04, 0.03, 0.004), Pose((-0.02, 0.0, 0.002)), "top")
SIDE = Box((0.004, 0.03, 0.04), Pose((0.002, 0.0, -0.016)), "side")
BLOCK = Box((0.08, 0.08, 0.08), Pose((-0.04, 0.0, -0.04)), "block")
AROUND = [Pose(), Pose(euler_zyx=(np.pi / 2, 0.0, 0.0)), Pose((0.01, 0.02, 0.03), euler_zyx=(0.3, 0.2, 0.1))]


def bracket(loads: list[Load], turned: Pose, friction: float) -> Scene:
    """The bracket, whose legs end within the block's edge, so that edges of it cross that edge."""
    block = Box(BLOCK.size_m, turned @ BLOCK.pose_object_box, "block")
    held = Object([TOP, SIDE], pose=turned, mass_kg=1.0)
    return Scene(held, Cage(shapes=[block]), loads, friction_coefficient=friction)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("turned", AROUND)
def test_a_bracket_stays_on_its_edge(turned, friction):
    down, back = turned.rotation @ (0.0, 0.0, -10.0), turned.rotation @ (-1.0, 0.0, 0.0)
    push = Force(back, (0.0, 0.0, 0.002), 3.0)
    found = run(bracket([Load("push", gravity=down, force=push)], turned, friction))
    assert found.verdict == "rests"
    np.testing.assert_allclose(found.pose.position_m, turned.position_m, atol=1e-15)
    if friction == 0.0:
        carried = sum(contact.force_normal_n * contact.normal_world for contact in found.contacts)
        np.testing.assert_allclose(carried, down + 3.0 * back, atol=1e-9)


@pytest.mark.parametrize("turned", AROUND)
def test_a_bracket_that_is_pulled_off_its_edge_slides(turned):
    down, out = turned.rotation @ (0.0, 0.0, -10.0), turned.rotation @ (1.0, 0.0, 0.0)
    found = run(bracket([Load("pull", gravity=down, force=Force(out, (0.0, 0.0, 0.002), 1e-3))], turned, 0.0))
    assert found.verdict == "escapes"
    first = found.phases[0].events[0]
    assert first.rule == "slide"
