"""MuJoCo's compiler in a process of its own: `compiled`.

It writes what it found as JSON: metres, kilograms, quaternions with the scalar first, joints where they were asked for.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.errors import SceneError, SceneFileError
from cagepose.exchange.model_measures import geom_measures, mesh_arrays, mesh_text, subtree_weight
from cagepose.exchange.model_pose import set_pose
from cagepose.exchange.model_text import ModelText
from cagepose.files.own_process import answer, ask

CPU_SECONDS, WALL_SECONDS = 8, 60.0
"""Limits of the process."""
KINDS = ("plane", "sphere", "capsule", "cylinder", "box", "mesh", "ellipsoid", "hfield", "sdf")
FLAT = "flat mesh"
"""What a geom is whose mesh has no volume."""
FLAT_MARK = "\x1fflat"
"""At the end of the name of a geom whose mesh has no volume: such a character no name in XML can have."""
NAMED_MESH = (re.compile(r"[Mm]esh '([^']*)'"), re.compile(r"(?:mesh|vertices)[\s\S]*Element name '([^']*)'"))
"""How MuJoCo says which mesh it refuses."""
SAYS_FLAT = ("coplanar vertices", "at least 4 vertices")
"""How it says that a mesh is flat."""
IMPOSSIBLE_INERTIA = re.compile(r"(?:A \+ B >= C|positive eigenvalues)[\s\S]*Element name '([^']*)'")
"""How it says whose moments of inertia no body can have."""
MOST_REPAIRS = 100
"""A model is compiled so often at most, with something changed that was refused."""
SMALL_M = 1e-3
"""Radius of a ball that has the mass of a mesh without volume."""
LEAST_MASS_KG = 1e-9
"""What a body weighs that has no mass, where MuJoCo wants one."""
SAID = 300
"""Characters of what MuJoCo says, its last."""


def compiled(model: ModelText, source: str, keyframe: str | None = None, qpos: str | None = None) -> dict[str, Any]:
    """Return the bodies and geoms of a model.

    Parameters
    ----------
    model, source
        It, and its name in messages.
    keyframe, qpos
        Where its joints are, as `set_pose` takes them.

    Raises
    ------
    SceneFileError
        The compiler refuses the model, or takes too long.
    """
    asked = {"text": model.lines.text, "files": model.files, "keyframe": keyframe, "qpos": qpos}
    try:
        found: dict[str, Any] = json.loads(ask(__name__, json.dumps(asked).encode(), WALL_SECONDS, "MuJoCo's compiler"))
    except SceneError as error:
        raise SceneFileError([model.lines.problem(problem.message, source) for problem in error.problems]) from None
    return found


def compiled_here(asked: dict[str, Any]) -> dict[str, Any]:
    """As `compiled`, in this process, of what that asks for.

    Raises
    ------
    ValueError
        The compiler refuses the model, or it has no such pose.
    """
    import mujoco

    repairs: dict[str, list[str]] = {"hulls": [], "inertia": []}
    try:
        files = {name: Path(path).read_bytes() for name, path in asked["files"].items()}
        spec = mujoco.MjSpec.from_string(asked["text"], assets=files)
        spec.compiler.fusestatic = False  # links keep their names
        model = _repaired(mujoco, spec, repairs)
    except (ValueError, RuntimeError) as error:
        said = " ".join(str(error).split())[-SAID:]
        raise ValueError(f"is refused by MuJoCo's compiler: {said}") from error
    data = mujoco.MjData(model)
    set_pose(mujoco, model, data, asked["keyframe"], asked["qpos"])
    return {**_document(mujoco, model, data), **repairs}


def _repaired(mujoco: Any, spec: Any, repairs: dict[str, list[str]]) -> Any:
    """Return the compiled model, with what MuJoCo refuses of masses and meshes changed, and told in ``repairs``."""
    for _ in range(MOST_REPAIRS):
        try:
            model = spec.compile()
        except ValueError as error:
            if not _change(mujoco, spec, str(error), repairs):
                raise
            continue
        opened = [mesh.name for mesh in spec.meshes if _takes_volume(mujoco, mesh) and not _is_closed(model, mesh.name)]
        if not opened:
            return model
        for name in opened:
            spec.mesh(name).inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            repairs["hulls"].append(name)
    return spec.compile()


def _change(mujoco: Any, spec: Any, said: str, repairs: dict[str, list[str]]) -> bool:
    """Change what MuJoCo complains of; whether that is known."""
    if (found := IMPOSSIBLE_INERTIA.search(said)) and (body := spec.body(found[1])) is not None:
        moments = np.array(body.fullinertia[:3] if np.isfinite(body.fullinertia[0]) else body.inertia)
        body.fullinertia, body.inertia = np.full(6, np.nan), np.full(3, max(np.abs(moments).mean(), LEAST_MASS_KG))
        repairs["inertia"].append(found[1])
        return True
    if "mass and inertia of moving bodies" in said and not spec.compiler.boundmass:
        spec.compiler.boundmass = spec.compiler.boundinertia = LEAST_MASS_KG
        return True
    named = next((found[1] for pattern in NAMED_MESH if (found := pattern.search(said))), None)
    mesh = None if named is None else spec.mesh(named)
    if named is None or mesh is None:
        return False
    if not any(words in said for words in SAYS_FLAT) and _takes_volume(mujoco, mesh):
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
        repairs["hulls"].append(named)
        return True
    geoms = [geom for geom in spec.geoms if geom.meshname == named]
    for number, geom in enumerate(geoms):
        geom.name = f"{geom.name or f'{named} {number + 1}'}{FLAT_MARK}"
        geom.meshname, geom.type, geom.size = "", mujoco.mjtGeom.mjGEOM_SPHERE, [SMALL_M, 0.0, 0.0]
        geom.mass = geom.mass if np.isfinite(geom.mass) else 0.0
    spec.delete(mesh)
    return True


def _takes_volume(mujoco: Any, mesh: Any) -> bool:
    kinds = mujoco.mjtMeshInertia
    return mesh.inertia not in (kinds.mjMESH_INERTIA_CONVEX, kinds.mjMESH_INERTIA_SHELL)


def _is_closed(model: Any, name: str) -> bool:
    """Whether each side of a mesh's triangles is one of another, the other way round."""
    mesh = model.mesh(name).id
    faces = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]].astype(np.int64)
    first = int(model.mesh_vertadr[mesh])
    points = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
    _, same = np.unique(points, axis=0, return_inverse=True)  # corners that STL repeats
    corners = same.reshape(-1)[faces]
    sides = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    sides = sides[sides[:, 0] != sides[:, 1]]
    there, back = sides @ [len(points), 1], sides @ [1, len(points)]
    return np.array_equal(np.sort(there), np.sort(back))


def _document(mujoco: Any, model: Any, data: Any) -> dict[str, Any]:
    kinds = {int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")): kind for kind in KINDS}
    free = {int(model.jnt_bodyid[i]) for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_FREE}
    jointed = {int(body) for body in model.jnt_bodyid}
    mujoco.mj_crb(model, data)
    bodies = [
        {
            "name": model.body(body).name,
            "parent": int(model.body_parentid[body]),
            "weld": int(model.body_weldid[body]),
            "is_free": body in free,
            "is_jointed": body in jointed,
            "position": data.xpos[body].tolist(),
            "quaternion": data.xquat[body].tolist(),
            "mass": float(model.body_mass[body]) if model.body_mass[body] > 2.0 * LEAST_MASS_KG else 0.0,
            "center": model.body_ipos[body].tolist(),
            "inertia": _inertia(mujoco, model, body),
            "subtree": subtree_weight(model, data, body),
        }
        for body in range(model.nbody)
    ]
    closed = {mesh: _is_closed(model, model.mesh(mesh).name) for mesh in range(model.nmesh)}
    measured = geom_measures(mujoco, model, closed)
    geoms = [
        {"number": geom, **_geom(model, geom, kinds, closed), "measures": measures}
        for geom, measures in enumerate(measured)
    ]
    for kind, found in (("body", bodies), ("geom", geoms)):
        for number, one in enumerate(found):
            if not np.isfinite([*one["position"], *one["quaternion"]]).all():
                which = repr(one["name"]) if one["name"] else str(number)
                raise ValueError(f"has a {kind}, {which}, at a place that is no number; correct it")
    filters_parents = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    return {
        "bodies": bodies,
        "geoms": geoms,
        "meshes": {model.mesh(mesh).name: mesh_text(model, mesh) for mesh in range(model.nmesh)},
        "gravity": model.opt.gravity.tolist(),
        "filters_parents": bool(filters_parents),
        "excluded": [[int(one) >> 16, int(one) & 0xFFFF] for one in model.exclude_signature],
        "pairs": [[int(model.pair_geom1[i]), int(model.pair_geom2[i])] for i in range(model.npair)],
    }


def _inertia(mujoco: Any, model: Any, body: int) -> list[list[float]]:
    """Return the inertia about the centre of gravity in the body's axes."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    axes = turn.reshape(3, 3)
    found = axes @ np.diag(model.body_inertia[body]) @ axes.T
    rows: list[list[float]] = ((found + found.T) / 2.0).tolist()
    return rows


def _geom(model: Any, geom: int, kinds: dict[int, str], closed: dict[int, bool]) -> dict[str, Any]:
    name, is_flat, _ = model.geom(geom).name.partition(FLAT_MARK)
    found = {
        "name": name,
        "body": int(model.geom_bodyid[geom]),
        "kind": FLAT if is_flat else kinds.get(int(model.geom_type[geom]), "other"),
        "contype": int(model.geom_contype[geom]),
        "conaffinity": int(model.geom_conaffinity[geom]),
        "size": model.geom_size[geom].tolist(),
        "position": model.geom_pos[geom].tolist(),
        "quaternion": model.geom_quat[geom].tolist(),
        "friction": 0.0 if model.geom_condim[geom] == 1 else float(model.geom_friction[geom, 0]),
        "priority": int(model.geom_priority[geom]),
    }
    mesh = int(model.geom_dataid[geom])
    if found["kind"] == "mesh" and mesh >= 0:
        corners, faces = mesh_arrays(model, mesh)
        vertices = corners.astype(np.float64)
        path = int(model.mesh_pathadr[mesh])
        found["mesh"] = model.mesh(mesh).name
        found["file"] = None if path < 0 else model.paths[path:].partition(b"\0")[0].decode()
        found["scale"] = model.mesh_scale[mesh].tolist()
        found["mesh_position"], found["mesh_quaternion"] = model.mesh_pos[mesh].tolist(), model.mesh_quat[mesh].tolist()
        found["is_closed"] = closed[mesh]
        found["vertices"] = vertices[_corners_of_hull(model, mesh, len(vertices))].tolist()
        a, b, c = np.moveaxis(vertices[faces], 1, 0)
        found["volume"] = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
    return found


def _corners_of_hull(model: Any, mesh: int, count: int) -> Any:
    """Return which vertices of a mesh are corners of its hull: MuJoCo keeps them where it needs the hull."""
    start = int(model.mesh_graphadr[mesh])
    if start < 0:
        return np.arange(count)
    n_corners = int(model.mesh_graph[start])
    return model.mesh_graph[start + 2 + n_corners : start + 2 + 2 * n_corners]


if __name__ == "__main__":
    answer(lambda asked: json.dumps(compiled_here(json.loads(asked))).encode(), CPU_SECONDS)
