"""Play with freedoms held: closed forms, the plane, and what cannot be held."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, SceneError, play, run
from cagepose.cli.app import main
from planar.floor_and_lid import drawn_pair

MM = 1e-3
SLOT, BOARD, DEPTH = 1.95, 1.6, 12.0
WEIGHT = Load("weight", gravity=(0.0, 0.0, -9.81))


def plugged_board(loads: tuple[Load, ...] = (WEIGHT,)) -> Scene:
    """Return a board that is plugged into a slot, from which it can slide; the origin is above the mouth."""
    sides = (DEPTH * MM, 20 * MM, 5 * MM), (DEPTH * MM, 5 * MM, 12 * MM)
    high, wide = (0.5 * SLOT + 2.5) * MM, 8.6 * MM
    boxes = [
        Box(sides[0], Pose((-0.5 * DEPTH * MM, 0.0, -high)), "below"),
        Box(sides[0], Pose((-0.5 * DEPTH * MM, 0.0, high)), "above"),
        Box(sides[1], Pose((-0.5 * DEPTH * MM, wide, 0.0)), "left"),
        Box(sides[1], Pose((-0.5 * DEPTH * MM, -wide, 0.0)), "right"),
        Box((5 * MM, 20 * MM, 12 * MM), Pose((-14.55 * MM, 0.0, 0.0)), "back"),
    ]
    board = Object([Box((40 * MM, 12 * MM, BOARD * MM), Pose((8 * MM, 0.0, 0.0)))], mass_kg=0.006)
    return Scene(board, Cage([], shapes=boxes), loads)


def pitch_of_board() -> float:
    """Its lower face on the slot's lower edge, its upper edge on the slot's upper face:
    d sin t = s - b (cos t + 1 / cos t) / 2.
    """
    turn = 0.0
    for _ in range(30):
        turn = math.asin((SLOT - 0.5 * BOARD * (math.cos(turn) + 1.0 / math.cos(turn))) / DEPTH)
    return turn


def test_a_board_that_stays_plugged_in_turns_by_what_its_slot_leaves():
    free = play(plugged_board(), search_s=0.0)
    assert free.freedoms["x"].high.is_open
    found = play(plugged_board(), hold=("x", "roll", "yaw"), search_s=0.0)
    assert (found.held, tuple(found.freedoms)) == (("x", "roll", "yaw"), ("y", "z", "pitch"))
    assert found.verdict == "caged"
    touching = 1e-9 * 0.05 / (DEPTH * MM)  # what counts as a touch, over the lever
    assert found.freedoms["pitch"].high.exact == pytest.approx(pitch_of_board(), abs=touching)
    assert found.freedoms["y"].low.exact == pytest.approx(-0.1 * MM, rel=1e-9)
    alone = play(plugged_board(), hold=("x", "y", "roll", "pitch", "yaw"), search_s=0.0).freedoms["z"]
    assert (alone.low.exact, alone.high.exact) == pytest.approx((-0.175 * MM, 0.175 * MM), rel=1e-9)


def test_a_run_that_presses_it_ends_there():
    """With all six freedoms it slides a little in its slot, and so comes 0.003 degrees farther."""
    press = Load("press", force=Force((0.0, 0.0, -1.0), (20 * MM, 0.0, 0.8 * MM), magnitude_n=2.0))
    pressed = run(plugged_board((press,)).changed(friction_coefficient=0.2))
    assert pressed.pose.euler_zyx[1] == pytest.approx(pitch_of_board(), rel=3e-3)


def test_to_hold_what_a_plane_holds_is_that_plane():
    guides = Cage(
        [(x, 0.0, z) for x in (-0.02, 0.02) for z in (-0.0055, 0.0055)] + [(-0.051, 0.0, 0.0), (0.052, 0.0, 0.0)]
    )
    pin = Object([Box((0.1, 0.01, 0.01))], pose=Pose((0.0, 0.0, 0.0002)))
    scenes = Scene(pin, guides, [WEIGHT]), Scene(pin, guides, [WEIGHT], planar="xz")
    one, other = play(scenes[0], hold=("y", "roll", "yaw"), search_s=0.0), play(scenes[1], search_s=0.0)
    assert (one.verdict, one.held) == (other.verdict, other.held)
    for name, ends in one.freedoms.items():
        for here, there in ((ends.low, other.freedoms[name].low), (ends.high, other.freedoms[name].high)):
            assert here.exact == pytest.approx(there.exact, rel=1e-12)
            assert here.certified == pytest.approx(there.certified, rel=1e-12)
            assert [clearance.closing for clearance in here.clearances] == pytest.approx(
                [clearance.closing for clearance in there.clearances], rel=1e-9
            )


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (lambda: play(plugged_board(), hold=("y", "roll")), "hold: leaves two turns of three"),
        (lambda: play(plugged_board(), hold=("w",)), "hold: has w; the freedoms are x, y, z, roll, pitch, yaw"),
        (lambda: play(plugged_board(), hold=("x",), seated="weight"), "hold: is asked of an object without a load"),
        (
            lambda: play(drawn_pair(1, 0.0).between_walls.changed("cage.pose.euler_zyx_deg", [0, 5, 0]), hold=("x",)),
            "hold: is asked in a cage that is turned",
        ),
    ],
    ids=["one turn", "unknown", "seated", "turned cage"],
)
def test_what_cannot_be_held_is_refused(asked: Callable[[], object], says: str):
    with pytest.raises(SceneError) as raised:
        asked()
    assert says in str(raised.value)


def test_the_command_says_what_is_held(tmp_path, capsys):
    from cagepose import save_scene

    save_scene(plugged_board(), tmp_path / "board.yaml")
    assert main(["play", str(tmp_path / "board.yaml"), "--hold", "x, roll,yaw", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["held"], list(document["freedoms"])) == (["x", "roll", "yaw"], ["y", "z", "pitch"])
    assert main(["play", str(tmp_path / "board.yaml"), "--hold", "roll"]) == 2
    assert "--hold: leaves two turns of three" in capsys.readouterr().err
