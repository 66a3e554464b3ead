"""Warnings that do not depend on the method: seams, edges, weights, and what the proof says against a verdict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from cagepose.kernels.contact.tolerances import LENGTH_OF_NO_SPRING
from cagepose.model.planar import AXES, normal_axis
from cagepose.model.scene import Scene
from cagepose.runs.actions import spring_ends, tensions_at_zero, wrench_at
from cagepose.runs.load_scaling import WEIGHT_BESIDE_FORCE, scaled_load
from cagepose.runs.run import FAILURES, PhaseRun
from cagepose.runs.tolerances import ACROSS_PLANE


def seam_warnings(scene: Scene) -> Iterator[str]:
    for one, other in scene.open_seams:
        yield (
            f"boxes {one} and {other} meet flush with outlines that cross: a point that moves exactly in their common"
            " plane is not stopped by the seam; let them overlap a little"
        )


def edge_warnings(phase: PhaseRun) -> Iterator[str]:
    edges = sorted({contact.point for contact in phase.contacts if contact.near_edge})
    if edges:
        yield f"{phase.name}: {', '.join(edges)} within the touch tolerance of a face's edge"


def weight_warnings(scene: Scene, n_phases: int) -> Iterator[str]:
    for load in scene.loads[:n_phases]:
        if load.gravity_world is not None and load.pushes and not scaled_load(scene, load).in_newtons:
            yield (
                f"{load.name}: gravity and force act together, but mass or magnitude is not given: the force dominates"
                f" (weight = {WEIGHT_BESIDE_FORCE:g} of it)"
            )


def plane_warnings(scene: Scene, phases: Sequence[PhaseRun]) -> Iterator[str]:
    """Loads that push across the plane of a planar scene, which has no friction."""
    if scene.planar is None:
        return
    normal = normal_axis(scene.planar)
    for index, phase in enumerate(phases):
        force = wrench_at(scene, index, phase.pose).force
        size = float(np.linalg.norm(force))
        if size > 0.0 and abs(force[normal]) > ACROSS_PLANE * size:
            yield (
                f"{phase.name}: of its force of {size:.4g}, {force[normal]:.4g} acts along {AXES[normal]}, which the"
                f" plane {scene.planar} carries without friction"
            )


def lost_weight_warnings(scene: Scene, n_phases: int) -> Iterator[str]:
    """The first phase without the weight that a phase before it had."""
    loads = scene.loads[:n_phases]
    for before, load in pairwise(loads):
        if before.gravity_world is not None and load.gravity_world is None:
            yield (
                f"{load.name}: the weight of the phase before no longer acts (give gravity in this phase to keep it)"
            )
            return


def spring_warnings(scene: Scene, phase: PhaseRun) -> Iterator[str]:
    """Springs whose pull has no direction where a phase has ended."""
    start, cage = scene.object.pose_world_object, scene.cage.pose_world_cage
    springs = next(load.springs for load in scene.loads if load.name == phase.name)
    for number, spring in enumerate(springs, start=1):
        ends = spring_ends(scene, spring, cage.position_m[None], cage.quaternion_wxyz[None])
        length_m = float(np.linalg.norm(ends[0] - phase.pose.transform(spring.at_object_m)))
        if length_m <= LENGTH_OF_NO_SPRING * scene.size_m and tensions_at_zero(
            spring, ends, start.position_m[None], start.quaternion_wxyz[None]
        ):
            yield (
                f"{phase.name}: the ends of spring {number} have met, where its pull has no direction; fix it farther"
                " away, or stop the object before that"
            )


def unrun_warnings(scene: Scene, phases: Sequence[PhaseRun]) -> Iterator[str]:
    """Which phases a run that failed has left out."""
    left_out = [load.name for load in scene.loads[len(phases) :]]
    if phases[-1].verdict in FAILURES and left_out:
        yield f"{phases[-1].name}: the run failed here, so not run: {', '.join(left_out)}"


def proof_warnings(phases: Sequence[PhaseRun], friction: float) -> Iterator[str]:
    """What the mechanics says against a phase that ended held, or about how firmly it is held."""
    for phase in phases:
        proof = phase.proof
        if phase.verdict == "stable" and proof.verdict == "moves":
            yield (
                f"{phase.name}: the mechanics contradicts this verdict: with a friction coefficient of {friction:.4g}"
                " no contact forces balance the load at this pose"
            )
        elif phase.verdict in ("stable", "may rest") and proof.verdict == "may rest":
            yield f"{phase.name}: {proof.reason}"
        if phase.verdict in ("stable", "rests", "may rest") and proof.stability == "unstable":
            yield f"{phase.name}: the equilibrium is unstable: the slightest disturbance moves the object on"
        elif phase.verdict in ("stable", "rests", "may rest") and proof.stability == "not shown":
            yield (
                f"{phase.name}: it was not shown whether the equilibrium is stable: part of the load has no potential,"
                " or a contact lies where surfaces of different curvature meet"
            )
