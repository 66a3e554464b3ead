"""MuJoCo's compiler in a process of its own: `compiled`.

It writes what it found as JSON: metres, kilograms, quaternions with the scalar first, joints where the model has them
at rest.
"""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from cagepose.errors import FileProblem, SceneError, SceneFileError
from cagepose.files.own_process import answer, ask

CPU_SECONDS, WALL_SECONDS = 8, 60.0
"""Limits of the process."""
SURFACES = ("plane", "sphere", "capsule", "cylinder", "box", "mesh")
"""Kinds of geoms that are passed on; others only by name."""


def compiled(source: str) -> dict[str, Any]:
    """Return the bodies and geoms of a model.

    Raises
    ------
    SceneFileError
        The compiler refuses the model, or takes too long.
    """
    try:
        found: dict[str, Any] = json.loads(
            ask(__name__, os.fsencode(os.path.abspath(source)), WALL_SECONDS, "MuJoCo's compiler")
        )
    except SceneError as error:
        raise SceneFileError([FileProblem((), problem.message, source) for problem in error.problems]) from None
    return found


def compiled_here(source: str) -> dict[str, Any]:
    """As `compiled`, in this process.

    Raises
    ------
    ValueError
        The compiler refuses the model.
    """
    import mujoco

    try:
        spec = mujoco.MjSpec.from_file(source)
        spec.compiler.fusestatic = False  # links keep their names
        model = spec.compile()
    except (ValueError, RuntimeError) as error:
        said = " ".join(str(error).split())[-300:]
        raise ValueError(f"is refused by MuJoCo's compiler: {said}") from error
    return _document(mujoco, model)


def _document(mujoco: Any, model: Any) -> dict[str, Any]:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    kinds = {int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")): kind for kind in SURFACES}
    free = {int(model.jnt_bodyid[i]) for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_FREE}
    jointed = {int(body) for body in model.jnt_bodyid}
    bodies = [
        {
            "name": model.body(body).name,
            "parent": int(model.body_parentid[body]),
            "is_free": body in free,
            "is_jointed": body in jointed,
            "position": data.xpos[body].tolist(),
            "quaternion": data.xquat[body].tolist(),
            "mass": float(model.body_mass[body]),
            "center": model.body_ipos[body].tolist(),
            "inertia": _inertia(mujoco, model, body),
        }
        for body in range(model.nbody)
    ]
    geoms = [_geom(model, geom, kinds) for geom in range(model.ngeom)]
    for kind, found in (("body", bodies), ("geom", geoms)):
        for number, one in enumerate(found):
            if not np.isfinite([*one["position"], *one["quaternion"]]).all():
                which = repr(one["name"]) if one["name"] else str(number)
                raise ValueError(f"has a {kind}, {which}, at a place that is no number; correct it")
    return {"bodies": bodies, "geoms": geoms, "gravity": model.opt.gravity.tolist()}


def _inertia(mujoco: Any, model: Any, body: int) -> list[list[float]]:
    """Return the inertia about the centre of gravity in the body's axes."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    axes = turn.reshape(3, 3)
    found = axes @ np.diag(model.body_inertia[body]) @ axes.T
    rows: list[list[float]] = ((found + found.T) / 2.0).tolist()
    return rows


def _geom(model: Any, geom: int, kinds: dict[int, str]) -> dict[str, Any]:
    found = {
        "name": model.geom(geom).name,
        "body": int(model.geom_bodyid[geom]),
        "kind": kinds.get(int(model.geom_type[geom]), "other"),
        "touches": bool(model.geom_contype[geom] or model.geom_conaffinity[geom]),
        "size": model.geom_size[geom].tolist(),
        "position": model.geom_pos[geom].tolist(),
        "quaternion": model.geom_quat[geom].tolist(),
        "friction": 0.0 if model.geom_condim[geom] == 1 else float(model.geom_friction[geom, 0]),
        "priority": int(model.geom_priority[geom]),
    }
    mesh = int(model.geom_dataid[geom])
    if found["kind"] == "mesh" and mesh >= 0:
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        vertices = model.mesh_vert[first : first + count].astype(np.float64)
        faces = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
        found["vertices"] = vertices[_corners_of_hull(model, mesh, count)].tolist()
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
    answer(lambda source: json.dumps(compiled_here(os.fsdecode(source))).encode(), CPU_SECONDS)
