"""Attacks on what is said of jams: linear programs with cones of many sides look for what there must not be."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from cagepose import Run, Scene, certificate, check_certificate, run
from cagepose.studies.drive_proof import DrivenPlace
from cagepose.studies.driven_contacts import DriveContacts, DrivenContacts
from driven.drawn_jams import KINDS, drawer, drawn
from driven.driven_scenes import wedge
from driven.insertions import Insertion
from driven.jam_oracles import TooManyModesError, least_friction, most_work, stands, way_on, wider

LESS_FRICTION = 1.0 - 1e-3
"""With 64 sides a pyramid inside of a cone is that much narrower, and a little more."""
PLACES = 8
"""Of a drive, drawn."""


def places_of(a_run: Run, phase: int, random: np.random.Generator) -> list[tuple[DrivenPlace, DrivenContacts]]:
    """Some places of a drive, with their certificate, which is right, and with all that touches there."""
    found = certificate(a_run, phase)
    assert found is not None
    assert found.drive is not None
    checked = check_certificate(found, a_run, phase).drive
    assert checked is not None
    drive = a_run.phases[phase].drive
    assert drive is not None
    assert bool(checked.could_jam) == bool(drive.jam_possible)
    if a_run.phases[phase].verdict in ("blocked", "jams"):
        assert checked.stopped == a_run.phases[phase].verdict
    places, known = found.drive.places, DriveContacts(a_run, phase)
    chosen = {len(places) - 1, *random.integers(len(places), size=PLACES).tolist()}
    return [(places[which], known.at_row(places[which].row)) for which in sorted(chosen)]


def driven_phases(scene: Scene) -> list[tuple[Run, int]]:
    a_run = run(scene)
    return [(a_run, number) for number, phase in enumerate(a_run.phases) if phase.drive is not None]


def test_no_forces_jam_where_none_can_and_some_could_where_some_do(cases, say) -> None:
    random, counts = np.random.default_rng(60), Counter[str]()
    for index in range(cases(16, 400)):
        for a_run, phase in driven_phases(drawn(random, KINDS[index % len(KINDS)])):
            counts[a_run.phases[phase].verdict] += 1
            for place, contacts in places_of(a_run, phase, random):
                friction = contacts.problem.friction
                if len(place.choices) > 1:
                    continue
                if place.choices[0].motion is not None:
                    counts["places where none can"] += 1
                    assert not stands(contacts, LESS_FRICTION * friction), most_work(contacts, LESS_FRICTION * friction)
                else:
                    counts["places where some could"] += 1
                    assert stands(contacts, wider(friction)), most_work(contacts, wider(friction))
    say(", ".join(f"{what}: {count}" for what, count in sorted(counts.items())))
    assert min(counts["places where none can"], counts["places where some could"]) > 10


def test_a_motion_that_is_long_enough_gives_way_to_nothing() -> None:
    """A peg with two points, where least squares end in a motion of 1e15 drifts with some coefficients: no proof."""
    peg = Insertion(5.0078093483104595, 0.06692768770222697, 0.009894046750572136, 0.3488972182075862)
    a_run = run(peg.scene(2.0, [32.722211289075794]))
    drive = a_run.phases[0].drive
    assert drive is not None
    known = DriveContacts(a_run, 0)
    two_points = next(at for at in map(known.at_row, known.rows()) if len(at.problem.faces) == 2)
    assert drive.critical_jam_friction == pytest.approx(least_friction(two_points, np.ones(2), 10.0), rel=1e-4)
    assert drive.jam_possible


def test_the_least_friction_that_jams_lies_between_that_of_pyramids_inside_and_outside(cases, say) -> None:
    """Of drives with few places, at all of them."""
    random, n_compared, widest = np.random.default_rng(61), 0, 0.0
    for index in range(cases(8, 200)):
        scene = wedge(friction=0.4, wall_friction=float(random.uniform(0, 3))) if index % 2 else drawer(random)
        for a_run, phase in driven_phases(scene):
            known, inside, outside = DriveContacts(a_run, phase), np.inf, np.inf
            drive = a_run.phases[phase].drive
            assert drive is not None
            rows = known.rows()
            for row in rows if len(rows) < 12 else ():
                contacts = known.at_row(row)
                greatest = float(contacts.problem.friction.max(initial=0.0))
                if greatest > 0.0:
                    shares = contacts.problem.friction / greatest
                    inside = min(inside, least_friction(contacts, shares, 10.0))
                    outside = min(outside, least_friction(contacts, wider(shares), 10.0))
            if inside < np.inf:
                assert drive.critical_jam_friction is not None
                assert outside * (1.0 - 3e-6) <= drive.critical_jam_friction <= inside * (1.0 + 3e-6)
                n_compared, widest = n_compared + 1, max(widest, inside / outside - 1.0)
    say(f"{n_compared} drives, pyramids inside and outside are at most {widest:.1e} apart")
    assert n_compared > 2


@pytest.mark.parametrize("drag", [1.0, 0.0], ids=["with drag", "without"])
def test_no_mode_goes_on_where_a_drive_jams(drag: float, cases, say) -> None:
    """Drawers against a force, and wedges. Where nothing resists, a motion needs no forces: there is no way on with
    drag alone.
    """
    random, n_jams, n_open = np.random.default_rng(62), 0, 0
    n = cases(10, 200)
    for index in range(n):
        heavy = wedge(friction=float(random.uniform(0.0, 1.2)), wall_friction=float(random.uniform(1.5, 3.0)))
        scene = heavy if index % 5 == 4 else drawer(random)
        (phase,) = (a_run := run(scene)).phases
        if phase.verdict != "jams" or (drag == 0.0 and scene.name == "drawer" and not scene.loads[0].pushes):
            continue
        known = DriveContacts(a_run, 0)
        try:
            found = way_on(known.at_row(known.rows()[-1]), drag)
        except TooManyModesError:
            n_open += 1
            continue
        assert found is None
        n_jams += 1
    say(f"{n_jams} of {n} jam, and no mode of theirs goes on; {n_open} have too many modes to ask them all")
    assert n_jams > 1
    assert n_open <= 1 + n_jams // 10


def test_a_mode_is_found_that_goes_on() -> None:
    """Of a drawer below its limit: the attack can find what it looks for."""
    (phase,) = (a_run := run(drawer(np.random.default_rng(4)))).phases
    assert phase.drive is not None
    assert phase.drive.share == 1.0
    for drag in (1.0, 0.0):
        assert way_on(DriveContacts(a_run, 0).at_row(0), drag) is not None
