"""The scene in which what a phase drives is set up out of place, drawn anew: `misaligned_scene`."""

from __future__ import annotations

from cagepose.model.cage import Cage
from cagepose.model.cage_body import CageBody
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.misaligned import Misaligned


def misaligned_scene(scene: Scene, phase: int, moved: Pose) -> Scene:
    """Return the scene that `Misaligned` runs without one: the bodies that a phase drives, and the object where it
    hangs on them by springs alone, are moved in the cage's frame, with their ways in all phases. Springs keep their
    length without a load.

    Raises
    ------
    SceneError
        The object would start inside the cage.
    """
    misaligned = Misaligned(scene, phase)
    held, cage, standing = scene.object, scene.cage, scene.cage.standing
    bodies = [
        CageBody(body.name, body.points_body, body.names, moved @ body.pose_cage_body, body.shapes, body.holes)
        if body.name in misaligned.bodies
        else body
        for body in cage.bodies
    ]
    placed = cage.pose_world_cage
    elsewhere = Cage(standing.points_m, standing.names, placed, standing.shapes, standing.holes, bodies)
    start = held.pose_world_object
    part = held.starting_at(placed @ moved @ placed.inverse() @ start) if misaligned.takes_object else held
    loads = [_moved_load(load, misaligned, moved, (scene, part, elsewhere)) for load in scene.loads]
    return scene.but_for(object=part, cage=elsewhere, loads=loads)


def _moved_load(load: Load, misaligned: Misaligned, moved: Pose, places: tuple[Scene, Object, Cage]) -> Load:
    """Return a load for bodies and an object that stand elsewhere: a spring's preload is its tension at the start."""
    scene, part, cage = places
    springs = [
        spring.starting_longer(
            cage.spring_length_m(spring, part.pose_world_object)
            - scene.cage.spring_length_m(spring, scene.object.pose_world_object)
        )
        for spring in load.springs
    ]
    return Load(
        load.name,
        gravity=load.gravity_world,
        force=load.force,
        forces=load.forces,
        moments=load.moments,
        springs=springs,
        drive={
            name: [leg.moved(moved) for leg in legs] if name in misaligned.bodies else legs
            for name, legs in load.drive.items()
        },
        stop_at=load.stop_at,
        press=load.press,
    )
