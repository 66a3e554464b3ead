"""Is rest the only onset? Another one is looked for by projected Gauss-Seidel sweeps from random contact forces.

Notation and scaling are those of (5.3) and (5.7): the part begins with y = b - A f. A sweep goes from contact to
contact and projects f + rho (v_n - mu |v_t|, v_t) onto the cone, De Saxce's form of Coulomb's law. Where that comes to
a motion, modes are read off, Newton's method solves them to rounding, and the law itself is checked: only what obeys it
counts. Of the other motions that `may rest` verdicts name, this search finds three in four.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from audit.case import Answer, FloatArray
from audit.geometry import Acting, Touch, acting, choices, friction_of, load_of, tangents, touches
from cagepose import Pose, Run, Scene

N_STARTS, N_SWEEPS, N_CHOICES, N_NEWTON = 20, 120, 3, 25
MOST_CONTACTS = 14
OBEYS = 1e-9
"""Greatest violation of Coulomb's law, in lengths of the motion."""
MOVES = 1e-4
"""Least length of a motion, by that of the free one: shorter ones are a rest that has not converged."""


def uniqueness(run: Run) -> Answer:
    """Where the part rests by friction, no other onset obeys Coulomb's law."""
    found, asked = [], False
    for phase in run.phases:
        if phase.verdict == "rests" and phase.proof.needs_friction:
            asked = True
            speed = other_onset(run.scene, phase.pose, acting(run.scene, load_of(run.scene, phase.name)))
            if speed is not None:
                found.append(f"{phase.name}: rests, but Coulomb's law allows an onset with {speed:.1e} of free motion")
    return found if asked else None


def other_onset(scene: Scene, pose: Pose, acts: Sequence[Acting]) -> float | None:
    """Return the length of an onset other than rest, by that of the free motion; None: none was found."""
    rng = np.random.default_rng(0)
    for chosen in choices(touches(scene, pose), N_CHOICES, rng)[0]:
        if 0 < len(chosen) <= MOST_CONTACTS:
            rows, b = scaled_rows(scene, pose, chosen, acts)
            mu = np.array([friction_of(scene, touch) for touch in chosen])
            for forces in _swept(rows, b, mu, rng):
                polished = _polished(rows, b, mu, forces)
                y = b - np.einsum("ijk,ij->k", rows, polished)
                speed = float(np.linalg.norm(y) / np.linalg.norm(b))
                if speed > MOVES and violation(rows, b, mu, polished) < OBEYS:
                    return speed
    return None


def scaled_rows(
    scene: Scene, pose: Pose, chosen: Sequence[Touch], acts: Sequence[Acting]
) -> tuple[FloatArray, FloatArray]:
    """The wrenches of unit forces of (5.3) along normal and tangents, (contacts, 3, 6), and the load's; of length 1."""
    gyration = scene.object.gyration_m2
    if scene.metric == "drag":
        gyration = np.eye(3) * np.trace(gyration) / 3.0
    values, axes = np.linalg.eigh(pose.rotation @ gyration @ pose.rotation.T)
    root = axes / np.sqrt(values) @ axes.T
    center = pose.transform(scene.object.center_of_gravity_m)

    def scaled(force: FloatArray, at: FloatArray) -> FloatArray:
        return np.concatenate([force, root @ np.cross(at - center, force)])

    rows = [[scaled(way, t.place) for way in (t.normal, *tangents(t.normal))] for t in chosen]
    b = np.sum([scaled(act.force, pose.transform(act.at_object)) for act in acts], axis=0)
    return np.array(rows), b / np.linalg.norm(b)


def violation(rows: FloatArray, b: FloatArray, mus: FloatArray, forces: FloatArray) -> float:
    """The greatest violation of (5.7), in lengths of the motion, or of the load for forces where that is less; each
    speed and force at its wrench.

    A contact that slips is told from one that sticks by whichever it obeys better: it must be slow, or have all of its
    friction against its slip.
    """
    y = b - np.einsum("ijk,ij->k", rows, forces)
    speed = max(float(np.linalg.norm(y)), 1e-300)
    unit = min(speed, float(np.linalg.norm(b)))
    worst = 0.0
    for row, force, mu in zip(rows, forces, mus, strict=True):
        arm = float(np.linalg.norm(row[0]))
        v, f = row @ y / (arm * speed), force * arm / unit
        slip, grip = float(np.linalg.norm(v[1:])), float(np.linalg.norm(f[1:]))
        missing = float(np.linalg.norm(f[1:] - mu * f[0] * v[1:] / max(slip, 1e-300)))
        worst = max(worst, v[0], -f[0], min(abs(v[0]), abs(f[0])), grip - mu * f[0], min(slip, missing))
    return worst


def _swept(rows: FloatArray, b: FloatArray, mu: FloatArray, rng: np.random.Generator) -> list[FloatArray]:
    """Contact forces (contacts, 3) after sweeps from random starts; those that hold the part are left out."""
    n = len(rows)
    steps = np.array([1.0 / np.linalg.norm(row @ row.T, 2) for row in rows])
    normal = rng.exponential(size=(N_STARTS, n)) * rng.integers(0, 2, (N_STARTS, n)) * 2.0
    angle = rng.uniform(0.0, 2.0 * np.pi, (N_STARTS, n))
    forces = normal[..., None] * np.stack([np.ones_like(angle), mu * np.cos(angle), mu * np.sin(angle)], axis=-1)
    y = b - np.einsum("ijk,sij->sk", rows, forces)
    for _ in range(N_SWEEPS):
        for i in rng.permutation(n):
            v = y @ rows[i].T
            v[:, 0] -= mu[i] * np.hypot(v[:, 1], v[:, 2])
            new = _on_cone(forces[:, i] + steps[i] * v, mu[i])
            y -= (new - forces[:, i]) @ rows[i]
            forces[:, i] = new
    return list(forces[np.linalg.norm(y, axis=1) > MOVES])


def _on_cone(points: FloatArray, mu: float) -> FloatArray:
    """The nearest points of the friction cone, (n, 3)."""
    normal, across = points[:, 0], np.hypot(points[:, 1], points[:, 2])
    on_side = np.maximum((normal + mu * across) / (1.0 + mu**2), 0.0)
    inside = across <= mu * normal
    first = np.where(inside, normal, on_side)
    share = np.where(inside, 1.0, mu * on_side / np.maximum(across, 1e-300))
    return np.stack([first, share * points[:, 1], share * points[:, 2]], axis=1)


def _polished(rows: FloatArray, b: FloatArray, mu: FloatArray, forces: FloatArray) -> FloatArray:
    """Solve the contact modes that forces show by Newton's method; what comes out must be checked."""
    n = len(rows)
    flat = rows.reshape(3 * n, 6)
    delassus = flat @ flat.T
    slips = (flat @ (b - flat.T @ forces.ravel())).reshape(n, 3)
    opens = forces[:, 0] < 1e-7
    slides = ~opens & (np.linalg.norm(slips[:, 1:], axis=1) > 1e-4 * np.linalg.norm(b - flat.T @ forces.ravel()))
    f = np.where(opens[:, None], 0.0, forces).ravel()
    for _ in range(N_NEWTON):
        v = flat @ b - delassus @ f
        left, slope = v.copy(), -delassus.copy()
        for i in range(n):
            at = slice(3 * i, 3 * i + 3)
            if opens[i]:
                left[at], slope[at], slope[at, at] = f[at], 0.0, np.eye(3)
            elif slides[i]:
                across = slice(3 * i + 1, 3 * i + 3)
                speed = max(float(np.linalg.norm(v[across])), 1e-300)
                d = v[across] / speed
                left[across] = f[across] - mu[i] * f[3 * i] * d
                slope[across] = mu[i] * f[3 * i] / speed * (np.eye(2) - np.outer(d, d)) @ delassus[across]
                slope[across, across] += np.eye(2)
                slope[across, 3 * i] -= mu[i] * d
        step = np.linalg.lstsq(slope, left, rcond=1e-12)[0]
        f = f - step
        if np.abs(step).max() < 1e-14 * (1.0 + np.abs(f).max()) or not np.isfinite(f).all():
            break
    return f.reshape(n, 3)
