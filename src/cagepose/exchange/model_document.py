"""Bodies of a compiled model as the data of a scene file: `model_document`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.errors import FileProblem, SceneFileError
from cagepose.exchange.beside import read_beside, spoilt
from cagepose.exchange.compile_model import compiled
from cagepose.exchange.extra import mujoco
from cagepose.exchange.model_bodies import WORLD_BODY, ModelBodies
from cagepose.exchange.model_friction import scene_friction
from cagepose.exchange.model_text import ModelText, read_model_text
from cagepose.exchange.solids_document import METRES, SOLIDS, kept_friction
from cagepose.exchange.tolerances import VOLUME_NOT_CONVEX
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.pieces import MOST_CORNERS
from cagepose.files.triples import text_of
from cagepose.model.pose import Pose
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex
from cagepose.model.wording import few

Data = dict[str, Any]
"""What is known of a geom, or of a part of a scene file."""

PLANE_OF_REACH = 20.0
"""Width of the box that stands for a plane, in distances of the object's farthest point: no plane of MuJoCo ends."""


def model_document(source: str, object_name: str | None, cage_names: Sequence[str]) -> tuple[Data, list[str]]:
    """Return the data of a scene of bodies, and what is not in it as in the model."""
    mujoco()
    text = read_model_text(source, SOLIDS)
    kept, notes = _beside(text), list[str]()
    beside = read_beside(kept) if kept else {}
    if beside is None:
        notes.append(spoilt(Path(source).name))
    reader = _Reader(source, ModelBodies(source, compiled(source)), beside or {}, notes, is_urdf=text.is_urdf)
    return reader.document(object_name, cage_names), notes


def _beside(text: ModelText) -> str:
    """Return what `cagepose export` kept beside the bodies; nothing, of other files."""
    if text.is_urdf:
        return text.root.findtext("cagepose") or ""
    kept = text.root.find("custom/text[@name='cagepose']")
    return "" if kept is None else kept.get("data") or ""


class _Reader:
    def __init__(self, source: str, bodies: ModelBodies, beside: Data, notes: list[str], *, is_urdf: bool) -> None:
        self.source, self.bodies, self.beside, self.notes, self.is_urdf = source, bodies, beside, notes, is_urdf

    def document(self, object_name: str | None, cage_names: Sequence[str]) -> Data:
        """Return the scene file's data."""
        bodies, beside = self.bodies, self.beside
        held = bodies.free() if object_name is None else bodies.named(object_name)
        of_object = bodies.below([held])
        of_cage = bodies.below([bodies.named(name) for name in cage_names] or [WORLD_BODY]) - of_object
        for what, names in (
            ("joints stay where the model has them, of", bodies.jointed((of_object | of_cage) - {held})),
            ("bodies left out:", bodies.others(of_object | of_cage)),
        ):
            if names:
                self.notes.append(f"{what} {few(names, 12)}")
        parts, walls = self.geoms(of_object), self.geoms(of_cage)
        name_them([*parts, *walls])
        with_geoms = {geom["body"] for geom in walls}
        frame = with_geoms.pop() if len(with_geoms) == 1 else WORLD_BODY
        shapes = [self.shape(geom, held, held, 0.0) for geom in parts]
        reach_m = max((_reach_m(shape) for shape in shapes if shape), default=0.0)
        points = {
            geom["label"]: self.place(geom, frame).position_m.tolist()
            for geom in walls
            if geom["kind"] == "sphere" and geom["label"] in beside.get("points", ())
        }
        others = [self.shape(geom, frame, held, reach_m) for geom in walls if geom["label"] not in points]
        found: Data = {"name": beside.get("name") or Path(self.source).stem, "units": {"length": "m"}}
        found["object"] = {"shapes": [shape for shape in shapes if shape], **self.inertial(of_object, held)}
        found["object"]["pose"] = METRES.pose(bodies.pose(held))
        found["cage"] = {"points": points, "shapes": [shape for shape in others if shape]}
        found["cage"] = {key: value for key, value in found["cage"].items() if value}
        found["cage"]["pose"] = METRES.pose(bodies.pose(frame))
        for body, what in ((found["object"], "the object"), (found["cage"], "the cage")):
            if not body.get("shapes") and not body.get("points"):
                message = f"has nothing that touches in what is {what}; choose other bodies with --object and --cage"
                raise SceneFileError([FileProblem((), message, self.source)])
        found |= {"loads": self.loads(), **self.friction(parts, walls)}
        return found | {key: beside[key] for key in ("method", "metric", "tolerances") if key in beside}

    def geoms(self, of_bodies: set[int]) -> list[Data]:
        """Return the geoms of bodies that touch anything."""
        found = [geom for geom in self.bodies.geoms if geom["body"] in of_bodies]
        unseen = [geom["name"] for geom in found if not geom["touches"] and geom["name"]]
        if unseen:
            self.notes.append(f"left out, as they touch nothing: {few(unseen)}")
        return [geom for geom in found if geom["touches"]]

    def place(self, geom: Data, frame: int) -> Pose:
        return self.bodies.in_frame(geom["body"], Pose(geom["position"], geom["quaternion"]), frame)

    def shape(self, geom: Data, frame: int, held: int, reach_m: float) -> Data | None:
        """Return a geom as a shape of a scene file in the frame of a body; None: it is left out."""
        label, place, size = geom["label"], self.place(geom, frame), geom["size"]
        if geom["kind"] == "box":
            numbers: Data = {"box": {"size": [2.0 * half for half in size]}}
        elif geom["kind"] == "sphere":
            numbers = {"sphere": {"radius": size[0]}}
        elif geom["kind"] in ("capsule", "cylinder"):
            numbers = {geom["kind"]: {"radius": size[0], "length": 2.0 * size[1]}}
        elif geom["kind"] == "plane":
            width_m = PLANE_OF_REACH * reach_m
            self.notes.append(f"{label!r} is a plane; here, a box {width_m:.3g} m wide under the object, its top there")
            x, y, _ = place.inverse_transform(self.bodies.in_frame(held, Pose(), frame).position_m).tolist()
            numbers, place = {"box": {"size": [width_m, width_m, reach_m]}}, place @ Pose((x, y, -reach_m / 2.0))
        elif "vertices" in geom:
            numbers = self.hull(geom, label)
        else:
            numbers = {}
            self.notes.append(f"left out: {label!r}, as it is neither box, ball, capsule, cylinder, plane nor mesh")
        return {"name": label, **numbers, **METRES.pose(place, turn=False)} if numbers else None

    def hull(self, geom: Data, label: str) -> Data:
        is_large = len(geom["vertices"]) > MOST_CORNERS
        whole = manifold3d().Manifold.hull_points(np.array(geom["vertices"])) if is_large else None
        full_m3 = shape_moments(Convex(geom["vertices"])).volume_m3 if whole is None else whole.volume()
        volume_m3 = abs(geom["volume"])
        if volume_m3 < (1.0 - VOLUME_NOT_CONVEX) * full_m3:
            share = 1.0 - volume_m3 / full_m3
            self.notes.append(f"the mesh {label!r} is not convex: here, its hull, {share:.1%} of which is too much")
        if whole is None:
            return {"convex": {"vertices": geom["vertices"]}}
        mesh = Triangles.of(whole)
        return {"facets": {"vertices": text_of(mesh.vertices.tolist()), "triangles": text_of(mesh.faces.tolist())}}

    def inertial(self, of_object: set[int], frame: int) -> Data:
        found = self.bodies.inertial(of_object, frame)
        if found is None:
            self.notes.append("the object has no mass there: here, uniform density")
            return {}
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
        if self.is_urdf:
            self.notes.append("friction: none, as URDF has none")
            return {}
        plain, of, uneven = scene_friction(*({geom["label"]: geom for geom in geoms} for geoms in (parts, walls)))
        if uneven:
            self.notes.append(f"friction of {few(uneven)} differs from part to part of the object: here, the greatest")
        return {"friction": {"coefficient": plain, **({"of": of} if of else {})}} if plain or of else {}


def name_them(geoms: Sequence[Data]) -> None:
    """Give each geom its ``label``: its name, without that of its body before it unless two would be one then."""
    counts = Counter(geom["name"].partition("/")[2] or geom["name"] for geom in geoms)
    for number, geom in enumerate(geoms):
        short = geom["name"].partition("/")[2] or geom["name"]
        geom["label"] = (short if counts[short] == 1 else geom["name"]) or f"geom {number + 1}"


def _reach_m(shape: Data) -> float:
    """Return a bound on how far a shape is from its body's origin, metres."""
    numbers = next(value for key, value in shape.items() if isinstance(value, dict))
    spans = [float(np.abs(value).sum()) for value in numbers.values()]
    return float(np.linalg.norm(shape["position"])) + sum(spans)
