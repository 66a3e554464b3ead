"""Bodies of a model as the data of a scene file: `model_document`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from cagepose.errors import FileProblem, SceneFileError
from cagepose.exchange.beside import SETTINGS, read_beside, spoilt
from cagepose.exchange.compile_model import compiled
from cagepose.exchange.extra import mujoco
from cagepose.exchange.model_bodies import WORLD_BODY, ModelBodies
from cagepose.exchange.model_contacts import ModelContacts
from cagepose.exchange.model_friction import scene_friction
from cagepose.exchange.model_measures import mesh_triangles
from cagepose.exchange.model_names import name_them
from cagepose.exchange.model_overlaps import freed
from cagepose.exchange.model_parts import ModelSource
from cagepose.exchange.model_root import short_path
from cagepose.exchange.model_shapes import LEFT_OUT, GeomShapes, reach_m
from cagepose.exchange.model_text import ModelText, read_model_text
from cagepose.exchange.solids_document import METRES, kept_friction
from cagepose.exchange.source_solids import SOLIDS
from cagepose.model.pose import Pose
from cagepose.model.wording import few

Data = dict[str, Any]
"""What is known of a geom, or of a part of a scene file."""

OBJECT = "object"
"""The object's body in files that we write."""
MOST_GEOMS = 2_000
"""Of the object and the cage together: all pairs of them are looked at."""
SHOWN = 12
"""So many names in a note."""


class Chosen(NamedTuple):
    """What of a model is asked for.

    Attributes
    ----------
    object_name, cage_names
        The body that is held, None: the only one that moves freely; and what holds it, none: all others.
    root
        The folder under which the model's files lie; None: its own.
    keyframe, qpos
        Where its joints are, see `cagepose.exchange.model_pose.set_pose`.
    """

    object_name: str | None = None
    cage_names: Sequence[str] = ()
    root: str | None = None
    keyframe: str | None = None
    qpos: str | None = None


class ModelData(NamedTuple):
    """The data of a scene, what is not in it as in the model, in sentences, and what of the model is in it."""

    document: Data
    notes: list[str]
    source: ModelSource


def model_document(source: str, chosen: Chosen) -> ModelData:
    """Return the data of a scene of bodies.

    Raises
    ------
    SceneFileError
        A model that cannot be used, or bodies that it does not have.
    MissingExtraError
        There is no MuJoCo.
    """
    mujoco()
    text = read_model_text(source, SOLIDS, chosen.root)
    kept = _beside(text)
    beside = read_beside(kept) if kept else {}
    told = [] if beside is not None else [spoilt(Path(source).name)]
    found = compiled(text, source, chosen.keyframe, chosen.qpos)
    reader = _Reader(source, found, beside or {}, text, with_hulls=not text.is_urdf)
    data = reader.document(chosen.object_name, chosen.cage_names)
    if text.is_urdf and (problem := reader.problem):
        reader = _Reader(source, found, beside or {}, text, with_hulls=True)
        data = reader.document(chosen.object_name, chosen.cage_names)
        told.append(f"meshes are their hulls here: of the meshes themselves, one {problem}")
    return ModelData(data, told + reader.notes, reader.in_scene)


def _beside(text: ModelText) -> str:
    """Return what `cagepose export` kept beside the bodies; nothing, of other files."""
    if text.is_urdf:
        return text.root.findtext("cagepose") or ""
    kept = text.root.find("custom/text[@name='cagepose']")
    return "" if kept is None else kept.get("data") or ""


class _Reader:
    def __init__(self, source: str, compiled: Data, beside: Data, text: ModelText, *, with_hulls: bool) -> None:
        self.source, self.beside, self.text = source, beside, text
        self.notes = list[str]()
        self.problem: str | None = None  # why what `document` returned is no scene
        self.in_scene: ModelSource  # what `document` took of the model
        self.bodies, self.contacts = ModelBodies(source, compiled), ModelContacts(compiled)
        meshes = {name: mesh_triangles(mesh) for name, mesh in compiled["meshes"].items()}
        self.shapes = GeomShapes(self.notes, None if with_hulls else text.files, meshes)
        self.hulls: list[str] = compiled["hulls"]
        self.impossible: list[str] = compiled["inertia"]

    def document(self, object_name: str | None, cage_names: Sequence[str]) -> Data:
        """Return the scene file's data."""
        bodies, beside = self.bodies, self.beside
        if object_name is None and "planar" in beside:
            object_name = OBJECT  # of our own files; slides and a hinge hold it
        held = bodies.free() if object_name is None else bodies.named(object_name)
        of_object = bodies.below([held])
        of_cage = bodies.below([bodies.named(name) for name in cage_names] or [WORLD_BODY]) - of_object
        self.note_bodies(of_object, of_cage, held)
        parts, walls = self.touching(of_object, of_cage)
        left_out = list[str](beside.get("left_out", ()))
        parts, walls = (self.shapes.known(geoms, left_out) for geoms in (parts, walls))
        if not (parts and walls):
            self.refuse_nothing(of_object, of_cage, bool(left_out))
        unknown = [geom["label"] for geom in (*parts, *walls) if geom["measures"] is None and geom["kind"] != "plane"]
        if unknown:
            self.notes.append(f"not compared with what they are here, as MuJoCo measures no volume: {few(unknown)}")
        self.in_scene = ModelSource(bodies, held, parts, walls, self.shapes.meshes, self.shapes.off_m)
        found: Data = {"name": beside.get("name") or Path(self.source).stem, "units": {"length": "m"}}
        of_part = [shape for geom in parts for shape in self.shapes.shapes(geom, self.place(geom, held), parts)]
        reach = max(map(reach_m, of_part), default=0.0)
        found["object"] = {"shapes": of_part, **self.inertial(of_object, held), "pose": METRES.pose(bodies.pose(held))}
        found["cage"] = self.cage(walls, of_cage, held, reach)
        found["loads"] = self.loads()
        found, inside, notes, self.problem = freed(found, reach, self.source)
        self.notes += notes
        found |= self.friction(parts, [geom for geom in walls if geom["label"] not in inside])
        if left_out + inside:
            found["left_out"] = left_out + inside
        return found | {key: beside[key] for key in SETTINGS if key in beside}

    def refuse_nothing(self, of_object: set[int], of_cage: set[int], is_unknown: bool) -> None:
        """
        Raises
        ------
        SceneFileError
            There is no object or no cage, and why.
        """
        there, remedy = self.bodies.with_geoms(), "choose other bodies with --object and --cage"
        if is_unknown:
            message = f"has nothing that touches but {self.notes[-1].removeprefix(LEFT_OUT)}"
        elif len(there) == 1:
            meshes = list(self.text.files.values())
            remedy = "add that to the model"
            if len(meshes) == 1:
                files = f"--object {short_path(meshes[0])} --cage FILE"
                remedy = f"join its mesh with that, one as the object: cagepose import {files}"
            message = f"has one body alone, and nothing that holds it; {remedy}"
        elif there & of_object and there & of_cage:
            message = f"lets no shape of the object touch one of the cage (by types, exclusions, parents); {remedy}"
        else:
            message = (
                f"has nothing that touches in what is {'the cage' if there & of_object else 'the object'}; {remedy}"
            )
        raise SceneFileError([FileProblem((), message, self.source)])

    def note_bodies(self, of_object: set[int], of_cage: set[int], held: int) -> None:
        bodies = self.bodies
        for what, names in (
            ("joints stay where the model has them, of", bodies.jointed(of_object - {held})),
            ("bodies of the cage that no phase drives stand still:", bodies.jointed(of_cage)),
            ("bodies left out:", bodies.others(of_object | of_cage)),
        ):
            if names:
                self.notes.append(f"{what} {few(names, SHOWN)}")
        impossible = [name for name in self.impossible if name in map(bodies.name, of_object)]
        if impossible:
            self.notes.append(f"the moments of inertia of {few(impossible)} are none of any body: here, their mean")

    def touching(self, of_object: set[int], of_cage: set[int]) -> tuple[list[Data], list[Data]]:
        """Return the geoms of the object and of the cage that can touch one of the other, with labels."""
        geoms = self.bodies.geoms
        parts, walls = ([geom for geom in geoms if geom["body"] in those] for those in (of_object, of_cage))
        if len(parts) + len(walls) > MOST_GEOMS:
            message = (
                f"has {len(parts) + len(walls):,} shapes in object and cage; choose at most {MOST_GEOMS:,} with --cage"
            )
            raise SceneFileError([FileProblem((), message, self.source)])
        pairs = self.contacts.touching(parts, walls)
        seen = {number for pair in pairs for number in pair}
        name_them([geom for geom in (*parts, *walls) if geom["number"] in seen], self.bodies, of_cage)
        for found, other in ((parts, "the cage"), (walls, "the object")):
            unseen = [geom["name"] for geom in found if geom["number"] not in seen and geom["name"]]
            if unseen:
                self.notes.append(f"left out, as in the model they do not touch {other}: {few(unseen)}")
        parts, walls = ([geom for geom in found if geom["number"] in seen] for found in (parts, walls))
        partly = [
            wall["label"] for wall in walls if any((part["number"], wall["number"]) not in pairs for part in parts)
        ]
        if partly:
            self.notes.append(f"in the model, {few(partly)} touch some parts of the object only: here, all")
        return parts, walls

    def cage(self, walls: Sequence[Data], of_cage: set[int], held: int, reach: float) -> Data:
        """Return what stands still, and each body that a joint moves by its name."""
        movers = {geom["number"]: self.bodies.mover(geom["body"], of_cage) for geom in walls}
        standing = [geom for geom in walls if movers[geom["number"]] is None]
        with_geoms = {geom["body"] for geom in standing}
        frame = with_geoms.pop() if len(with_geoms) == 1 else WORLD_BODY
        listed = self.beside.get("points", ())
        points = [geom for geom in standing if geom["kind"] == "sphere" and geom["label"] in listed]
        shapes = [geom for geom in standing if geom not in points]
        found: Data = {
            "points": {geom["label"]: self.place(geom, frame).position_m.tolist() for geom in points},
            "shapes": [shape for geom in shapes for shape in self.wall(geom, frame, held, reach, shapes)],
            "bodies": {},
        }
        for mover in dict.fromkeys(body for body in movers.values() if body is not None):
            own = [geom for geom in walls if movers[geom["number"]] == mover]
            found["bodies"][self.bodies.name(mover)] = {
                "shapes": [shape for geom in own for shape in self.wall(geom, mover, held, reach, own)],
                "pose": METRES.pose(self.bodies.in_frame(mover, Pose(), frame)),
            }
        found = {key: value for key, value in found.items() if value}
        return found | {"pose": METRES.pose(self.bodies.pose(frame))}

    def wall(self, geom: Data, frame: int, held: int, reach: float, beside: Sequence[Data]) -> list[Data]:
        place = self.place(geom, frame)
        if geom["kind"] == "plane":
            return [self.shapes.plane(geom, place, self.bodies.in_frame(held, Pose(), frame).position_m, reach)]
        return self.shapes.shapes(geom, place, beside)

    def place(self, geom: Data, frame: int) -> Pose:
        return self.bodies.in_frame(geom["body"], Pose(geom["position"], geom["quaternion"]), frame)

    def inertial(self, of_object: set[int], frame: int) -> Data:
        found = self.bodies.inertial(of_object, frame)
        if found is None:
            self.notes.append("the object has no mass there: here, uniform density")
            return {}
        opened = [
            geom.get("label") or geom["name"]
            for geom in self.bodies.geoms
            if geom["body"] in of_object and geom.get("mesh") in self.hulls
        ]
        if opened:
            self.notes.append(
                f"no volume is within the mesh of {few(dict.fromkeys(opened))}; where mass, centre of gravity and"
                " inertia come from it, they are those of its hull"
            )
        center = {"center_of_gravity": found.center_m.tolist()}
        if not self.beside.get("has_mass", True):
            return center
        return {**center, "mass": found.mass_kg, "inertia": found.inertia_kg_m2.tolist()}

    def loads(self) -> list[Data]:
        if "loads" in self.beside:
            return list(self.beside["loads"])
        gravity = self.bodies.gravity if any(self.bodies.gravity) else [0.0, 0.0, -9.81]
        self.notes.append(f"loads: the weight alone, with a gravity of ({', '.join(f'{g:g}' for g in gravity)}) m/s^2")
        return [{"name": "weight", "gravity": gravity}]

    def friction(self, parts: Sequence[Data], walls: Sequence[Data]) -> Data:
        if "friction" in self.beside:
            return kept_friction(self.beside, [geom["label"] for geom in (*parts, *walls)])
        if self.text.is_urdf:
            self.notes.append("friction: none, as URDF has none")
            return {}
        plain, of, uneven = scene_friction(*({geom["label"]: geom for geom in geoms} for geoms in (parts, walls)))
        if uneven:
            self.notes.append(f"friction of {few(uneven)} differs from part to part of the object: here, the greatest")
        return {"friction": {"coefficient": plain, **({"of": of} if of else {})}} if plain or of else {}
