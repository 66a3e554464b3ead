"""Files of single parts joined to a scene: `joined`. One is the object, the others are the cage."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from shlex import quote
from typing import Any, NamedTuple, Self

import numpy as np

from cagepose.errors import FileProblem, SceneError, SceneFileError
from cagepose.exchange.imported import Import, check_name, import_of
from cagepose.exchange.imported_part import ImportedPart
from cagepose.exchange.model_text import SUFFIXES as MODELS
from cagepose.exchange.solids_document import METRES, SceneData, with_weight_alone
from cagepose.exchange.solids_note import read_solids_note
from cagepose.exchange.source_solids import SOLIDS, SourceSolid, source_solids
from cagepose.exchange.stl import MM_PER_M
from cagepose.files.meshes.mesh_file import refused
from cagepose.files.progress import tell
from cagepose.files.solid_names import SHOWN, solids_named
from cagepose.files.step.reader import UNNAMED
from cagepose.files.units import to_metres
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.wording import coordinates, few

Data = dict[str, Any]

READERS = 2
"""Files that are read at once; each may take 2 GiB."""
PLACED = re.compile(r"(.+)@([-+.,\deE ]+)", re.DOTALL)
"""A file and where it is, as the command line has it."""
WITHIN = re.compile(rf"(.+?(?:{'|'.join(map(re.escape, SOLIDS))}))#(.+)", re.DOTALL | re.IGNORECASE)
"""A file and which of its solids is meant."""
MODEL = (
    "is a robot model, which cannot be joined with files; give it what it holds as a body of its own, a mesh on a free"
    " joint, and import it alone, or join the meshes that it names"
)


class PlacedFile(NamedTuple):
    """A file, and where what it holds is in the world.

    Attributes
    ----------
    file
        Its name.
    pose
        Left out: where its own coordinates say.
    solid
        The one that is meant, or what the names of some begin with before a "/"; None: all.
    """

    file: str
    pose: Pose = Pose()
    solid: str | None = None

    @classmethod
    def of(cls, text: str) -> Self:
        """Return what "FILE", "FILE@x,y,z" or "FILE@x,y,z,yaw,pitch,roll" says, in millimetres and degrees;
        "FILE#NAME" in place of the file says which of its solids.

        Raises
        ------
        SceneFileError
            Other numbers behind the @.
        """
        found = PLACED.fullmatch(text)
        named = WITHIN.fullmatch(text if found is None else found[1])
        file, solid = (named[1], named[2]) if named else (text if found is None else found[1], None)
        if found is None:
            return cls(file, solid=solid)
        try:
            numbers = [float(number) for number in found[2].split(",")]
        except ValueError:
            numbers = []
        if len(numbers) not in (3, 6) or not all(map(math.isfinite, numbers)):
            message = f"is placed at {found[2]!r}; give x,y,z in mm, or x,y,z,yaw,pitch,roll in mm and deg"
            raise SceneFileError([FileProblem((), message, found[1])])
        turn = [math.radians(angle) for angle in numbers[3:]] or None
        return cls(file, Pose(to_metres(numbers[:3], "mm"), euler_zyx=turn), solid)

    def __str__(self) -> str:
        return self.file if self.solid is None else f"{self.file}#{self.solid}"

    @property
    def title(self) -> str:
        """What it is called where it gives a scene its name."""
        return self.solid or Path(self.file).stem


def joined(held: PlacedFile, cage: Sequence[PlacedFile], *, fillets: bool = True) -> Import:
    """Read files of solids (STEP, STL, OBJ, PLY, GLB), each all of what it holds, or some by name; what takes seconds
    is told, see `cagepose.files.progress`.

    Parameters
    ----------
    held
        The object.
    cage
        What holds it, one file at least. A file may stand there several times, at several places.
    fillets
        Whether hollow roundings of STEP files stay; else walls go on to where they meet.

    Raises
    ------
    SceneFileError
        Files that cannot be used, names that no solids have, or a scene that cannot be right.
    MissingExtraError
        What reads one of them is not installed.
    """
    data = _Joiner(held, cage).data(fillets=fillets)
    try:
        return import_of(data, held.file)
    except SceneFileError as error:
        reaches = [_reach(data.parts, placed, body) for placed, body in ((held, "object"), (cage[0], "cage"))]
        raise SceneFileError([*error.problems, *reaches]) from None


def _reach(parts: Sequence[ImportedPart], placed: PlacedFile, body: str) -> FileProblem:
    """Return where what is joined stands, which tells where else it could."""
    pose = placed.pose if body == "object" else Pose()
    solid = [shape for part in parts if part.body == body for shape in part.shapes if not isinstance(shape, Hole)]
    limits = MM_PER_M * np.array([shape.moved(pose @ shape.pose_body_shape).limits_m() for shape in solid])
    low, high = coordinates(limits[:, 0].min(axis=0), 5), coordinates(limits[:, 1].max(axis=0), 5)
    remedy = f"stand elsewhere with --{body} {quote(f'{placed}@x,y,z')}"
    return FileProblem((), f"is of the {body}, which reaches from {low} to {high} mm; let it {remedy}", placed.file)


class _Read(NamedTuple):
    """The solids of a file, and what is not in them as it is there."""

    solids: list[SourceSolid]
    notes: list[str]


class _Joiner:
    def __init__(self, held: PlacedFile, cage: Sequence[PlacedFile]) -> None:
        self.held, self.cage = held, cage
        self.names: set[str] = set()
        self.used: set[int] = set()

    def data(self, *, fillets: bool) -> SceneData:
        files = list(dict.fromkeys([self.held.file, *(placed.file for placed in self.cage)]))
        try:
            with ThreadPoolExecutor(READERS) as pool:  # what reads has a process of its own
                read = dict(zip(files, pool.map(partial(_read, fillets=fillets), files), strict=True))
            parts = self.parts("object", self.held, read, Pose())
            walls = [part for placed in self.cage for part in self.parts("cage", placed, read, placed.pose)]
        finally:
            tell("")
        notes = [f"{Path(file).name}: {note}" for file in files for note in read[file].notes]
        left = [f"{Path(file).name}: solids left out: {names}" for file in files if (names := self.left(read[file]))]
        notes += [*left, *(note for part in (*parts, *walls) for note in part.notes)]
        found: Data = {"name": f"{self.held.title} in {self.cage[0].title}"}
        found["units"] = {"length": "m"}
        found["object"] = {"shapes": _shapes(parts), "pose": METRES.pose(self.held.pose)}
        found["cage"] = {"shapes": _shapes(walls)}
        return SceneData(with_weight_alone(found, notes), notes, (*parts, *walls))

    def parts(self, body: str, placed: PlacedFile, read: dict[str, _Read], frame: Pose) -> list[ImportedPart]:
        """Return what the solids of a file are in a body."""
        solids = read[placed.file].solids
        with _problems_of(placed.file):
            if placed.solid is not None:
                names = solids_named(placed.solid, (solid.name for solid in solids))
                solids = [solid for solid in solids if solid.name in names]
            self.used.update(map(id, solids))
            return [solid.part(body, self.name(solid, placed, len(solids) == 1), frame) for solid in solids]

    def left(self, read: _Read) -> str:
        """Return the names of the solids of a file that nobody chose."""
        return few((solid.name for solid in read.solids if id(solid) not in self.used), SHOWN)

    def name(self, solid: SourceSolid, placed: PlacedFile, is_alone: bool) -> str:
        """Return a name for a solid that no other has: its own, and before it that of its file, if several of that are
        here.
        """
        stem = Path(placed.file).stem
        has_name = placed.solid is not None or (solid.is_step and solid.name != f"{UNNAMED} 1")
        name = (solid.name if has_name else stem) if is_alone else f"{stem}/{solid.name}"
        number = next(k for k in range(1, len(self.names) + 2) if _numbered(name, k) not in self.names)
        self.names.add(_numbered(name, number))
        return _numbered(name, number)


def _read(file: str, *, fillets: bool) -> _Read:
    check_name(file)
    path, notes = Path(file), list[str]()
    with _problems_of(file):
        if path.suffix.lower() in MODELS:
            raise refused(MODEL)
        if path.suffix.lower() not in SOLIDS:
            listed = ", ".join(SOLIDS)
            raise refused(f"is none of the files that can be joined ({listed}); convert it")
        note = read_solids_note(path, notes)
        solids = source_solids(path, notes, is_ours=bool(note), fillets=fillets)
        if note:
            notes.append("loads, points and poses that cagepose kept in it are not taken where files are joined")
        if not solids:
            raise refused("has no solid; export it as one")
    return _Read(solids, notes)


@contextmanager
def _problems_of(file: str) -> Iterator[None]:
    """Say of problems within which file they are of."""
    try:
        yield
    except SceneError as error:
        raise SceneFileError([FileProblem((), problem.message, file) for problem in error.problems]) from None
    except OSError as error:
        message = f"cannot be read ({error.strerror or error}); check its name and its permissions"
        raise SceneFileError([FileProblem((), message, file)]) from None


def _numbered(name: str, number: int) -> str:
    return name if number == 1 else f"{name} {number}"


def _shapes(parts: Sequence[ImportedPart]) -> list[Data]:
    return [METRES.shape(shape) for part in parts for shape in part.shapes]
