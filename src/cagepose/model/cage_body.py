"""A body of the cage that can be driven: `CageBody`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

from numpy.typing import ArrayLike

from cagepose.model.box import Box
from cagepose.model.cage_elements import Elements, elements_of
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_text
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import AnyShape, Shape
from cagepose.model.wording import counted


@dataclass(frozen=True, init=False, eq=False)
class CageBody:
    """Points and shapes of a cage that move as one where a phase drives them; where none does they stand still. One
    without any carries springs.

    Attributes
    ----------
    name
        By which a phase drives it.
    points_body
        Its points in its own frame, (n, 3), metres; n may be zero.
    names
        One name for each point; left out: "mate/C1", "mate/C2", ... of a body "mate".
    pose_cage_body
        Places it in the cage's frame at the start.
    shapes
        Boxes and other shapes in its own frame, every one with a name; left out: "mate/box1", ...
    holes
        What is cut out of them, and what stands alone; every one with a name.
    own
        All of these together.
    """

    name: str
    points_body: Annotated[FloatArray, (-1, 3)]
    names: tuple[str, ...]
    pose_cage_body: Pose
    shapes: tuple[Box | AnyShape | Facets, ...]
    holes: tuple[Hole, ...]
    own: Elements

    def __init__(
        self,
        name: str,
        points: ArrayLike = (),
        names: Sequence[str] | None = None,
        pose: Pose | None = None,
        shapes: Iterable[Shape] = (),
        holes: Iterable[Hole] = (),
    ) -> None:
        """
        Raises
        ------
        SceneError
            As for `Cage`.
        """
        problems = ProblemList()
        check_text(name, ("name",), problems)
        pose = Pose() if pose is None else pose
        check_kind(pose, Pose, ("pose",), problems)
        own = elements_of(points, names, shapes, holes, problems, f"{name}/")
        problems.raise_if_any()
        for field, value in (
            ("name", name),
            ("points_body", own.points_m),
            ("names", own.names),
            ("pose_cage_body", pose),
            ("shapes", own.shapes),
            ("holes", own.holes),
            ("own", own),
        ):
            object.__setattr__(self, field, value)

    def __repr__(self) -> str:
        points, shapes = (len(self.names), "point", "points"), (len(self.shapes), "shape", "shapes")
        return f"<CageBody {self.name!r}: {counted(points, shapes, (len(self.holes), 'hole', 'holes'))}>"

    def in_cage(self) -> Elements:
        """Return its elements as they are in the cage at the start."""
        return self.own.moved(self.pose_cage_body).under("bodies", self.name)
