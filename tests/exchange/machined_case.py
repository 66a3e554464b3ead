"""A machined part let go over what holds it, with the truth about where it ends: `Case`. Millimetres and newtons."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np

from cagepose import Box, Cage, Force, Hole, Load, Object, Pose, Scene, Shape
from cagepose.files.meshes.mesh_file import read_mesh, scaled
from cagepose.files.step.exact_facets import facets_on_surfaces
from cagepose.files.step.reader import read_here
from cagepose.files.step.step_file import read_step_shapes
from exchange.cad_parts import Part, Vector, write_step, write_stl

DOWN = (0.0, 0.0, -9.81)
MASS = 0.1
"""Kilograms, so that a part weighs 0.981 N."""
FLOOR = Box((0.12, 0.12, 0.02), Pose((0, 0, -0.01)), "floor")


class Told(NamedTuple):
    """The height of a point of the object along a way in the world, at the end, and what it has to be.

    Without ``height`` the twin says it.
    """

    point: Vector
    way: Vector
    height: float | None = None


@dataclass(frozen=True)
class Case:
    """One scene.

    Attributes
    ----------
    held, cage
        Parts are written to files and read back, shapes of ours stay what they are.
    told
        What is compared; without any, all of the pose is, with that of the twin, and where triangles of a mesh stand
        for what is round, the height of its middle alone.
    off
        How far STEP may be from the truth at most, where there are curves or surfaces that are none of ours.
    verdict
        Of the last phase; where all of the twin is compared, its own.
    """

    held: Part | tuple[Shape, ...]
    cage: tuple[Part | Shape, ...]
    start: Pose
    loads: tuple[Load, ...]
    told: tuple[Told, ...] = ()
    friction: float = 0.0
    off: float = 0.0
    verdict: str = "rests"

    def scene(self, read: Callable[[Part], tuple[Shape, ...]]) -> Scene:
        """Return it with the shapes that each part becomes."""
        held = self.held if isinstance(self.held, tuple) else read(self.held)
        shapes: list[Shape] = []
        for index, one in enumerate(self.cage):
            own = read(one) if isinstance(one, Part) else (one,)
            shapes += [of_part(shape, f"{index}") for shape in own] if isinstance(one, Part) else own
        part = Object(shapes=held, pose=self.start, mass_kg=MASS)
        return Scene(part, Cage(shapes=shapes), self.loads, friction_coefficient=self.friction)

    @property
    def has_twin(self) -> bool:
        return all(one.twin for one in (self.held, *self.cage) if isinstance(one, Part))


def of_part(shape: Shape, part: str) -> Shape:
    """Return a shape with the part in its name."""
    renamed = shape.renamed(f"{part}/{shape.name}")
    return renamed.cut_out_of([f"{part}/{name}" for name in renamed.in_]) if isinstance(renamed, Hole) else renamed


class Reader:
    """Writes parts to files and reads them back, as shapes, as facets alone, or from a mesh."""

    def __init__(self, folder: Path, to: str) -> None:
        self.folder, self.to = folder, to
        self.error = 0.0
        """Sum of what all parts are said to be off, millimetres."""
        self.n_facets = 0

    def __call__(self, part: Part) -> tuple[Shape, ...]:
        path = self.folder / f"part {len(list(self.folder.iterdir()))}.{'stl' if self.to == 'stl' else 'step'}"
        if self.to == "stl":
            write_stl(part, path)
            found = read_mesh(path, "mm", "mm", "part")
            said = [float(off) for note in found.notes for off in re.findall(r"([\d.e-]+) mm off", note)]
            self.error += max([1e3 * found.error, *said])
            shapes = found.shapes
        else:
            write_step(part, path)
            if self.to == "step":
                found = read_step_shapes(path, None, "part")
                self.error += 1e3 * found.error
                shapes = found.shapes
            else:
                (solid,) = read_here(str(path))["solids"]
                exact = facets_on_surfaces(solid, "part") if "faces" in solid else None
                if exact is None:  # round all over
                    shapes = read_step_shapes(path, None, "part").shapes
                else:
                    self.error += exact.error
                    shapes = (scaled(exact.shape, 1e-3),)
        self.n_facets += sum(shape.kind == "facets" for shape in shapes)
        return shapes


def weight(name: str = "weight", toward: Vector = DOWN) -> Load:
    return Load(name, gravity=toward)


def push(way: Vector, at: Vector, newtons: float, name: str = "push", toward: Vector = DOWN) -> Load:
    return Load(name, gravity=toward, force=Force(way, 1e-3 * np.array(at), newtons))


def pose(at: Vector, yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> Pose:
    """Return a pose of millimetres and degrees."""
    return Pose(1e-3 * np.array(at), euler_zyx=tuple(math.radians(angle) for angle in (yaw, pitch, roll)))


class Draw:
    """Draws numbers of a variant of a part: the first has round ones in the middle, others have any."""

    def __init__(self, name: str, variant: int) -> None:
        self.random = np.random.default_rng([variant, *name.encode()]) if variant else None

    def __call__(self, low: float, high: float) -> float:
        if self.random is None:
            return round((low + high) / 2.0, 1)
        return round(float(self.random.uniform(low, high)), 3)

    def angle(self, most: float) -> float:
        """Of a start that is a little aslant, degrees; the first variant starts straight."""
        return 0.0 if self.random is None else float(self.random.uniform(-most, most))


CASES: dict[str, partial[Case]] = {}
"""All of them by their names, each built when it is asked for."""


def machined(n_variants: int) -> Callable[[Callable[[Draw], Case]], Callable[[Draw], Case]]:
    """Note a builder as so many cases; of a single one numbers are random."""

    def note(build: Callable[[Draw], Case]) -> Callable[[Draw], Case]:
        name = build.__name__.replace("_", " ")
        for variant in range(n_variants) if n_variants > 1 else [1]:
            CASES[f"{name} {variant + 1}"] = partial(_built, build, name, variant)
        return build

    return note


def _built(build: Callable[[Draw], Case], name: str, variant: int) -> Case:
    return build(Draw(name, variant))


def cases_of(module: ModuleType) -> list[str]:
    """Return the names of those that a module has, the last variant of each builder."""
    last = {make.args[0]: name for name, make in CASES.items() if make.args[0].__module__ == module.__name__}
    return list(last.values())
