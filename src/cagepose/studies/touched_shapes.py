"""Where shapes touch at a pose: `touched_shapes`. The kernels find it, as in a run."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from cagepose.kernels.contact.contact_set import tangents_to
from cagepose.kernels.stability.proof import ProofWorkspace
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.judge import judged_workspace
from cagepose.studies.touched_faces import ContactFace, Touch


def touched_shapes(scene: Scene, pose: Pose, phase: int, friction: float, displaced: FloatArray) -> list[Touch]:
    """Return the contacts at a pose, bodies being displaced as for `cases_of`; of rims that lie flat, also the points
    between those that a run lists which the search for another onset has asked.
    """
    at, _ = judged_workspace(scene, pose, phase, friction, displaced)
    return touches_of(scene, pose, at, at.scratch[0].n_asked)


def touches_of(scene: Scene, pose: Pose, at: ProofWorkspace, n: int) -> list[Touch]:
    """Return the first n contacts that a kernel has found at a pose."""
    contacts: Any = at.contacts
    rows = contacts.rows[:n]
    center, counts, found = pose.transform(scene.object.center_of_gravity_m), Counter[tuple[str, str]](), list[Touch]()
    for row in rows:
        pair = scene.cage.element_names[row["cage_part"]], scene.object.element_names[row["part"]]
        counts[pair] += 1
        normal = row["directions"][0]  # the kernel's tangents have no length where there is no friction
        directions = np.array([normal, *tangents_to(as_vector(normal))])
        face = ContactFace(*pair, str(counts[pair]))
        found.append(Touch(face, directions, center + row["arm"], int(row["group"])))
    return found
