"""Contacts as stiff springs under Coulomb's law: how far a part moves until they balance its load.

Each contact keeps its plane, and sticks by a spring of its own until that pulls more than the friction (Cundall and
Strack, 1979). No step in time and no slip that is smoothed: nothing creeps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.runs.actions import load_size, wrench_at
from cagepose.runs.run import Run

GIVES, STAYS = 1e-6, 1e-4
"""Fractions of the scene's size: what a spring gives under all of the load, and what moves less is held."""
BALANCED = 1e-6
"""Fraction of the load."""
RAMP, STEPS, MORE = 12_000, 200_000, 10
"""Steps of the load's growth, and of all; so many times more where the part has stayed and forces still change."""


class Sprung(NamedTuple):
    moved: float
    """How far a contact is from where the run ended, of the scene's size."""
    left: float
    """Force, or moment over the size, that is not balanced, of the load."""

    @property
    def holds(self) -> bool:
        """Whether the part stays where it is."""
        return self.moved < STAYS and self.left < BALANCED


def on_springs(done: Run, phase_index: int, friction: float) -> Sprung:
    """Let go where a phase ended, and let its load grow."""
    scene, phase = done.scene, done.phases[phase_index]
    load_n, wrench = load_size(scene, phase_index, phase.pose), wrench_at(scene, phase_index, phase.pose)
    center = phase.pose.transform(scene.object.center_of_gravity_m)
    places = np.array([contact.place_world for contact in phase.contacts]) - center
    normals = -np.array([contact.normal_world for contact in phase.contacts])
    stiffness = load_n / (GIVES * scene.size_m)
    relaxed, lever = 2.0 * len(places) * stiffness, np.linalg.norm(places, axis=1).max()
    jacobian = np.zeros((len(places), 3, 6))  # of small motions: travel, turn
    jacobian[:, :, :3] = np.eye(3)
    jacobian[:, :, 3:] = -np.cross(places[:, None, :], np.eye(3)[None], axisc=1)
    relaxation = np.repeat([1.0 / relaxed, 1.0 / (relaxed * lever**2)], 3)
    load = np.concatenate([wrench.force, wrench.moment])
    twist, before, held = np.zeros(6), np.zeros_like(places), np.zeros_like(places)
    for step in range(MORE * STEPS):
        share = min(1.0, (step + 1) / RAMP)
        way = jacobian @ twist
        pressed = np.maximum(0.0, -stiffness * (way * normals).sum(axis=1))
        held = held - stiffness * (way - before)
        held -= (held * normals).sum(axis=1)[:, None] * normals
        pull, most = np.sqrt((held * held).sum(axis=1)), friction * pressed
        slips = pull > most
        held[slips] *= (most[slips] / pull[slips])[:, None]
        before = way
        left = share * load + np.einsum("ni,nij->j", pressed[:, None] * normals + held, jacobian)
        twist = twist + relaxation * left
        if step > RAMP and step % 1000 == 0:
            ended = Sprung(
                float(np.linalg.norm(jacobian @ twist, axis=1).max() / scene.size_m),
                float(max(np.linalg.norm(left[:3]), np.linalg.norm(left[3:]) / scene.size_m) / load_n),
            )
            is_late = step >= STEPS and ended.moved >= STAYS
            if ended.holds or ended.moved > 10.0 * STAYS or is_late:
                break
    return ended
