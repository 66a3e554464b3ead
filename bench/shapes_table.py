"""Scenes of true shapes beside MuJoCo: rollers, a peg in a hole, pins in holes, and such holes as 32 boxes each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np

from bench import ours
from bench.rail_case import SCENES
from bench.rows import Row, with_ratios
from bench.timing import median_cpu_s, median_s
from cagepose import Box, MissingExtraError, Object, Pose, Run, Scene, load_scene, run
from cagepose.exchange.crosscheck import apart_m, surface_points
from cagepose.exchange.mujoco_run import SETTINGS, MujocoRest, MujocoScene
from cagepose.exchange.solids import assembly_of

BUDGET_S = 0.6
METHOD = "quasistatic"
FACETED = "plate-on-pins, 32 boxes a hole"
BOXES_A_HOLE, WALL_M, PAD_M = 32, 0.005, 0.004
"""What stands for a round hole where there are only boxes: so many around it, so thick, and one on each rest."""


def shape_rows() -> Iterator[Row]:
    """Measure the scenes that stand for what people build, as they are and with faceted holes."""
    plate = load_scene(SCENES / "plate-on-pins.yaml")
    scenes = {name: load_scene(SCENES / f"{name}.yaml") for name in ("rollers", "peg-in-hole")}
    for name, scene in {**scenes, "plate-on-pins": plate, FACETED: with_faceted_holes(plate)}.items():
        done = run(scene, METHOD)
        times_s, _ = ours.measure(scene, METHOD, BUDGET_S)
        n_events = sum(len(phase.events) for phase in done.phases)
        own = []
        for part in ours.PARTS:
            wall_s, cpu_s = times_s[part]
            details = {"verdict": done.verdict, "events": n_events, "cpu_s": cpu_s}
            own.append(Row("shapes", name, ours.engine_name(METHOD, part), wall_s, details=details))
        yield from (with_ratios(row, own[0]) for row in (*own, _mujoco_row(name, done)))


def with_faceted_holes(scene: Scene) -> Scene:
    """Return a scene whose object is boxes around its holes and over the cage's points, with the same mass and inertia.

    The inner faces of the boxes touch the holes' circles from outside.
    """
    held, boxes = scene.object, list[Box]()
    for hole in held.holes:
        middle = hole.pose_body_shape.transform((0.0, 0.0, -hole.depth_m / 2.0))
        width = 2.0 * (hole.radius_m + WALL_M) * math.tan(math.pi / BOXES_A_HOLE)
        for angle in np.arange(BOXES_A_HOLE) * 2.0 * math.pi / BOXES_A_HOLE:
            away = (hole.radius_m + WALL_M / 2.0) * np.array([math.cos(angle), math.sin(angle), 0.0])
            boxes.append(Box((WALL_M, width, hole.depth_m), Pose(middle + away, euler_zyx=(angle, 0, 0))))
    thick = held.holes[0].depth_m
    for point in scene.cage.points_world():
        boxes.append(Box((PAD_M, PAD_M, thick), Pose((point[0], point[1], thick / 2.0))))
    faceted = Object(
        boxes,
        held.center_of_gravity_m,
        pose=held.pose_world_object,
        mass_kg=held.mass_kg,
        inertia_kg_m2=held.inertia_kg_m2,
    )
    return Scene(
        faceted,
        scene.cage,
        scene.loads,
        friction_coefficient=scene.friction_coefficient,
        metric=scene.metric,
        tolerances=scene.tolerances,
    )


def _mujoco_row(name: str, done: Run) -> Row:
    points = surface_points(done.scene.object)
    try:
        engine = MujocoScene(assembly_of(done.scene), points)
    except MissingExtraError as error:
        return Row("shapes", name, "mujoco", skipped=str(error))

    def settled() -> list[MujocoRest]:
        pose, found = done.scene.object.pose_world_object, list[MujocoRest]()
        for phase in range(len(done.phases)):
            found.append(engine.settle(phase, pose))
            pose = found[-1].pose
        return found

    rests = settled()
    if not all(rest.settled.is_quiet for rest in rests):
        return Row("shapes", name, "mujoco", settings=asdict(SETTINGS), skipped="found no rest")
    apart = max(apart_m(points, rest.pose, phase.pose) for rest, phase in zip(rests, done.phases, strict=True))
    details = {
        "cpu_s": median_cpu_s(settled, BUDGET_S),
        "apart": apart / done.scene.size_m,
        "penetration": max(rest.penetration_m for rest in rests) / done.scene.size_m,
    }
    return Row("shapes", name, "mujoco", median_s(settled, BUDGET_S), settings=asdict(SETTINGS), details=details)
