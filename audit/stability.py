"""Is a stable rest without friction a valley? Slide down from small random displacements, by linear programs.

A rest that is called stable has no lower pose near by. A displacement is a twist about the middle of the part, travel
in sizes of it. A start is a random corner of the displacements that the contacts allow; each step then solves a linear
program: down the potential, with the gaps of the faces that count kept open to first order, inside a box. What counts
at the end are exact gaps and the exact fall of the potential; a gap that is left closed too far is paid for with twice
all contact forces, so that no depth can be taken for a fall. A true valley may be narrow (a contact near an edge), so a
lower pose must be there at each radius. Gaps within the touch tolerance count as closed: what the load can fall through
them is asked of the forces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog

from audit.case import Answer, FloatArray, is_held_by_forces
from audit.geometry import Acting, acting, choices, corners, load_of, load_size, touches
from cagepose import PhaseRun, Run, Scene

RADII = (1e-4, 1e-5)
"""Radii of the displacements, in sizes of the part."""
N_STARTS, N_STEPS, N_CHOICES = 8, 4, 2
SHRINK = 0.7
"""Factor of the length of a step, from one to the next."""
LEAST_CURVATURE = 1e-4
"""Curvature of the potential, load by size. A fall of less than this times the squared radius is not counted."""
ROUNDING = 2e-15
"""Rounding of a gap or of an arm, in sizes."""
DEPTH_PRICE = 10.0
"""For a linear program: what a gap that cannot be kept open costs, in sums of the contact forces."""


def stability(run: Run) -> Answer:
    """A stable rest has no lower neighbour; an unstable one has."""
    if run.scene.friction_coefficient or run.scene.friction_of:
        return None
    found, asked = [], False
    for phase in run.phases:
        if phase.verdict != "rests" or phase.proof.stability not in ("stable", "unstable"):
            continue
        if not is_held_by_forces(phase):
            continue
        asked = True
        if phase.proof.stability == "stable":
            if all(lowest_neighbour(run.scene, phase, radius) > 0.0 for radius in RADII):
                found.append(f"{phase.name}: stable, but there are lower poses as near as {RADII[-1]:g} sizes")
        elif all(lowest_neighbour(run.scene, phase, radius) == 0.0 for radius in RADII):
            found.append(f"{phase.name}: unstable, but nothing lower was found near by")
    return found if asked else None


def lowest_neighbour(scene: Scene, phase: PhaseRun, radius: float) -> float:
    """How much lower a pose within ``radius`` is, of load times size; zero: not beyond rounding."""
    rng = np.random.default_rng(0)
    acts = acting(scene, load_of(scene, phase.name))
    touched = touches(scene, phase.pose)
    deepest = 0.0
    for chosen in choices(touched, N_CHOICES, rng)[0][:N_CHOICES]:
        valley = _Valley(scene, phase, acts, [(t.point, t.box, t.axis) for t in chosen])
        for _ in range(N_STARTS):
            deepest = max(deepest, valley.slide(rng, radius))
            if deepest > 0.0:
                return deepest
    return deepest


class _Valley:
    """The potential and the gaps about a pose, exactly; twists in sizes of the part."""

    def __init__(
        self, scene: Scene, phase: PhaseRun, acts: Sequence[Acting], faces: Sequence[tuple[int, int, int]]
    ) -> None:
        pose = phase.pose
        points = corners(scene, pose)
        self.size = 2.0 * float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
        load = load_size(acts)
        self.forces = np.array([act.force / load for act in acts])
        self.arms = (pose.transform([act.at_object for act in acts]) - points.mean(axis=0)) / self.size
        places = (scene.cage.points_world() - points.mean(axis=0)) / self.size
        normals, self.places, self.heights = [], [], []
        for point, box, axis in faces:
            part = scene.object.boxes[box]
            turn = pose.rotation @ part.pose_object_box.rotation
            middle = (pose.transform(part.pose_object_box.position_m) - points.mean(axis=0)) / self.size
            normal = turn[:, axis] * np.copysign(1.0, (places[point] - middle) @ turn[:, axis])
            normals.append(normal)
            self.places.append(places[point])
            self.heights.append(float(normal @ middle) + part.size_m[axis] / 2 / self.size)
        self.normals = np.array(normals).reshape(-1, 3)
        self.start = self.gaps(np.zeros(6))
        carried = sum(contact.force_normal_n or 0.0 for contact in phase.contacts) / load
        self.price = 2.0 * (1.0 + carried)
        self.rounding = ROUNDING * (1.0 + carried) * (1.0 + float(np.abs(self.arms).max()))

    def gaps(self, twist: FloatArray) -> FloatArray:
        """Return the gaps of the faces after a displacement. The points are moved back into the part as it was."""
        back = _turned(np.array(self.places).reshape(-1, 3) - twist[:3], -twist[3:])
        found: FloatArray = (self.normals * back).sum(axis=1) - np.array(self.heights)
        return found

    def slopes(self, twist: FloatArray) -> FloatArray:
        """Derivatives of the gaps after a displacement, near enough to it: (faces, 6)."""
        normals = _turned(self.normals, twist[3:])
        arms = np.array(self.places).reshape(-1, 3) - twist[:3]
        return -np.hstack([normals, np.cross(arms, normals)])

    def fall(self, twist: FloatArray) -> float:
        """How much the potential falls, without cancellation."""
        moved = twist[:3] + _turned(self.arms, twist[3:]) - self.arms
        return float((self.forces * moved).sum())

    def downhill(self, twist: FloatArray) -> FloatArray:
        arms = _turned(self.arms, twist[3:])
        found: FloatArray = np.concatenate([self.forces, np.cross(arms, self.forces)], axis=1).sum(axis=0)
        return found

    def slide(self, rng: np.random.Generator, radius: float) -> float:
        """Go down from a random start; return the greatest fall that is certain, or zero."""
        at, deepest = np.zeros(6), 0.0
        for k in range(N_STEPS + 1):
            if k == 0:
                cost, trust = rng.normal(size=6), rng.uniform(0.2, 1.0, 6)
            else:  # each freedom at its own pace, or two that make a saddle would go back to its top together
                cost, trust = -self.downhill(at * radius), SHRINK**k * rng.uniform(0.2, 1.0, 6)
            step = self._step(cost, at, radius, trust)
            if step is None:
                break
            at = at + step
            deepest = max(deepest, self._certain_fall(at * radius))
        return deepest if deepest > max(self.rounding, LEAST_CURVATURE * radius**2) else 0.0

    def _step(self, cost: FloatArray, at: FloatArray, radius: float, trust: FloatArray) -> FloatArray | None:
        """The best step to first order, in radii, within the box of displacements; None: there is none."""
        twist = at * radius
        open_by = (self.gaps(twist) - self.start) / radius
        n = len(open_by)
        answer = linprog(
            np.concatenate([cost / np.abs(cost).max(), np.full(n, DEPTH_PRICE * self.price)]),
            A_ub=np.hstack([-self.slopes(twist), -np.eye(n)]),
            b_ub=open_by,
            bounds=[(max(-t, -1.0 - x), min(t, 1.0 - x)) for x, t in zip(at, trust, strict=True)] + [(0.0, None)] * n,
            method="highs-ds",
            options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
        )
        return None if answer.x is None else answer.x[:6]

    def _certain_fall(self, twist: FloatArray) -> float:
        """The fall from a displacement put back on the faces, less what its depth may be worth."""
        for _ in range(3):
            too_deep = self.gaps(twist) < self.start
            if not too_deep.any():
                break
            missing = (self.start - self.gaps(twist))[too_deep]
            twist = twist + np.linalg.lstsq(self.slopes(twist)[too_deep], missing, rcond=1e-9)[0]
        depth = float((self.start - self.gaps(twist)).clip(0.0).sum())
        return self.fall(twist) - self.price * depth


def _turned(vectors: FloatArray, angle: FloatArray) -> FloatArray:
    """Turn vectors (n, 3) by a rotation vector."""
    size = float(np.linalg.norm(angle))
    if size == 0.0:
        return vectors
    axis = angle / size
    across = np.cross(axis, vectors)
    turned: FloatArray = vectors + np.sin(size) * across + 2.0 * np.sin(size / 2.0) ** 2 * np.cross(axis, across)
    return turned
