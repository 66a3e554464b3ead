"""What looks like a slip in a scene that can be run: said, and run all the same."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cagepose.model.boundary.features import is_flat_sided
from cagepose.model.boundary.joined_surfaces import surface_groups
from cagepose.model.facets import Facets
from cagepose.model.geometry import body_limits, object_size
from cagepose.model.scene import Scene, millimetres
from cagepose.model.shapes import Capsule, Cylinder, Sphere
from cagepose.model.tolerances import LEAST_CLEARANCE
from cagepose.model.wording import few

GREATEST_FRICTION = 2.0
"""Rubber on dry concrete has about 1."""
DISTANCE_OF_PARTS = 0.1
"""In sizes of the smaller of two parts: what joins parts that are nearer is often left out of a model on purpose."""
DISTANCE_OF_CENTRE = 1.0
"""In sizes of the object: a centre of gravity that is farther from it is hardly meant."""
SMALLEST_M, LARGEST_M = 1e-4, 10.0
"""Scenes beyond these sizes are mostly given in another unit than was meant."""
SMALL_ENOUGH_M = 3.0
"""An object of this size may stand on a floor of any, as those of robots do."""
GREATEST_GRAVITY = 300.0
"""m/s². Machines shake parts with less; 386 in/s² and 9810 mm/s² are more."""
EARTH_M_S2 = 9.81
"""m/s²."""


def remarks(scene: Scene) -> Iterator[str]:
    """Yield what a scene's author should look at once more."""
    yield from _left_out(scene)
    yield from _friction(scene)
    yield from _pieces(scene)
    yield from _center(scene)
    yield from _gravity(scene)
    yield from _fits(scene)
    yield from _flattened(scene)
    is_large = scene.size_m > LARGEST_M and object_size(scene.object) > SMALL_ENOUGH_M
    if is_large or scene.size_m < SMALLEST_M:
        yield (
            f"the scene is {millimetres(scene.size_m)} across; check the unit (units.length of a file, which is mm if"
            " left out; metres in Python)"
        )


def _left_out(scene: Scene) -> Iterator[str]:
    if scene.left_out:
        yield (
            f"the source of this scene also has {few(scene.left_out)}, which is left out here: where it would touch the"
            " object, the result is wrong"
        )


def _friction(scene: Scene) -> Iterator[str]:
    given = {"friction": scene.friction_coefficient or 0.0}
    given |= {f"friction of {name}": coefficient for name, coefficient in scene.friction_of.items()}
    for name, coefficient in given.items():
        if coefficient > GREATEST_FRICTION:
            yield (
                f"{name}: a coefficient of {coefficient:.6g} is more than dry surfaces have (rubber about 1); an angle"
                " is given as angle_deg"
            )


def _pieces(scene: Scene) -> Iterator[str]:
    """Parts of the object that lie apart from the first one and all that hangs together with it, by the boxes around
    parts in the object's axes.
    """
    parts = scene.object.parts
    limits = np.stack([body_limits([part]) for part in parts])
    low, high = limits[:, 0], limits[:, 1]
    sizes = np.linalg.norm(high - low, axis=1)
    is_joined = np.zeros(len(parts), bool)
    is_joined[0], reached = True, [0]
    while reached:
        part = reached.pop()
        gaps = np.linalg.norm(np.maximum(np.maximum(low - high[part], low[part] - high), 0.0), axis=1)
        near = ~is_joined & (gaps <= DISTANCE_OF_PARTS * np.minimum(sizes, sizes[part]))
        is_joined |= near
        reached += np.flatnonzero(near).tolist()
    if not is_joined.all():
        apart = [str(part.name) for part, joined in zip(parts, is_joined.tolist(), strict=True) if not joined]
        verb = "lies" if len(apart) == 1 else "lie"
        yield f"{few(apart)} {verb} apart from {parts[0].name}, and move with it as one body; check positions and sizes"


def _center(scene: Scene) -> Iterator[str]:
    held = scene.object
    low, high = body_limits((*held.parts, *held.holes))
    center = held.center_of_gravity_m
    outside = float(np.linalg.norm(center - np.clip(center, low, high)))
    if outside > DISTANCE_OF_CENTRE * object_size(held):
        yield (
            f"the centre of gravity lies {millimetres(outside)} outside the object; check center_of_gravity, which is"
            " given in the object's frame"
        )


def _gravity(scene: Scene) -> Iterator[str]:
    if scene.object.mass_kg is None:  # the direction alone counts
        return
    loads = dict[str, list[str]]()
    for load in scene.loads:
        strength = 0.0 if load.gravity_world is None else float(np.linalg.norm(load.gravity_world))
        if strength > GREATEST_GRAVITY:
            loads.setdefault(f"{strength:.6g} m/s² is {strength / EARTH_M_S2:.0f} times the Earth's", []).append(
                load.name
            )
    for found, names in loads.items():
        yield (
            f"{few(names)}: a gravity of {found}; it is given in m/s², whatever the unit of length"
            f" ({EARTH_M_S2} on Earth)"
        )


def _flattened(scene: Scene) -> Iterator[str]:
    """Facets that stand for what is round, and meet other parts of their body: they are joined as flat facets."""
    for parts in (scene.object.parts, scene.cage.standing.shapes, *(body.own.shapes for body in scene.cage.bodies)):
        flat_sided = {k: part for k, part in enumerate(parts) if is_flat_sided(part)}
        for group in surface_groups(flat_sided, scene.touch_m):
            names = [str(part.name) for k in sorted(group) if isinstance(part := parts[k], Facets) and part.is_round]
            if len(group) > 1 and names:
                yield (
                    f"{few(names)}: joined with other parts of the body as flat facets, not as the round surfaces that"
                    " they stand for; draw what is one as one solid"
                )


def _fits(scene: Scene) -> Iterator[str]:
    """Round parts that are as wide as a hole of the other body."""
    held, cage = scene.object, scene.cage
    for parts, holes in ((held.parts, cage.holes), (cage.shapes, held.holes)):
        round_ones = [part for part in parts if isinstance(part, Cylinder | Capsule | Sphere)]
        for hole in holes:
            exact = LEAST_CLEARANCE * hole.radius_m
            names = [str(part.name) for part in round_ones if abs(part.radius_m - hole.radius_m) <= exact]
            if names:
                yield (
                    f"{few(names)} and the hole {hole.name} have the same radius, so that rounding decides whether one"
                    " goes into the other; give them the clearance of the real parts"
                )
