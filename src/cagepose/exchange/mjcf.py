"""A scene as MJCF, MuJoCo's format of bodies: `mjcf_text`.

Written by ourselves to the last digit of each number: MuJoCo's own writer keeps six.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

import numpy as np
from numpy.typing import ArrayLike

from cagepose.exchange.beside import beside_text, not_kept
from cagepose.exchange.joints import ObjectJoints
from cagepose.exchange.solids import Assembly, Primitive, Solid
from cagepose.files.write import MADE_BY
from cagepose.model.box import Box
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Convex, Sphere
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import PhaseRun

NOTE = "cagepose"
"""Name of the text in which our note stands."""
EARTH_GRAVITY = 9.81
"""m/s^2, where a scene gives gravity a direction alone."""
KINDS = {"box": "box", "sphere": "sphere", "capsule": "capsule", "cylinder": "cylinder", "convex": "mesh"}
OWN_PRIORITY = {"cage": 2, "object": 1}
"""Priorities of geoms with a friction of their own. That of the cage's counts, else that of the object's, as in a
scene."""


def mjcf_text(assembly: Assembly, phases: Sequence[PhaseRun] = ()) -> str:
    """Return the model: metres, kilograms, radians; a keyframe for the end of each phase."""
    scene = assembly.scene
    root = Element("mujoco", model=scene.name)
    add_comments(root, scene, mjcf_notes(assembly))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    SubElement(root, "option", gravity=numbers(_gravity(scene)))
    SubElement(SubElement(root, "custom"), "text", name=NOTE, data=beside_text(scene))
    assets, world = Element("asset"), Element("worldbody")
    cage = SubElement(world, "body", {"name": "cage", **_place(scene.cage.pose_world_cage)})
    held = SubElement(world, "body", {"name": "object", **_place(scene.object.pose_world_object)})
    joints = ObjectJoints(scene)
    joints.add_to(held, numbers)
    SubElement(held, "inertial", _inertial(scene.object))
    for name, body, solids in (("cage", cage, assembly.cage), ("object", held, assembly.object)):
        for solid in solids:
            body.append(_geom(scene, name, solid, assets))
    root.extend([assets, world] if len(assets) else [world])
    joints.hold(root)
    if phases:
        keys = SubElement(root, "keyframe")
        for phase in phases:
            SubElement(keys, "key", name=phase.name, qpos=numbers(joints.coordinates(phase.pose)))
    indent(root)
    return str(tostring(root, encoding="unicode")) + "\n"


def numbers(values: ArrayLike) -> str:
    """Return numbers as text from which the same are read again."""
    return " ".join(repr(value) for value in np.asarray(values, dtype=np.float64).ravel().tolist())


def mass_kg(held: Object) -> float:
    """Return the mass that is written: one kilogram for an object without one."""
    return 1.0 if held.mass_kg is None else held.mass_kg


def notes_of_loads(scene: Scene) -> list[str]:
    """Return what is said of mass, loads and what is adjustable, which no format of bodies holds."""
    found = not_kept(scene)
    if scene.object.mass_kg is None:
        found.append("the scene gives no mass; here it is 1 kg")
    others = [load.name for load in scene.loads if load.pushes or load.moments or load.springs]
    if others:
        found.append(f"forces, moments and springs are in the note for cagepose alone: {', '.join(others)}")
    return found


def mjcf_notes(assembly: Assembly) -> tuple[str, ...]:
    """Return what the model does not say as the scene does."""
    found, loads = [*assembly.notes, *notes_of_loads(assembly.scene)], assembly.scene.loads
    of_phases = [None if load.gravity_world is None else load.gravity_world.tolist() for load in loads]
    first = next((load for load in loads if load.gravity_world is not None), None)
    if first is not None and any(gravity != of_phases[loads.index(first)] for gravity in of_phases):
        found.append(f"gravity is that of the phase {first.name!r}; other phases are in the note for cagepose")
    return tuple(found)


def add_comments(root: Element, scene: Scene, notes: Sequence[str]) -> None:
    """Put what a reader should know first, a comment each."""
    for line in (f"{scene.name}, {MADE_BY}; metres, kilograms, radians", *notes):
        root.append(Comment(f" {re.sub('-(?=-)', '- ', line)} "))  # a comment must not hold two hyphens in a row


def _gravity(scene: Scene) -> ArrayLike:
    for load in scene.loads:
        if load.gravity_world is not None:
            return gravity_m_s2(scene, load)
    return (0.0, 0.0, 0.0)


def gravity_m_s2(scene: Scene, load: Load) -> ArrayLike:
    """Return a phase's gravity as an acceleration, (3,); without a mass a scene gives its direction alone."""
    assert load.gravity_world is not None
    if scene.object.mass_kg is not None:
        return load.gravity_world
    return EARTH_GRAVITY * load.gravity_world / float(np.linalg.norm(load.gravity_world))


def _place(pose: Pose) -> dict[str, str]:
    return {"pos": numbers(pose.position_m), "quat": numbers(pose.quaternion_wxyz)}


def _inertial(held: Object) -> dict[str, str]:
    mass = mass_kg(held)
    inertia = mass * held.gyration_m2
    return {
        "pos": numbers(held.center_of_gravity_m),
        "mass": numbers(mass),
        "fullinertia": numbers([*inertia.diagonal(), inertia[0, 1], inertia[0, 2], inertia[1, 2]]),
    }


def _geom(scene: Scene, body: str, solid: Solid, assets: Element) -> Element:
    name = f"{body}/{solid.name}"
    found = Element("geom", {"name": name, "type": KINDS[solid.shape.kind], **_place(solid.shape.pose_body_shape)})
    if isinstance(solid.shape, Convex):
        SubElement(assets, "mesh", name=name, vertex=numbers(solid.shape.hull.vertices_m))
        found.set("mesh", name)
    else:
        found.set("size", numbers(_size(solid.shape)))
    if body == "cage":
        found.set("mass", "0")  # it does not move; MuJoCo finds no axes of inertia of balls as small as points
    own = scene.friction_of.get(solid.element)
    if own is not None:
        found.set("priority", str(OWN_PRIORITY[body]))
    friction = chosen_method(scene).friction(scene) if own is None else own
    found.set("condim", "3" if friction > 0.0 else "1")
    found.set("friction", f"{friction!r} 0.005 0.0001")
    return found


def _size(shape: Primitive) -> ArrayLike:
    """Return a primitive's size as MuJoCo has it: half lengths."""
    if isinstance(shape, Box):
        return shape.size_m / 2.0
    if isinstance(shape, Sphere):
        return shape.radius_m
    assert not isinstance(shape, Convex)
    return (shape.radius_m, shape.length_m / 2.0)
