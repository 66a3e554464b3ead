"""When an engine that moves through time counts as settled, shown on a body that follows a list of heights."""

from __future__ import annotations

import numpy as np
import pytest

from bench import settle
from bench.peer_body import SPHERE_RADIUS_MM, PeerLoad, peer_body
from bench.rail_case import rail_scenes

PLAY_MM = 1.0
QUIET_MM, LOUD_MM = 0.9e-4, 1.1e-4
CORNERS = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
DOWN = PeerLoad(np.array([0.0, 0.0, -1.0]), np.zeros(3))


class Scripted:
    """Moves by the next of the given steps in each window, millimetres; after the last it stands still."""

    def __init__(self, steps_mm, turns_rad=()):
        self.steps_mm, self.turns_rad = list(steps_mm), list(turns_rad)
        self.height_mm, self.angle_rad = 0.0, 0.0
        self.torques = []

    def restart(self):
        pass

    def push(self, _phase, torque, _force):
        self.torques.append(torque)

    def advance(self):
        self.height_mm += self.steps_mm.pop(0) if self.steps_mm else 0.0
        self.angle_rad += self.turns_rad.pop(0) if self.turns_rad else 0.0

    def pose(self):
        c, s = np.cos(self.angle_rad), np.sin(self.angle_rad)
        return np.array([0.0, 0.0, self.height_mm]), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def windows(stepper, load=DOWN):
    return settle.settle(stepper, 0, load, CORNERS, PLAY_MM)


def test_four_quiet_windows_in_a_row_settle():
    assert windows(Scripted([1.0, 1.0])) == 2 + 4


def test_a_loud_window_starts_the_count_anew():
    assert windows(Scripted([QUIET_MM] * 3 + [LOUD_MM])) == 3 + 1 + 4


def test_a_motion_just_below_the_limit_is_quiet():
    assert windows(Scripted([QUIET_MM] * 10)) == 4


def test_a_turn_counts_by_what_the_farthest_corner_moves():
    """1.1e-6 rad at 100 mm is loud though the centre stands still."""
    assert windows(Scripted([], [LOUD_MM / 100.0] * 5)) == 5 + 4


def test_what_never_stops_or_is_no_number_is_no_rest(monkeypatch):
    monkeypatch.setattr(settle, "WINDOW_LIMIT", 20)
    with pytest.raises(settle.NotSettledError, match="still moves after 20 windows"):
        windows(Scripted([1.0] * 30))
    with pytest.raises(settle.NotSettledError, match="no longer a number"):
        windows(Scripted([np.nan]))


def test_a_dead_load_turns_with_the_object_and_keeps_its_direction():
    load = PeerLoad(np.array([0.0, 1.0, 0.0]), np.array([2.0, 0.0, 0.0]))
    stepper = Scripted([], [np.pi / 3.0])
    windows(stepper, load)
    assert stepper.torques[0] == pytest.approx([0.0, 0.0, 2.0])
    assert stepper.torques[1] == pytest.approx([0.0, 0.0, 1.0])


def test_spheres_touch_where_points_do():
    """Each face in use is moved inwards by the radius, so every gap of a point is that of its sphere."""
    scene = rail_scenes()[0]
    points, spheres = peer_body(scene, 0.0), peer_body(scene)
    assert points.faces_in_use == spheres.faces_in_use
    assert len(points.faces_in_use) > len(scene.cage.names)
    for _, box, axis, sign in points.faces_in_use:
        faces = [body.centers_mm[box, axis] + sign * body.half_sizes_mm[box, axis] for body in (points, spheres)]
        assert sign * (faces[0] - faces[1]) == pytest.approx(SPHERE_RADIUS_MM)
