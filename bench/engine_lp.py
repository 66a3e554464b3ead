"""Rest as a sequence of small linear programs, by scipy: push as far as the linearised gaps allow, place anew, repeat.

Maximise w . xi subject to J xi <= g and |xi| within a trust region, xi a small twist about the centre of gravity
(docs/theory/mechanics). Frictionless; it gives where the object ends, not why it stays.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from bench.peer_body import PeerBody
from bench.rail_case import Answer, FloatArray


@dataclass(frozen=True)
class LpSettings:
    """How far one program may move the object, when to stop, and scipy's method.

    Attributes
    ----------
    trust_mm, length_mm
        Greatest component of a step; a turn counts as an arm of this length.
    done_mm, step_limit
        The object has arrived once a step takes the load no farther; freedoms without load may still drift.
    """

    trust_mm: float = 3.0
    length_mm: float = 91.5
    done_mm: float = 1e-9
    step_limit: int = 60
    method: str = "highs"


class LpSequence:
    """One scene, prepared: its points as they are (spheres of no radius), each bound to the faces it starts over."""

    def __init__(self, body: PeerBody, settings: LpSettings) -> None:
        self._body, self._settings = body, settings
        points, boxes, axes, signs = np.array(body.faces_in_use).T
        self._points_mm = body.spheres_mm[points]
        self._normals = signs[:, None] * body.box_rotations[boxes, :, axes]
        centers = np.einsum("ij,ij->i", self._normals, body.centers_mm[boxes])
        self._offsets = centers + body.half_sizes_mm[boxes, axes]

    def settings(self) -> dict[str, Any]:
        return asdict(self._settings)

    def run(self) -> Answer:
        """Return the rotation at the end of each phase.

        Raises
        ------
        RuntimeError
            A program without a solution, or no end within the step limit.
        """
        position, rotation = self._body.start_mm.copy(), self._body.start_rotation.copy()
        ends = []
        for load in self._body.loads:
            for _ in range(self._settings.step_limit):
                step, gain = self._step(position, rotation, load.direction, rotation @ load.arm_mm)
                position = position + step[:3]
                rotation = Rotation.from_rotvec(step[3:] / self._settings.length_mm).as_matrix() @ rotation
                if abs(gain) < self._settings.done_mm:
                    break
            else:
                raise RuntimeError(f"no rest within {self._settings.step_limit} linear programs")
            ends.append(rotation)
        return Answer(tuple(ends))

    def _step(
        self, position: FloatArray, rotation: FloatArray, force: FloatArray, arm_mm: FloatArray
    ) -> tuple[FloatArray, float]:
        """Return the best small twist (travel, mm; turn as an arc, mm) and how far it takes the load, mm."""
        length = self._settings.length_mm
        arms = self._points_mm - position
        gaps = np.einsum("ij,ij->i", self._normals, arms @ rotation) - self._offsets
        normals = self._normals @ rotation.T
        jacobian = np.hstack([normals, np.cross(arms, normals) / length])
        load = np.concatenate([force, np.cross(arm_mm, force) / length])
        found = linprog(
            -load,
            A_ub=jacobian,
            b_ub=gaps,
            bounds=(-self._settings.trust_mm, self._settings.trust_mm),
            method=self._settings.method,
        )
        if found.x is None:
            raise RuntimeError(f"linprog: {found.message}")
        step: FloatArray = found.x
        return step, float(load @ step)
