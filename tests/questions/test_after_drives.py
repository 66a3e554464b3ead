"""Questions about the cage as it stands in the scene are not answered where its bodies have been moved before."""

from __future__ import annotations

import itertools

import pytest

from cagepose import Box, Cage, CageBody, Drive, Force, Load, Object, Scene, run
from cagepose.questions.cage_rests import cage_rests
from cagepose.questions.escape import escape_energy
from cagepose.questions.jam import jam
from cagepose.questions.unanswered import Unanswered

SIDE, WEIGHT = 0.0052, (0.0, 0.0, -9.81)


def side(axis: int, sign: float) -> list[tuple[float, ...]]:
    """Nine points of one side of a cube."""
    places = []
    for a, b in itertools.product((-0.0045, 0.0, 0.0045), repeat=2):
        place = [a, b]
        place.insert(axis, sign * SIDE)
        places.append(tuple(place))
    return places


@pytest.fixture(scope="module")
def behind_a_door() -> Scene:
    """A cube within points all around; those of one side are a door, which is driven away first."""
    fixed = [
        point for axis in range(3) for sign in (-1.0, 1.0) if (axis, sign) != (0, 1.0) for point in side(axis, sign)
    ]
    cage = Cage(fixed, bodies=[CageBody("door", side(0, 1.0))])
    loads = [
        Load("open", gravity=WEIGHT, drive={"door": Drive((0.3, 0, 0))}),
        Load("rest", gravity=WEIGHT),
        Load("tilt", gravity=(9.0, 0.0, -9.81)),
    ]
    return Scene(Object([Box((0.01, 0.01, 0.01))], mass_kg=1.0), cage, loads)


def test_no_cage_is_proven_to_hold_whose_door_has_been_driven_away(behind_a_door: Scene) -> None:
    ended = run(behind_a_door)
    assert [phase.verdict for phase in ended.phases][-1] == "escapes"
    found = escape_energy(ended, "rest", n_motions=200)
    assert isinstance(found, Unanswered)
    assert found.unanswered.startswith("open has moved bodies of the cage before")


def test_rests_behind_a_door_are_not_those_of_the_open_one(behind_a_door: Scene) -> None:
    found = cage_rests(behind_a_door, "rest", n_starts=20)
    assert isinstance(found, Unanswered)
    assert found.unanswered.startswith("open has moved bodies of the cage before")


def test_forces_that_cancel_each_other_push_nothing(behind_a_door: Scene) -> None:
    pushes = [Force((1, 0, 0), (0, 0, 0), 1.0), Force((-1, 0, 0), (0, 0, 0), 1.0)]
    found = jam(run(behind_a_door.but_for(loads=[Load("both", gravity=WEIGHT, forces=pushes)])))
    assert isinstance(found, Unanswered)
    assert "cancel each other" in found.unanswered
