"""The questions about an insertion, or another drive, asked directly: `insertion`."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import expect, expect_choice, is_finite
from cagepose.model.load import Load
from cagepose.model.scene import Scene
from cagepose.model.wording import few
from cagepose.runs.cases import greatest_friction
from cagepose.runs.methods import chosen_method
from cagepose.runs.misaligned import Misaligned
from cagepose.runs.solve import run
from cagepose.studies.could_jam import jam_friction_along
from cagepose.studies.insertion_result import Insertion
from cagepose.studies.misalignment import FREEDOMS, permitted_misalignment

WITHIN = 0.01
"""To this fraction of itself it is found how far a drive may be out of place, if nothing else is asked for."""


def insertion(
    scene: Scene,
    phase: str | None = None,
    along: Sequence[str] | None = None,
    *,
    within: float = WITHIN,
    progress: Callable[[float], None] | None = None,
) -> Insertion:
    """Say how far a drive gets, with which force, where the object could jam, and how far all may be out of place.

    Out of place are the bodies that the phase drives, with their whole ways, as if the machine that moves them stood
    elsewhere; the object with them where it hangs on them by springs alone. Permitted is what lets the drive get to its
    end, the object rest there, and both come together nine tenths as far as where nothing is out of place.

    Each side is searched outwards at 8 places, each twice as far as the one before, up to a tenth of the scene's size
    or 10 deg. The first one that is not good ends it, and where exactly is found by halving.
    What is good again farther out, or bad between two places that are good, is not seen.

    Parameters
    ----------
    scene
        Drives bodies of the cage; run by the quasistatic method.
    phase
        Name of the phase whose drive is meant; None: the only one that has a drive.
    along
        Freedoms: "x", "y", "z", "roll", "pitch", "yaw", in the cage's frame; turns go through the object's origin at
        the start. None: shifts across the way and turns about the same axes. Empty: none is asked about.
    within
        To which fraction of itself each end is found, above zero.
    progress
        Called with the share of the search that is done.

    Raises
    ------
    SceneError
        No phase drives anything, or several do and none is named; no such phase or freedom; bodies press in it;
        ``within`` is not above zero; or the stepwise method.
    """
    expect(scene, Scene, "scene")
    number = _driven_phase(scene, phase)
    asked = _across(scene.loads[number]) if along is None else tuple(dict.fromkeys(along))
    for name in asked:
        expect_choice(name, FREEDOMS, "along")
    if not (is_finite(within) and within > 0.0):
        raise SceneError([Problem(("within",), f"is {within!r}; give a fraction above zero, such as {WITHIN:g}")])
    found, misaligned = run(scene), Misaligned(scene, number)
    is_begun = number < len(found.phases) and found.phases[number].drive is not None
    return Insertion(
        found,
        number,
        greatest_friction(scene, chosen_method(scene).friction(scene)),
        jam_friction_along(found, number) if is_begun else np.zeros(0),
        misaligned.bodies,
        misaligned.takes_object,
        permitted_misalignment(scene, number, asked, within, progress),
    )


def _driven_phase(scene: Scene, phase: str | None) -> int:
    driven = [load.name for load in scene.loads if load.drive]
    if not driven:
        message = "drive no body of the cage, so nothing is inserted; give a phase a drive"
        raise SceneError([Problem(("loads",), message)])
    if phase is None and len(driven) > 1:
        raise SceneError([Problem(("phase",), f"is needed, since several drive a body; give one of: {few(driven)}")])
    name = driven[0] if phase is None else phase
    expect_choice(name, driven, "phase")
    number = [load.name for load in scene.loads].index(name)
    if scene.loads[number].press:
        message = "is a phase in which bodies press, which insertion does not support; use cagepose run"
        raise SceneError([Problem(("phase",), message)])
    return number


def _across(load: Load) -> tuple[str, ...]:
    """Return the freedoms across the first leg of the first body: all but those of the axis nearest to it."""
    leg = next(iter(load.drive.values()))[0]
    way = leg.about_cage if leg.travel_m is None else leg.travel_m
    assert way is not None, "a leg has a travel or a turn"
    axis = int(np.abs(way).argmax())
    return tuple(name for place, name in enumerate(FREEDOMS) if place % 3 != axis)
