"""Certificates of drives with something changed: each proves nothing, and it must be found out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cagepose import Certificate, DrivenPlace, JamChoice

Change = Callable[[Certificate], Certificate]


def with_place(given: Certificate, change: Callable[[DrivenPlace], DrivenPlace], at: int = -1) -> Certificate:
    assert given.drive is not None
    places = list(given.drive.places)
    places[at] = change(places[at])
    return replace(given, drive=replace(given.drive, places=tuple(places)))


def with_jam(given: Certificate, change: Callable[[JamChoice], JamChoice], at: int = -1) -> Certificate:
    return with_place(given, lambda place: replace(place, choices=(change(place.choices[0]),)), at)


def changed_in(one: Any, changes: dict[str, Callable[[Any], Any]]) -> Any:
    """The same with some fields changed."""
    return replace(one, **{name: change(getattr(one, name)) for name, change in changes.items()})


def of_place(**changes: Callable[[Any], Any]) -> Change:
    return lambda given: with_place(given, lambda place: changed_in(place, changes))


def of_drive(**changes: Callable[[Any], Any]) -> Change:
    return lambda given: replace(given, drive=changed_in(given.drive, changes))


def of_jam(**changes: Callable[[Any], Any]) -> Change:
    return lambda given: with_jam(given, lambda choice: changed_in(choice, changes))


def of_stop(**changes: Callable[[Any], Any]) -> Change:
    return of_drive(choices=lambda choices: (changed_in(choices[0], changes),))


def without_a_contact(place: DrivenPlace) -> DrivenPlace:
    """All that is said of the first contact is left out."""
    kept, choice = slice(1, None), place.choices[0]
    choice = replace(
        choice,
        contacts=choice.contacts[:-1],
        forces=None if choice.forces is None else choice.forces[kept],
    )
    return replace(
        place, contacts=place.contacts[kept], places_world=place.places_world[kept],
        directions_world=place.directions_world[kept], friction=place.friction[kept], drifts=place.drifts[kept],
        choices=(choice,),
    )  # fmt: skip


def other_sign(forces: np.ndarray) -> np.ndarray:
    """Of the greatest force."""
    signs = np.ones(len(forces))
    signs[np.abs(forces).reshape(len(forces), -1).max(axis=1).argmax()] = -1.0
    return forces * (signs if forces.ndim == 1 else signs[:, None])


def half(forces: np.ndarray) -> np.ndarray:
    """The greatest force is half of what it was."""
    shares = np.ones(len(forces))
    shares[np.abs(forces).reshape(len(forces), -1).max(axis=1).argmax()] = 0.5
    return forces * (shares if forces.ndim == 1 else shares[:, None])


def of_tree(**changes: Callable[[Any], Any]) -> Change:
    return of_stop(tree=lambda tree: changed_in(tree, changes))


def stands_by_the_growth_alone(choice: JamChoice) -> JamChoice:
    return replace(choice, motion=None, forces=np.zeros((len(choice.contacts), 3)), taken=1.0)


def pressed_without_work(place: DrivenPlace) -> DrivenPlace:
    """Of a drawer: its two pins press against each other along the line between them, and the finger does not."""
    pins = [[face.point for face in place.contacts].index(name) for name in ("rear pin", "front pin")]
    across = place.places_world[pins[0]] - place.places_world[pins[1]]
    (choice,), forces = place.choices, np.zeros((len(place.contacts), 3))
    for pin, sign in zip(pins, (1.0, -1.0), strict=True):
        forces[choice.contacts.index(pin)] = place.directions_world[pin] @ (sign * across)
    return replace(place, choices=(replace(choice, forces=forces),))


FORGED: list[tuple[str, Change, str]] = [
    # cannot jam
    ("dock", of_jam(motion=lambda motion: 0.0 * motion), "does not give way to"),
    ("dock", of_jam(motion=lambda motion: -motion), "does not give way to"),
    ("dock", of_jam(motion=lambda motion: motion * np.nan), "not finite"),
    ("peg", of_jam(motion=lambda motion: -motion), "does not give way to"),
    ("peg", of_jam(motion=lambda motion: 0.0 * motion), "does not give way to the growth of the load"),
    ("dock", of_jam(motion=lambda _: None), "neither a motion nor forces"),
    # could jam
    ("drawer-jams", of_jam(forces=other_sign), "leave their friction cones"),
    ("drawer-jams", of_jam(forces=half), "do not cancel"),
    ("drawer-jams", of_jam(forces=lambda forces: 0.0 * forces), "leave their friction cones"),
    ("drawer-jams", of_jam(forces=lambda forces: forces * (1, 2, 2)), "leave their friction cones"),
    ("drawer-jams", of_jam(forces=lambda forces: forces[:-1]), "are not three numbers"),
    ("drawer-jams", lambda given: with_place(given, pressed_without_work), "their work on it is 0"),
    ("peg", lambda given: with_jam(given, stands_by_the_growth_alone), "do not cancel"),
    # what touches, and how it drifts
    ("dock", lambda given: with_place(given, without_a_contact), "contacts leave out"),
    ("drawer-jams", lambda given: with_place(given, without_a_contact), "contacts leave out"),
    ("dock", of_place(drifts=lambda drifts: 1.001 * drifts), "drifts are not"),
    ("drawer-jams", of_place(drifts=lambda drifts: -drifts), "drifts are not"),
    ("dock", of_place(drifts=lambda drifts: drifts[1:]), "drifts are not"),
    ("peg", of_place(growth=lambda growth: 0.0 * growth), "growth is not"),
    ("dock", of_place(friction=lambda friction: 0.1 + friction), "friction of"),
    ("drawer-jams", of_place(friction=lambda friction: 2.0 * friction), "friction of"),
    ("dock", of_place(places_world=lambda places_world: places_world + 1e-6), "places_world of"),
    ("dock", of_place(share=lambda share: 0.5 * share), "share is"),
    ("dock", of_place(choices=lambda _: ()), "choices leave out"),
    ("dock", of_drive(places=lambda places: places[1:]), "leave out row"),
    ("dock", of_drive(places=lambda places: places[::-1]), "order of the curve"),
    ("dock", of_place(row=lambda _: 10_000), "which is none of the drive"),
    # blocked
    ("jaws", of_stop(normal_forces=other_sign), "normal_forces pull"),
    ("jaws", of_stop(normal_forces=half), "normal_forces do not cancel"),
    ("jaws", of_stop(normal_forces=lambda forces: 0.0 * forces), "normal_forces do not cancel"),
    ("jaws", of_stop(normal_forces=lambda forces: forces[1:]), "no normal forces"),
    ("jaws", of_stop(free=lambda free: free[1:]), "has 3 freedoms, and 4"),
    ("jaws", of_stop(free=lambda _: np.eye(6)[:4]), "closes or opens a contact"),
    ("jaws", of_drive(stopped=lambda _: "jams"), "has no tree"),
    ("dock", of_drive(stopped=lambda _: "blocked"), "choices leave out"),
    ("jaws", of_drive(stopped=lambda _: "held"), "stopped is 'held'"),
    # jams
    ("drawer-jams", of_tree(twists=lambda twists: twists + 1e-3), "leaf"),
    ("drawer-jams", of_tree(pressures=lambda pressures: 1.01 * pressures), "leaf"),
    ("drawer-jams", of_tree(widths_rad=lambda widths: 0.99 * widths), "leave out .* rad of the slips"),
    ("drawer-jams", of_tree(twists=lambda twists: twists[:, :6]), "not one twist"),
    ("drawer-jams", of_stop(motion=lambda motion: 0.0 * motion), "give way to"),
    ("drawer-jams", of_drive(stopped=lambda _: "blocked"), "no normal forces"),
]  # fmt: skip
"""A certificate by its name, what is changed, and what is to be said of it."""
