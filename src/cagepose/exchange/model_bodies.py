"""The bodies of a compiled model: which are the object and the cage, where they are, what they weigh."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import FileProblem, SceneFileError
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.wording import few

WORLD_BODY = 0
"""The body that all others stand in."""


class Inertial(NamedTuple):
    """Mass, centre of gravity (3,) and inertia about it (3, 3) of bodies that are one."""

    mass_kg: float
    center_m: FloatArray
    inertia_kg_m2: FloatArray


class ModelBodies:
    """Bodies of a model, by their numbers.

    Attributes
    ----------
    geoms
        Their geoms, as `cagepose.exchange.compile_model` writes them.
    gravity
        m/s^2, (3,).
    """

    def __init__(self, source: str, compiled: dict[str, Any]) -> None:
        self._source, self._bodies = source, compiled["bodies"]
        self._names = [body["name"] or f"body {number}" for number, body in enumerate(self._bodies)]
        self.geoms: list[dict[str, Any]] = compiled["geoms"]
        self.gravity: list[float] = compiled["gravity"]

    def named(self, name: str) -> int:
        """Return the body of a name; one without a name is called by its number: "body 3".

        Raises
        ------
        SceneFileError
            There is none.
        """
        if name in self._names:
            return self._names.index(name)
        raise self._refused(f"has no body {name!r}; its bodies: {self._list(range(1, len(self._bodies)))}")

    def free(self) -> int:
        """Return the only body that moves freely, or the only one at all.

        Raises
        ------
        SceneFileError
            There is none, or more than one.
        """
        found = [number for number, body in enumerate(self._bodies) if body["is_free"]]
        if len(found) == 1:
            return found[0]
        if not found and len(alone := self.with_geoms() - {WORLD_BODY}) == 1 == len(self._bodies) - 1:
            return alone.pop()
        if len(self._bodies) == 1:
            raise self._refused(
                "has no bodies in its world, so nothing that is held; put the part into a body of its own"
            )
        choice = found or range(1, len(self._bodies))
        what = "no body that moves freely" if not found else f"{len(found)} bodies that move freely"
        raise self._refused(f"has {what}; say which is held, with --object and one of: {self._list(choice)}")

    def below(self, roots: Iterable[int]) -> set[int]:
        """Return bodies with all that hang on them."""
        found = set(roots)
        for number, body in enumerate(self._bodies[1:], start=1):  # parents come before their children
            if body["parent"] in found:
                found.add(number)
        return found

    def with_geoms(self) -> set[int]:
        """Return the bodies that have any."""
        return {geom["body"] for geom in self.geoms}

    def mover(self, body: int, of_cage: set[int]) -> int | None:
        """Return the body of the cage whose joint moves a body, itself or the next above; None: it stands still."""
        while body in of_cage and body != WORLD_BODY:
            if self._bodies[body]["is_jointed"]:
                return body
            body = self._bodies[body]["parent"]
        return None

    def name(self, body: int) -> str:
        """Return a body's name; of one without, "body 3"."""
        return self._names[body]

    def jointed(self, bodies: Iterable[int]) -> list[str]:
        """Return the names of those that a joint moves."""
        return [self._names[number] for number in sorted(bodies) if self._bodies[number]["is_jointed"]]

    def others(self, bodies: set[int]) -> list[str]:
        """Return the names of all other bodies but the world."""
        return [name for number, name in enumerate(self._names) if number not in bodies | {WORLD_BODY}]

    def pose(self, body: int) -> Pose:
        """Return where a body is in the world."""
        return Pose(self._bodies[body]["position"], self._bodies[body]["quaternion"])

    def in_frame(self, body: int, local: Pose, frame: int) -> Pose:
        """Return a pose of a body's frame as one of another's; to the last digit where both are one."""
        return local if body == frame else self.pose(frame).inverse() @ self.pose(body) @ local

    def inertial(self, bodies: Iterable[int], frame: int) -> Inertial | None:
        """Return what bodies weigh together, in the frame of one of them; None: nothing."""
        parts = []
        for number in bodies:
            body = self._bodies[number]
            if body["mass"] > 0.0:
                place = self.in_frame(number, Pose(), frame)
                center = place.transform(body["center"]) if number != frame else np.array(body["center"])
                inertia = np.array(body["inertia"])
                turned = inertia if number == frame else place.rotation @ inertia @ place.rotation.T
                parts.append(Inertial(body["mass"], center, turned))
        if not parts:
            return None
        if len(parts) == 1:
            return parts[0]
        mass = sum(part.mass_kg for part in parts)
        center = np.sum([part.mass_kg / mass * part.center_m for part in parts], axis=0)
        total = np.zeros((3, 3))
        for part in parts:
            arm = part.center_m - center
            total += part.inertia_kg_m2 + part.mass_kg * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
        return Inertial(mass, center, total)

    def weight(self, body: int) -> Inertial | None:
        """Return what MuJoCo says that a body weighs with all that hangs on it, in its frame; None: nothing."""
        said, place = self._bodies[body]["subtree"], self.pose(body)
        if self.inertial(self.below([body]), body) is None:
            return None
        turn = place.rotation
        inertia = turn.T @ np.array(said["inertia"]) @ turn
        return Inertial(said["mass"], place.inverse_transform(np.array(said["center"])), inertia)

    def _list(self, bodies: Iterable[int]) -> str:
        return few((self._names[number] for number in bodies), 12) or "none"

    def _refused(self, message: str) -> SceneFileError:
        return SceneFileError([FileProblem((), message, self._source)])
