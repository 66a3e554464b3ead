"""What the contacts of a phase leave of its load, summed up by hand."""

from __future__ import annotations

import numpy as np

from cagepose import PhaseRun, Scene
from cagepose.runs.load_scaling import scaled_load


def imbalance(scene: Scene, phase: PhaseRun) -> float:
    """Net force, and net moment about the centre of gravity by the scene's size, as a fraction of the load."""
    load = next(load for load in scene.loads if load.name == phase.name)
    weighed = scaled_load(scene, load)
    center = phase.pose.transform(scene.object.center_of_gravity_m)
    acts = [(weighed.gravity, center)]
    rotation, couples = phase.pose.rotation, np.zeros(3)
    for push, force in zip(load.pushes, weighed.forces, strict=True):
        acts.append((rotation @ force if push.follows else force, phase.pose.transform(push.at_object_m)))
    for turning in load.moments:
        couples += turning.magnitude_nm * (rotation @ turning.direction if turning.follows else turning.direction)
    for spring in load.springs:
        here = phase.pose.transform(spring.at_object_m)
        way, start = spring.to_world_m - here, scene.object.pose_world_object.transform(spring.at_object_m)
        longer = np.linalg.norm(way) - np.linalg.norm(spring.to_world_m - start)
        pull = (spring.preload_n + spring.stiffness_n_per_m * longer) / np.linalg.norm(way)
        acts.append((pull * way, here))
    size_of_load = sum(np.linalg.norm(force) for force, _ in acts) + np.linalg.norm(couples) / scene.size_m
    for contact in phase.contacts:
        assert contact.force_normal_n is not None
        assert contact.force_tangential_n is not None
        force = contact.force_tangential_n - contact.force_normal_n * contact.normal_world
        acts.append((force, contact.place_world))
    net = sum(force for force, _ in acts)
    moment = couples + sum(np.cross(at - center, force) for force, at in acts)
    return float(max(np.linalg.norm(net), np.linalg.norm(moment) / scene.size_m) / size_of_load)
