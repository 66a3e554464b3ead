"""Are the contacts that a certificate names those of the scene? Between what, where, along what, with what friction."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Protocol

import numpy as np

from cagepose.errors import CertificateError
from cagepose.model.checks import FloatArray
from cagepose.model.wording import number_of
from cagepose.studies.contact_problem import ContactProblem
from cagepose.studies.tolerances import SAME_PLACE_OF_SIZE
from cagepose.studies.touched_faces import ContactFace

OTHER_PHASE = "is it the certificate of another phase, or another scene?"


class NamedContacts(Protocol):
    """What names contacts: a `Certificate`, or a place of a drive."""

    @property
    def contacts(self) -> tuple[ContactFace, ...]: ...
    @property
    def places_world(self) -> FloatArray: ...
    @property
    def directions_world(self) -> FloatArray: ...
    @property
    def friction(self) -> FloatArray: ...


def check_contacts(told: NamedContacts, problem: ContactProblem, size_m: float, where: str = "") -> list[int]:
    """Return where each contact that is told of is among those of a problem.

    Parameters
    ----------
    told, problem
        What is said, and what is so.
    size_m
        Of the scene.
    where
        Of what is said, for messages.

    Raises
    ------
    CertificateError
        They are not the same contacts, at the same places, with the same directions and friction.
    """
    found = _places(told, problem, where)
    _check_geometry(told, problem, found, size_m, where)
    return found


def known_contacts(contacts: tuple[int, ...], n: int, where: str) -> tuple[int, ...]:
    """Return numbers of contacts, which are below n.

    Raises
    ------
    CertificateError
        One of them is not.
    """
    for contact in contacts:
        if not 0 <= contact < n:
            raise CertificateError(f"{where} name contact {contact}, and there are {n}, counted from 0")
    return contacts


def check_choices(choices: Sequence[tuple[int, ...]], places: list[int], problem: ContactProblem, where: str) -> None:
    """Refuse choices, by the numbers of their contacts in the certificate, that are not all choices of one face of each
    group.

    Raises
    ------
    CertificateError
        One is wrong, or missing.
    """
    given = [
        frozenset(places[k] for k in known_contacts(choice, len(places), f"{where}choices[{number}].contacts"))
        for number, choice in enumerate(choices)
    ]
    wanted = {frozenset(choice) for choice in product(*problem.groups)}
    for choice in given:
        check_choice(choice, problem, where)
    missing = wanted - set(given)
    if missing:
        first = ", ".join(str(problem.faces[place]) for place in sorted(missing.pop()))
        raise CertificateError(f"{where}choices leave out the one with {first or 'no contact'}")


def check_choice(choice: frozenset[int], problem: ContactProblem, where: str) -> None:
    """Refuse a choice, by the places of its contacts, that does not take one face of each group.

    Raises
    ------
    CertificateError
        It does not.
    """
    if any(len(choice & set(group)) != 1 for group in problem.groups) or len(choice) != len(problem.groups):
        raise CertificateError(f"{where}choices hold one that takes not just one face of each point and box")


def _places(told: NamedContacts, problem: ContactProblem, where: str) -> list[int]:
    """Return where each contact of the certificate is among those of the problem."""
    places = {face: place for place, face in enumerate(problem.faces)}
    named = set(told.contacts)
    for face in told.contacts:
        if face not in places:
            raise CertificateError(f"{where}contacts name {face}, which does not touch at this pose; {OTHER_PHASE}")
    for face in problem.faces:
        if face not in named:
            raise CertificateError(f"{where}contacts leave out {face}, which touches at this pose; {OTHER_PHASE}")
    if len(told.contacts) != len(places):
        raise CertificateError(f"{where}contacts name one of them twice")
    found = [places[face] for face in told.contacts]
    if len(told.friction) != len(found):
        raise CertificateError(
            f"{where}friction has {number_of(len(told.friction), 'coefficient')} for {number_of(len(found), 'contact')}"
        )
    for face, one, own in zip(told.contacts, told.friction, problem.friction[found], strict=True):
        if one != own:
            raise CertificateError(f"{where}friction of {face} is {float(one)!r}, and the scene's is {float(own)!r}")
    return found


def _check_geometry(told: NamedContacts, problem: ContactProblem, found: list[int], size_m: float, where: str) -> None:
    """Contacts must be where the certificate says, with its normals and tangents, for whoever checks it by hand."""
    for one, own, unit, name, what in (
        (told.places_world, problem.places[found], size_m, "m", "places_world"),
        (told.directions_world, problem.directions[found], 1.0, "rad", "directions_world"),
    ):
        if one.shape != own.shape:
            raise CertificateError(
                f"{where}{what} has {number_of(len(one), 'entry', 'entries')} for {number_of(len(own), 'contact')}"
            )
        apart = np.abs(one - own).max(axis=tuple(range(1, own.ndim)), initial=0.0)
        for number in np.nonzero(~(apart <= SAME_PLACE_OF_SIZE * unit))[0][:1]:
            face = told.contacts[number]
            raise CertificateError(
                f"{where}{what} of {face} is {apart[number]:.1e} {name} off from the scene's at this pose, and at most"
                f" {SAME_PLACE_OF_SIZE * unit:.1e} counts as the same; {OTHER_PHASE}"
            )
