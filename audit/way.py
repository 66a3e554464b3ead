"""Is the way possible? The potential falls, no point is inside the part, and none passes through a box."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from audit.case import Answer, FloatArray
from audit.geometry import (
    acting,
    deepest,
    farthest_move,
    half_sizes,
    load_of,
    load_size,
    points_in_boxes,
    potential,
)
from cagepose import Event, Pose, Run, Scene

RISE = 1e-9
"""In load times size. A pose of the way may lie so much higher than the one before."""
DEEP_ON_THE_WAY = 5e-5
"""Fraction of the size. Between the poses of a run a part moves on screws, whose points cut a bent way short."""
LEAST_SAMPLES, MOST_SAMPLES = 8, 200


def potential_falls(run: Run) -> Answer:
    """From pose to pose of all events and their paths, the load does no negative work; moments have no potential."""
    if any(load.moments for load in run.scene.loads):
        return None
    found = []
    for phase in run.phases:
        acts = acting(run.scene, load_of(run.scene, phase.name))
        poses = [phase.start_pose, *(pose for event in phase.events for pose in (*event.path, event.pose_world_object))]
        heights = [potential(acts, pose) / (load_size(acts) * run.scene.size_m) for pose in poses]
        # Far from the origin a height has fewer digits than a fall.
        rounding = 1e-14 * max(map(abs, heights))
        rise = max((after - before for before, after in pairwise(heights)), default=0.0)
        if rise > RISE + rounding:
            found.append(f"{phase.name}: the potential rises by {rise:.1e} load times size in one step")
    return found


def depth(run: Run) -> Answer:
    """No point lies inside the part at the end of an event, nor on a frame, beyond what the touch tolerance allows."""
    scene, found = run.scene, []
    allowed = 1.001 * scene.tolerances.touch
    for phase in run.phases:
        for event in phase.events:
            inside = deepest(scene, event.pose_world_object)
            if inside > allowed:
                found.append(f"{phase.name}: a point lies {inside:.1e} sizes inside at the end of an event")
                break
    for frame in run.frames():
        inside = deepest(scene, frame.pose_world_object)
        if inside > DEEP_ON_THE_WAY:
            found.append(f"{run.phases[frame.phase_index].name}: a point lies {inside:.1e} sizes inside on a frame")
            break
    return found


def passes(run: Run) -> Answer:
    """Sampled more finely than the part is thick, the way takes no point through it."""
    found, asked = [], False
    for phase in run.phases:
        start = phase.start_pose
        for event in phase.events:
            if event.motion is not None and math.isfinite(event.motion.distance_m):
                asked = True
                inside = _deepest(run, start, event)
                if inside > DEEP_ON_THE_WAY:
                    found.append(f"{phase.name}: an event takes a point {inside:.1e} sizes through the part")
                    break
            start = event.pose_world_object
    return found if asked else None


def escape(run: Run) -> Answer:
    """A part that escapes under its weight alone falls past all points: no line of theirs, upwards, meets a box."""
    last = run.phases[-1]
    load = load_of(run.scene, last.name)
    if last.verdict != "escapes" or load.force is not None or load.gravity_world is None:
        return None
    down = load.gravity_world / np.linalg.norm(load.gravity_world)
    inside = _met_on_the_line(run.scene, last.pose, down)
    return [f"{last.name}: escapes, but {inside} is in its way"] if inside else []


def _deepest(run: Run, start: Pose, event: Event) -> float:
    """How deep a point gets on the way of one event, in sizes."""
    scene, stations = run.scene, [start, *(event.path or (event.pose_world_object,))]
    way = sum(farthest_move(scene, one, other) for one, other in pairwise(stations)) * scene.size_m
    thin = float(half_sizes(scene).min())
    n_samples = int(np.clip(math.ceil(2.0 * way / thin), LEAST_SAMPLES, MOST_SAMPLES))
    poses = [run.pose_on_the_way(start, event, k / n_samples) for k in range(1, n_samples)]
    return max(deepest(scene, pose) for pose in poses)


def _met_on_the_line(scene: Scene, pose: Pose, down: FloatArray) -> str | None:
    """Return the point that a travel along ``down`` takes into a box, shrunken by what counts as inside; or None."""
    allowed = DEEP_ON_THE_WAY * scene.size_m
    places = points_in_boxes(scene, pose)
    for box, half, starts in zip(scene.object.boxes, half_sizes(scene), places, strict=True):
        inner = half - min(allowed, float(half.min()) / 2)
        velocity = -(pose.rotation @ box.pose_object_box.rotation).T @ down
        with np.errstate(divide="ignore", invalid="ignore"):
            crossings = (np.array([-inner, inner])[:, None, :] - starts) / velocity
        enters, leaves = np.nanmin(crossings, axis=0), np.nanmax(crossings, axis=0)
        parallel = np.abs(velocity) < 1e-12
        enters = np.where(parallel, np.where(np.abs(starts) < inner, -np.inf, np.inf), enters)
        leaves = np.where(parallel, np.inf, leaves)
        first, last = enters.max(axis=1), leaves.min(axis=1)
        hit = np.flatnonzero((first < last) & (last > 0.0))
        if len(hit):
            return scene.cage.names[int(hit[0])]
    return None
