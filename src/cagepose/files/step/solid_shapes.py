"""One solid of a STEP file as shapes: `solid_shapes`. Millimetres throughout."""

from __future__ import annotations

from typing import Any

import numpy as np

from cagepose.errors import SceneError
from cagepose.files.meshes import mesh_file
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mesh_shapes import MeshShapes, known_shapes, mesh_shapes
from cagepose.files.meshes.surface_distance import farthest_from
from cagepose.files.step.exact_facets import facets_on_surfaces
from cagepose.files.step.tolerances import SAME_VOLUME
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Capsule, Convex, Shape, Sphere
from cagepose.model.wording import counted

Data = dict[str, Any]

MOST_RECOGNISED = 4000
"""Triangles of a solid that is asked whether it is one of our shapes, or a few: of more, that takes seconds."""
LOSS_OF_ROUNDINGS = 0.05
"""Fraction of the size. Hollow roundings whose loss is more are kept, as many flat faces."""


def solid_shapes(name: str, solid: Data) -> MeshShapes:
    """Return the shapes that a solid is, where it is in its file, named as those of a mesh are.

    Parameters
    ----------
    name
        Of its shapes.
    solid
        One of those that `cagepose.files.step.solids.read_step` returns.

    Returns
    -------
    MeshShapes
        Its ``error`` is how far the shapes are from the surface of the solid at most; zero: they are the solid.

    Raises
    ------
    SceneError
        Its surface is no closed one.
    """
    if "core" in solid:
        return MeshShapes((rounded(solid, name),), 0.0, ())
    if solid["off_volume"] > 0.0:
        found_off = f"{name!r} is {solid['off_volume']:.1%} of its volume off as Open CASCADE makes triangles of it"
        raise mesh_file.refused(f"{found_off}; repair it, or export it as STL")
    given = Triangles(np.array(solid["vertices"]), np.array(solid["faces"]))
    mesh, said = mesh_file.sound(given, name, "mm", f"{name!r} ")
    notes = [*said]
    lost = 0.0
    if "sharp" in solid:
        solid, mesh, lost = _sharp(solid, mesh, name, notes)
    known = known_shapes(mesh, name, "mm") if len(mesh.faces) <= MOST_RECOGNISED else None
    if known is not None and _is_exact(known, solid):
        return MeshShapes(known.shapes, lost, tuple(notes))
    if solid["is_closed"]:
        exact = facets_on_surfaces(solid, name)
        return MeshShapes((exact.shape,), max(lost, exact.error), (*notes, *exact.notes))
    found = known or mesh_shapes(mesh, name, "mm")
    notes += found.notes
    if solid["off"] > found.error:
        notes.append(f"{name!r} has flat sides where it is round there, up to {solid['off']:.2g} mm off")
    return MeshShapes(found.shapes, max(lost, solid["off"], found.error), tuple(notes))


def _sharp(solid: Data, mesh: Triangles, name: str, notes: list[str]) -> tuple[Data, Triangles, float]:
    """Return a solid without its hollow roundings, its surface, and how far that is off; with them, where they are a
    great part of it.
    """
    try:
        sharp = Triangles(np.array(solid["sharp"]["vertices"]), np.array(solid["sharp"]["faces"]))
        mesh_file.checked(sharp, f"{name!r} ")
    except SceneError:  # Open CASCADE left it open or crossing itself
        return solid, mesh, 0.0
    off = max(farthest_from(mesh, sharp), farthest_from(sharp, mesh))
    if off > LOSS_OF_ROUNDINGS * mesh.size:
        return solid, mesh, 0.0
    roundings = counted((solid["n_fillets"], "hollow rounding", "hollow roundings"))
    notes.append(
        f"{name!r} has {roundings}, of {solid['radius']:.3g} mm at most: here, sharp corners, up to {off:.2g} mm off;"
        " where something rests in one, make it a chamfer"
    )
    return solid["sharp"], sharp, off


def rounded(solid: Data, name: str) -> Shape:
    """Return a solid that has a ``core`` as a shape."""
    core, radius = np.array(solid["core"]), solid["radius"]
    if len(core) == 1:
        return Sphere(radius, Pose(core[0]), name)
    if len(core) == 2:
        span = core[1] - core[0]
        return Capsule(radius, float(np.linalg.norm(span)), Pose(core.mean(axis=0), turn_from_z(span)), name)
    return Convex(core, radius, None, name)


def _is_exact(found: MeshShapes, solid: Data) -> bool:
    """Whether shapes have the volume of the surfaces that the triangles stand for."""
    volume = sum((-1.0 if isinstance(shape, Hole) else 1.0) * shape_moments(shape).volume_m3 for shape in found.shapes)
    return bool(abs(volume - solid["volume"]) <= SAME_VOLUME * volume)
