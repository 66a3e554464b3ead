"""Solids of STEP and mesh files, and what they are in a scene: `source_solids`, `SourceSolid.part`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cagepose.exchange.imported_part import ImportedPart, Measures, measures_of_mesh, measures_of_shapes
from cagepose.exchange.stl import MM_PER_M
from cagepose.files.meshes import mesh_file
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.step import step_file
from cagepose.files.step.solid_shapes import rounded, solid_shapes
from cagepose.files.step.triangles import CHORDS_OF_CIRCLE
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.surface import shape_mesh
from cagepose.model.wording import few

Data = dict[str, Any]

SOLIDS = (*step_file.SUFFIXES, *mesh_file.SUFFIXES)


class SourceSolid(NamedTuple):
    """A solid as its file has it.

    Attributes
    ----------
    name
        In its file; "" where it has none.
    data
        Of a STEP file, see `cagepose.files.step.solids.read_step`; of others, ``vertices`` and ``faces`` alone.
        Millimetres.
    """

    name: str
    data: Data

    @property
    def is_step(self) -> bool:
        return "volume" in self.data

    def surface(self) -> Triangles:
        """Return its triangles, millimetres; of what is round all over, as that has none, those of our own shape."""
        if "core" not in self.data:
            return Triangles(np.array(self.data["vertices"]), np.array(self.data["faces"]))
        mesh = shape_mesh(rounded(self.data, self.name), CHORDS_OF_CIRCLE)
        return Triangles(mesh.vertices_m, mesh.triangles)

    def middle_m(self) -> FloatArray:
        """Return the middle of the box around it, (3,), metres."""
        corners = np.array(self.data["core"] if "core" in self.data else self.data["vertices"])
        middle: FloatArray = (corners.max(axis=0) + corners.min(axis=0)) / 2.0 / MM_PER_M
        return middle

    def part(self, body: str, name: str, frame: Pose) -> ImportedPart:
        """Return what it is in a scene.

        Parameters
        ----------
        body
            "object" or "cage".
        name
            Of its shapes.
        frame
            Where the file is in the frame of that body.

        Raises
        ------
        SceneError
            Its surface is no closed one.
        """
        if self.is_step:
            found = solid_shapes(name, self.data)
        else:
            found = mesh_file.sound_shapes(self.surface(), name, "mm", f"{name!r} ")
        metres = [mesh_file.scaled(shape, 1.0 / MM_PER_M) for shape in found.shapes]
        shapes = tuple(shape.moved(frame @ shape.pose_body_shape) for shape in metres)
        own = self.surface()
        surface = Triangles(frame.transform(own.vertices / MM_PER_M), own.faces)
        source = _measures_of_step(self.data, frame) if self.is_step else measures_of_mesh(surface)
        return ImportedPart(
            body, name, shapes, surface, source, measures_of_shapes(shapes), found.error / MM_PER_M, found.notes
        )


def source_solids(path: Path, notes: list[str], *, is_ours: bool = False, fillets: bool = True) -> list[SourceSolid]:
    """Return the solids of a file; ``notes`` are told what is left out. A file that ``is_ours`` is in millimetres.
    ``fillets``: whether hollow roundings of STEP files stay.

    Raises
    ------
    SceneError
        A file that cannot be used.
    MissingExtraError
        What reads it is not installed.
    """
    if path.suffix.lower() in step_file.SUFFIXES:
        read = step_file.read_step_file(path, fillets=fillets)
        if read["out"]:
            notes.append(f"left out: {few(read['out'], 12)}")
        return [SourceSolid(name, solid) for name, solid in step_file.named_solids(read).items()]
    is_glb = path.suffix.lower() == ".glb"
    if not (is_glb or is_ours):
        notes.append("the file does not say its unit: here, millimetres")
    scale = MM_PER_M if is_glb else 1.0
    return [
        SourceSolid(name.partition(", made by")[0], {"vertices": scale * mesh.vertices, "faces": mesh.faces})
        for name, mesh in mesh_file.read_solids(path).items()
    ]


def _measures_of_step(solid: Data, frame: Pose) -> Measures:
    turn = frame.rotation
    corners = np.array(np.meshgrid(*zip(solid["low"], solid["high"], strict=True))).reshape(3, -1).T
    return Measures(
        solid["volume"] / MM_PER_M**3,
        frame.transform(np.array(solid["center"]) / MM_PER_M),
        np.array([ends(frame.transform(corners / MM_PER_M), axis=0) for ends in (np.min, np.max)]),
        turn @ (np.array(solid["gyration"]) / MM_PER_M**2) @ turn.T,
    )
