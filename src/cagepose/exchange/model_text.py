"""A model as MuJoCo's compiler may have it: `read_model_text`. What could do harm is refused before that sees it.

All that it includes is in one text, and all meshes are files that were found, by names of ours. What is only seen is
not in it, nor what moves or measures bodies, which older models have in words that MuJoCo no longer knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

from cagepose.errors import FileProblem, SceneFileError
from cagepose.exchange.model_root import ModelRoot
from cagepose.exchange.model_xml import LineText, Places, parsed
from cagepose.files.read import MAX_FILE_BYTES

MAX_MESH_BYTES = 64 * 1024 * 1024
"""All files that a model names have at most so many bytes together."""
SUFFIXES = (".xml", ".urdf")
MOST_NESTED = 200
"""Elements within elements: more, a compiler that calls itself for each may not bear."""
MESH_SUFFIXES = (".obj", ".stl", ".msh")
"""What MuJoCo reads as a mesh."""
FOLDERS = ("meshdir", "texturedir", "assetdir")
NOT_BODIES = {
    "mujoco": (
        *("texture", "material", "skin", "visual"),
        *("size", "statistic", "sensor", "actuator", "tendon", "equality"),
    ),
    "robot": ("visual", "material", "gazebo", "transmission"),
}
"""Elements without which bodies stay what they are, by root."""
NOT_OF_BODIES = ("material", "texture")
"""Attributes of that kind."""
TAKEN = {"option": ("gravity",), "flag": ("filterparent",), "key": ("name", "time", "qpos", "mpos", "mquat")}
"""All attributes that count, of some elements of MJCF."""
WORLD = "world"
XACRO = "is xacro, whose macros only ROS's own program expands; run: xacro FILE > robot.urdf, and give that"
ATTACHED = "attaches the model {!r}, which import does not read; write both as one file (MuJoCo: MjSpec.to_xml)"


class ModelText(NamedTuple):
    """A model that may be compiled.

    Attributes
    ----------
    root
        Its root element, with all that it includes.
    is_urdf
        Else it is MJCF.
    lines
        What the compiler gets.
    files
        The files that it may read, by the names that they have there.
    """

    root: Element
    is_urdf: bool
    lines: LineText
    files: dict[str, str]


def read_model_text(source: str, others: Sequence[str] = (), root: str | None = None) -> ModelText:
    """Read and check a model and what it includes.

    Parameters
    ----------
    source
        The file.
    others
        What suffixes files may have that are read elsewhere.
    root
        The folder under which its files lie; None: its own.

    Raises
    ------
    SceneFileError
        It cannot be read, is no MJCF or URDF, declares entities, names a file outside of its folder or none, or is too
        large.
    """
    suffix = Path(source).suffix
    if suffix.lower() == ".xacro":
        raise SceneFileError([FileProblem((), XACRO, source)])
    if suffix.lower() not in SUFFIXES:
        message = f"has the suffix {suffix!r}; give a file of one of: {', '.join((*SUFFIXES, *others))}"
        raise SceneFileError([FileProblem((), message, source)])
    return _Reading(source, root).text()


class _Reading:
    def __init__(self, source: str, root: str | None) -> None:
        self.source = source
        self.folder, self.places = Path(source).parent, Places()
        self.model = parsed(Path(source), source, self.places)
        if self.model.tag not in NOT_BODIES:
            message = f"is XML with the root <{self.model.tag}>; give MJCF (<mujoco>) or URDF (<robot>)"
            raise SceneFileError([FileProblem((), message, source)])
        self.is_urdf = self.model.tag == "robot"
        self.root = ModelRoot(source, root)
        self.n_bytes, self.included = 0, {Path(source).resolve()}
        self.n_text = Path(source).stat().st_size
        self.files: dict[str, str] = {}
        self.names: dict[tuple[str, ...], str] = {}

    def text(self) -> ModelText:
        self.include(self.model, 1)
        self.leave_bodies()
        if self.is_urdf:
            self.add_world()
            self.name_urdf_files()
        else:
            self.name_mjcf_files()
        lines = LineText.of(self.model, self.places)
        return ModelText(self.model, self.is_urdf, lines, self.files)

    def include(self, above: Element, depth: int) -> None:
        """Put what is included in the place of what includes it."""
        if depth > MOST_NESTED:
            raise self.refused(f"has elements that are nested deeper than {MOST_NESTED}; make it flat", above)
        found = list[Element]()
        for element in above:
            if element.tag == "include":
                found += self.included_by(element, depth)
            else:
                self.include(element, depth + 1)
                found.append(element)
        above[:] = found

    def included_by(self, element: Element, depth: int) -> list[Element]:
        name = element.get("file") or ""
        written_in = Path(self.places[element].source).parent
        path = self.root.first([self.folder / name, written_in / name], name)
        if path in self.included:
            raise self.refused(f"includes {name!r} twice, or in itself; remove all but one", element)
        self.included.add(path)
        self.n_text += path.stat().st_size
        if self.n_text > MAX_FILE_BYTES:
            limit = f"{MAX_FILE_BYTES // 1024**2} MiB"
            raise self.refused(f"makes the model larger than {limit}, the size limit; put meshes into files", element)
        holder = parsed(path, str(path), self.places)
        self.include(holder, depth + 1)
        return list(holder)

    def leave_bodies(self) -> None:
        left, taken = NOT_BODIES[self.model.tag], {} if self.is_urdf else TAKEN
        for element in self.model.iter():
            expressions = self.is_urdf and any("$(" in value or "${" in value for value in element.attrib.values())
            if expressions or element.tag.startswith("xacro:"):
                raise self.refused(XACRO, element)
            element[:] = [child for child in element if child.tag not in left]
            wanted = taken.get(element.tag, element.attrib)
            for key in [key for key in element.attrib if key in NOT_OF_BODIES or key not in wanted]:
                del element.attrib[key]

    def name_mjcf_files(self) -> None:
        compilers = list(self.model.iter("compiler"))
        folder, strips = self.folder / self.mesh_folder(compilers), self.strips(compilers, default=False)
        for element in self.model.iter():
            name = element.get("file")
            if element.tag == "model" and name is not None:
                raise self.refused(ATTACHED.format(name), element)
            if name is None:
                continue
            path = self.root.first([folder / (Path(name).name if strips else name)], name)
            if element.tag in ("mesh", "hfield") and element.get("name") is None:
                element.set("name", Path(name).stem)
            element.set("file", self.file(path, name, element))

    def add_world(self) -> None:
        """Add the world as a link of a URDF that has joints to it without."""
        links = {link.get("name") for link in self.model.iter("link") if link.get("name")}
        if WORLD not in links and any(parent.get("link") == WORLD for parent in self.model.iter("parent")):
            self.model.insert(0, Element("link", {"name": WORLD}))

    def name_urdf_files(self) -> None:
        compilers = list(self.model.iter("compiler"))
        folder, strips = self.folder / self.mesh_folder(compilers), self.strips(compilers, default=True)
        for element in self.model.iter("mesh"):
            name = element.get("filename")
            if name is None:
                continue
            places = [*self.root.places(name), folder / (Path(name).name if strips else name)]
            path = self.root.first(places, name)
            element.set("filename", self.file(path, name, element, element.get("scale") or ""))

    def mesh_folder(self, compilers: Sequence[Element]) -> str:
        """Return the folder of meshes; what says so is taken away, as names are ours after that."""
        found = ""
        for element in compilers:
            for key in FOLDERS:
                name = element.attrib.pop(key, None)
                if name is not None:
                    self.root.inside(self.folder / name, name)
                    found = found if key == "texturedir" else name
        return found

    def strips(self, compilers: Sequence[Element], *, default: bool) -> bool:
        """Whether names lose their folders."""
        found = default
        for element in compilers:
            found = element.attrib.pop("strippath", str(found)).lower() == "true"
        return found

    def file(self, path: Path, name: str, element: Element, *more: str) -> str:
        """Return the name that a file has for the compiler."""
        suffix = path.suffix.lower()
        if element.tag == "mesh" and suffix not in MESH_SUFFIXES:
            kind = suffix or "a file without suffix"
            raise self.refused(f"names {name!r}, and MuJoCo reads no {kind}; convert it to STL or OBJ", element)
        key = (str(path), *more)
        if key not in self.names:
            self.count(path)
            self.names[key] = f"file{len(self.names) + 1}{suffix}"
            self.files[self.names[key]] = str(path)
        return self.names[key]

    def count(self, path: Path) -> None:
        self.n_bytes += path.stat().st_size
        if self.n_bytes > MAX_MESH_BYTES:
            message = f"names files of more than {MAX_MESH_BYTES // 1024**2} MiB; simplify the meshes"
            raise SceneFileError([FileProblem((), message, self.source)])

    def refused(self, message: str, element: Element) -> SceneFileError:
        return SceneFileError([FileProblem((), message, *self.places[element])])
