"""What MuJoCo says of a compiled model beside its bodies, metres and kilograms: volumes of geoms, triangles of meshes,
and what bodies that hang together weigh: `geom_measures`, `mesh_text`, `subtree_weight`.
"""

from __future__ import annotations

from base64 import b64decode, b64encode
from typing import Any

import numpy as np

from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray

Data = dict[str, Any]

SOLIDS = ("mjGEOM_SPHERE", "mjGEOM_CAPSULE", "mjGEOM_ELLIPSOID", "mjGEOM_CYLINDER", "mjGEOM_BOX", "mjGEOM_MESH")
"""Kinds of geoms that have a volume."""


def geom_measures(mujoco: Any, model: Any, closed: dict[int, bool]) -> list[Data | None]:
    """Return the ``volume`` of each geom, and in its frame the ``center`` of that and the ``gyration``, its inertia by
    volume about the center, (3, 3). None: it has none.

    MuJoCo measures whole bodies alone, with densities and masses of their own: so each geom is a body here, and its
    density makes its mass a few, which is as well in kilometres as in micrometres.

    Parameters
    ----------
    mujoco, model
        The library, and the model.
    closed
        Which meshes are: the volume of others is that of their hulls, as it is where MuJoCo weighs them.
    """
    kinds = [int(getattr(mujoco.mjtGeom, kind)) for kind in SOLIDS]
    solid = [geom for geom in range(model.ngeom) if model.geom_type[geom] in kinds and model.geom_rbound[geom] > 0.0]
    densities = {geom: float(model.geom_rbound[geom]) ** -3 for geom in solid}
    for may_be_exact in (True, False):
        try:
            measured = _spec_of(mujoco, model, densities, closed if may_be_exact else {}).compile()
            break
        except ValueError:  # a mesh that is closed and encloses nothing
            continue
    else:
        return [None] * model.ngeom
    found: list[Data | None] = [None] * model.ngeom
    for geom in solid:
        body = measured.body(f"{geom}").id
        mass = float(measured.body_mass[body])
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, measured.body_iquat[body])
        axes = turn.reshape(3, 3)
        gyration = axes @ np.diag(measured.body_inertia[body] / mass) @ axes.T
        center = measured.body_ipos[body].tolist()
        found[geom] = {"volume": mass / densities[geom], "center": center, "gyration": gyration.tolist()}
    return found


def _spec_of(mujoco: Any, model: Any, densities: dict[int, float], closed: dict[int, bool]) -> Any:
    """Return a model in which each geom that has a density is a body, called by its number."""
    spec, inertia, mesh_kind = mujoco.MjSpec(), mujoco.mjtMeshInertia, int(mujoco.mjtGeom.mjGEOM_MESH)
    meshes = {geom: int(model.geom_dataid[geom]) for geom in densities if model.geom_type[geom] == mesh_kind}
    for mesh in sorted(set(meshes.values())):
        vertices, faces = mesh_arrays(model, mesh)
        a, b, c = np.moveaxis(vertices.astype(np.float64)[faces], 1, 0)
        is_inside_out = float(np.einsum("ij,ij->", a, np.cross(b, c))) < 0.0
        added = spec.add_mesh(name=f"{mesh}")
        added.uservert, added.userface = vertices.ravel(), (faces[:, ::-1] if is_inside_out else faces).ravel()
        added.inertia = inertia.mjMESH_INERTIA_EXACT if closed.get(mesh) else inertia.mjMESH_INERTIA_CONVEX
    for geom, density in densities.items():
        made = spec.worldbody.add_body(name=f"{geom}").add_geom(type=int(model.geom_type[geom]))
        made.density, made.contype, made.conaffinity = density, 0, 0
        if geom in meshes:
            made.meshname = f"{meshes[geom]}"
        else:
            made.size = model.geom_size[geom]
    return spec


def mesh_arrays(model: Any, mesh: int) -> tuple[Any, Any]:
    """Return the corners of a mesh in the frame of its geoms, (n, 3), single precision, and its triangles, (m, 3)."""
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    faces = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
    return model.mesh_vert[first : first + count], faces


def mesh_text(model: Any, mesh: int) -> dict[str, str]:
    """Return a mesh as texts, as lists of all its numbers take a second; `mesh_triangles` reads them."""
    vertices, faces = mesh_arrays(model, mesh)
    arrays = {"vertices": vertices.astype("<f4"), "faces": faces.astype("<i4")}
    return {key: b64encode(array.tobytes()).decode() for key, array in arrays.items()}


def mesh_triangles(text: dict[str, str]) -> Triangles:
    """Return what `mesh_text` wrote."""
    vertices = np.frombuffer(b64decode(text["vertices"]), "<f4").reshape(-1, 3).astype(np.float64)
    return Triangles(vertices, np.frombuffer(b64decode(text["faces"]), "<i4").reshape(-1, 3).astype(np.int64))


def subtree_weight(model: Any, data: Any, body: int) -> Data:
    """Return the ``mass`` of a body with all that hangs on it, the ``center`` of that in the world, and the ``inertia``
    about that in the axes of the world (3, 3), as `mj_crb` adds them up.
    """
    xx, yy, zz, xy, xz, yz, _, _, _, mass = data.crb[body].tolist()
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])  # the center of all that hangs on its root
    center = data.subtree_com[body]
    arm: FloatArray = center - data.subtree_com[model.body_rootid[body]]
    inertia = about - mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return {"mass": mass, "center": center.tolist(), "inertia": inertia.tolist()}
