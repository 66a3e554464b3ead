"""A scene as URDF, the format of ROS: `urdf_files`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import PurePath
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from cagepose.exchange.beside import beside_text
from cagepose.exchange.mjcf import add_comments, mass_kg, notes_of_loads, numbers
from cagepose.exchange.solids import Assembly, Primitive
from cagepose.exchange.stl import binary_stl
from cagepose.model.box import Box
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.shapes import Capsule, Convex, Cylinder, Sphere
from cagepose.model.surface import shape_mesh

NOTE = "cagepose"
"""The element in which our note stands; other readers pass over it."""
NO_SEGMENTS = 3
"""Chords of a circle in the mesh of a sharp hull, which has none."""


def urdf_notes(assembly: Assembly) -> tuple[str, ...]:
    """Return what the model does not say as the scene does."""
    friction = "URDF has no friction and no gravity: they are in the note for cagepose alone"
    return (*assembly.notes, *notes_of_loads(assembly.scene), friction)


def urdf_files(assembly: Assembly, name: str) -> dict[str, bytes]:
    """Return the files by their names: first the meshes, in a folder beside, and last the URDF ``name`` itself.

    Metres, kilograms, radians. The object hangs on a floating joint at its start pose: URDF holds no other poses.
    """
    scene, meshes, stem = assembly.scene, dict[str, bytes](), PurePath(name).stem
    root = Element("robot", name=scene.name)
    add_comments(root, scene, urdf_notes(assembly))
    SubElement(SubElement(root, "mujoco"), "compiler", strippath="false", fusestatic="false")
    SubElement(root, NOTE).text = beside_text(scene, with_friction=True)
    SubElement(root, "link", name="world")
    for body, solids, pose, kind in (
        ("cage", assembly.cage, scene.cage.pose_world_cage, "fixed"),
        ("object", assembly.object, scene.object.pose_world_object, "floating"),
    ):
        link = SubElement(root, "link", name=body)
        if body == "object":
            _add_inertial(link, scene.object)
        for solid in solids:
            for label, shape in _known(f"{body}/{solid.name}", solid.shape):
                for element in ("visual", "collision"):
                    _add_geometry(SubElement(link, element, name=label), label, shape, stem, meshes)
        joint = SubElement(root, "joint", name=body, type=kind)
        SubElement(joint, "parent", link="world")
        SubElement(joint, "child", link=body)
        _add_origin(joint, pose)
    indent(root)
    return {**meshes, name: (str(tostring(root, encoding="unicode")) + "\n").encode()}


def _known(label: str, shape: Primitive) -> Iterator[tuple[str, Primitive]]:
    """Yield what URDF knows: a capsule is a cylinder and two balls there, exactly."""
    if not isinstance(shape, Capsule):
        yield label, shape
        return
    yield f"{label}/bar", Cylinder(shape.radius_m, shape.length_m, shape.pose_body_shape)
    for end, place in zip(("low end", "high end"), shape.nodes_body(), strict=True):
        yield f"{label}/{end}", Sphere(shape.radius_m, Pose(place))


def _add_geometry(parent: Element, label: str, shape: Primitive, stem: str, meshes: dict[str, bytes]) -> None:
    geometry = Element("geometry")
    if isinstance(shape, Box):
        SubElement(geometry, "box", size=numbers(shape.size_m))
    elif isinstance(shape, Sphere):
        SubElement(geometry, "sphere", radius=numbers(shape.radius_m))
    elif isinstance(shape, Cylinder):
        SubElement(geometry, "cylinder", radius=numbers(shape.radius_m), length=numbers(shape.length_m))
    else:
        assert isinstance(shape, Convex)
        file = f"{stem}-meshes/{re.sub('[^A-Za-z0-9_-]+', '-', label)}.stl"
        content = binary_stl(shape_mesh(shape, NO_SEGMENTS))
        while meshes.get(file, content) != content:  # names may differ in what a file's name leaves out
            file = f"{file.removesuffix('.stl')}-2.stl"
        meshes[file] = content
        SubElement(geometry, "mesh", filename=file)
    # The vertices of a mesh are in the frame of the body.
    _add_origin(parent, Pose() if isinstance(shape, Convex) else shape.pose_body_shape)
    parent.append(geometry)


def _add_origin(parent: Element, pose: Pose) -> None:
    yaw, pitch, roll = pose.euler_zyx
    SubElement(parent, "origin", xyz=numbers(pose.position_m), rpy=numbers((roll, pitch, yaw)))


def _add_inertial(link: Element, held: Object) -> None:
    found = SubElement(link, "inertial")
    _add_origin(found, Pose(held.center_of_gravity_m))
    mass = mass_kg(held)
    SubElement(found, "mass", value=numbers(mass))
    names = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    inertia = mass * np.asarray(held.gyration_m2)
    SubElement(found, "inertia", {name: numbers(inertia[place]) for name, place in names.items()})
