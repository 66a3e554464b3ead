"""A run in the files of other programs: `exported`."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, NamedTuple

from cagepose.exchange.mjcf import mjcf_notes, mjcf_text
from cagepose.exchange.poses import poses_csv
from cagepose.exchange.solids import assembly_of
from cagepose.exchange.solids_note import file_beside, solids_note, with_note
from cagepose.exchange.step import step_bytes
from cagepose.exchange.stl import stl_text
from cagepose.exchange.urdf import urdf_files, urdf_notes
from cagepose.runs.run import Run

Format = Literal["mjcf", "urdf", "step", "stl", "csv"]


class Export(NamedTuple):
    """Files by their names, the one that was asked for last, and what they do not say as the scene does."""

    files: dict[str, bytes]
    notes: tuple[str, ...]


def exported(run: Run, to: Format, name: str) -> Export:
    """Return a run's scene in a format, with the poses that it holds; ``name``: of the file, without its folder.

    Raises
    ------
    SceneError
        The format cannot hold a part of the scene, which is named.
    MissingExtraError
        Parts with holes need manifold3d, STEP files Open CASCADE.
    """
    if to == "csv":
        return Export({name: poses_csv(run).encode()}, ())
    if to == "stl":
        text, notes = stl_text(run.scene, run.pose)
        beside = file_beside(Path(name)).name
        return Export({beside: solids_note(run.scene, run.pose).encode(), name: text.encode()}, notes)
    if to == "step":
        content, notes = step_bytes(run.scene, run.pose)
        return Export({name: with_note(content, solids_note(run.scene, run.pose))}, notes)
    assembly = assembly_of(run.scene)
    if to == "mjcf":
        return Export({name: mjcf_text(assembly, run.phases).encode()}, mjcf_notes(assembly))
    return Export(urdf_files(assembly, name), urdf_notes(assembly))
