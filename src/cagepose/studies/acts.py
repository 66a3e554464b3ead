"""What acts in a phase, one by one, as pictures show it: `acts_of`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven_cage import CageAt
from cagepose.runs.load_scaling import scaled_load

LEAST_SHOWN = 0.01
"""A force below this fraction of the greatest of its phase is not shown; its arrow would be a dot."""
N_COILS = 7
"""A drawn spring has so many coils."""
COIL_POINTS = 8
"""A coil is drawn with so many points."""
STRAIGHT_ENDS = 0.15
"""Share of a drawn spring's length that is straight at each end."""


@dataclass(frozen=True, eq=False)
class Act:
    """A weight, a push, a moment or a spring.

    Attributes
    ----------
    kind, name
        What it is, and what it is called.
    at_object_m
        Where it acts, in the object's frame, (3,), metres; of a moment the centre of gravity. None: a force that acts
        at a point of the world.
    at_world_m
        That point, (3,), metres.
    direction
        Unit vector, (3,), in the world, or in the object's frame if it follows it. Of a spring zero.
    follows
        Whether it turns with the object.
    to_world_m
        Where a spring is held at the start, (3,), metres; None: it is no spring.
    body
        The number of the body of the cage that it rides on there, see `CageAt`; 0: it is held where nothing moves.
    """

    kind: Literal["weight", "force", "moment", "spring"]
    name: str
    at_object_m: FloatArray | None
    direction: FloatArray
    follows: bool = False
    at_world_m: FloatArray | None = None
    to_world_m: FloatArray | None = None
    body: int = 0

    def at_object(self, pose: Pose) -> FloatArray:
        """Return where it acts while the object is at a pose, in the object's frame, (3,), metres."""
        if self.at_object_m is not None:
            return self.at_object_m
        assert self.at_world_m is not None
        return pose.inverse_transform(self.at_world_m)

    def end_world(self, cage: CageAt) -> FloatArray:
        """Return where a spring is held, (3,), metres, while the bodies of the cage are where they are.

        Raises
        ------
        ValueError
            It is no spring.
        """
        if self.to_world_m is None:
            raise ValueError(f"{self.name} is no spring, and is held nowhere")
        return cage.displaced[self.body].transform(self.to_world_m)

    def direction_at(self, pose: Pose, cage: CageAt) -> FloatArray:
        """Return where it points to in the world, unit vector (3,), while the object is at a pose and the bodies of the
        cage are where they are; zero where the ends of a spring meet.
        """
        if self.to_world_m is not None:
            way = self.end_world(cage) - pose.transform(self.at_object(pose))
            length = float(np.linalg.norm(way))
            direction: FloatArray = way / length if length else way
            return direction
        return pose.rotation @ self.direction if self.follows else self.direction


def acts_of(scene: Scene, load: Load) -> tuple[Act, ...]:
    """Return all that acts in a phase but forces that are small beside others. What is alone beside the weight has the
    phase's name; else forces, moments and springs are numbered.
    """
    center, weighed = scene.object.center_of_gravity_m, scaled_load(scene, load)
    is_alone = len(load.pushes) + len(load.moments) + len(load.springs) == 1
    sizes = np.linalg.norm(np.vstack([weighed.gravity, weighed.forces]), axis=1)
    shown = sizes > LEAST_SHOWN * sizes.max()
    found = list[Act]()
    if shown[0]:
        found.append(Act("weight", "weight", center, weighed.gravity / sizes[0]))
    for number, push in enumerate(load.pushes, start=1):
        if shown[number]:
            name = load.name if is_alone else f"force {number}"
            found.append(Act("force", name, push.at_object_m, push.direction, push.follows, push.at_world_m))
    for number, moment in enumerate(load.moments, start=1):
        name = load.name if is_alone else f"moment {number}"
        found.append(Act("moment", name, center, moment.direction, moment.follows))
    for number, spring in enumerate(load.springs, start=1):
        name = load.name if is_alone else f"spring {number}"
        end = scene.cage.spring_end_world(spring)
        body = 0 if spring.of is None else 1 + [body.name for body in scene.cage.bodies].index(spring.of)
        found.append(Act("spring", name, spring.at_object_m, np.zeros(3), to_world_m=end, body=body))
    return tuple(found)


def coil(start: FloatArray, end: FloatArray, radius: float) -> FloatArray:
    """Return a spring between two points, (n, 3), as a line that winds."""
    axis = end - start
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        return np.stack([start, end])
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    aside = np.cross(axis / length, helper)
    aside /= np.linalg.norm(aside)
    up = np.cross(axis / length, aside)
    turns = np.linspace(0.0, 2.0 * np.pi * N_COILS, N_COILS * COIL_POINTS + 1)[:, None]
    along = np.linspace(STRAIGHT_ENDS, 1.0 - STRAIGHT_ENDS, len(turns))[:, None]
    wound = start + along * axis + radius * (np.cos(turns) * aside + np.sin(turns) * up)
    return np.concatenate([start[None], start + STRAIGHT_ENDS * axis[None], wound, [end - STRAIGHT_ENDS * axis, end]])
