"""Arcs along which parts touch at the end of a phase, as of a rim that lies flat or a ball in a round hole, of which a
run lists some places: `places_on_arcs`.
"""

from __future__ import annotations

import math

import numpy as np

from cagepose.kernels.contact.on_circle import place_on_circle
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judged_workspace
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Contact, Run

PLACES_AROUND = 128
"""A whole circle has about so many places. A polygon of so many corners is 0.03 % within it."""


def places_on_arcs(run: Run, phase: int) -> list[Contact]:
    """Return contacts all along the arcs at the end of a phase, as far as both parts touch there."""
    scene, ended = run.scene, run.phases[phase]
    if not scene.has_other_shapes:
        return []
    friction = chosen_method(scene, run.method).friction(scene)
    at, _ = judged_workspace(scene, ended.pose, phase, friction, displaced_after(run, phase))
    contacts, center = at.contacts, ended.pose.transform(scene.object.center_of_gravity_m)
    found = list[Contact]()
    for row in range(int(contacts.used[0])):
        around = contacts.bends[row].on_circle
        if around.length == 0.0:
            continue
        names = (
            scene.cage.element_names[contacts.rows[row].cage_part],
            scene.object.element_names[contacts.rows[row].part],
        )
        before, after = 0.5 * around.before, 0.5 * around.after  # from there on it is nearer to the next one listed
        n_places = 1 + math.ceil((before + after) * PLACES_AROUND / (2.0 * math.pi))
        for angle in np.linspace(-before, after, n_places).tolist():
            arm, normal = place_on_circle(contacts, row, angle)
            found.append(Contact(*names, np.array(normal), 0.0, near_edge=False, place_world=center + arm))
    return found
