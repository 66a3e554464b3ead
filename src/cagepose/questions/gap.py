"""How far a cage may open before its part gets out: `critical_gap`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import expect_count, is_finite
from cagepose.model.scene import Scene
from cagepose.questions.unanswered import Unanswered
from cagepose.studies.free_motions import MOTIONS_OF_BATCH, FreeMotions
from cagepose.studies.play import play
from cagepose.studies.play_frame import PlayFrame

N_MOTIONS = 20_000
N_HALVINGS = 14
"""Of the range, for each of the two ends that are closed in."""


@dataclass(frozen=True)
class CriticalGap:
    """Between which values of a number of the scene the part begins to get out.

    Attributes
    ----------
    caged_at
        The value nearest to the other one at which the part is proven to be caged; None: at none that was tried.
    escapes_at
        The value nearest to that one at which a way out was found; None: at none that was tried.
    n_tried
        Values that were tried.
    n_motions
        That the search for a way out tried at each value, at most.
    """

    caged_at: float | None
    escapes_at: float | None
    n_tried: int
    n_motions: int


def critical_gap(
    scene_at: Callable[[float], Scene], tight: float, wide: float, *, n_motions: int = N_MOTIONS
) -> CriticalGap | Unanswered:
    """Close in the value of a number of a scene from which the part gets out of its cage.

    Both ends are proven: at one there is no way out, at the other there is one. What is between them is not known, and
    neither is whether it changes more than once.

    Parameters
    ----------
    scene_at
        Returns the scene at a value.
    tight, wide
        The range: towards ``wide`` the cage opens.
    n_motions
        As many motions the search for a way out tries at each value, at most; the same ones each time.

    Raises
    ------
    SceneError
        Ends that are not two different finite numbers, no count of motions, or no such scene at some value.
    """
    expect_count(n_motions, "n_motions")
    if not (is_finite(tight) and is_finite(wide)) or tight == wide:
        raise SceneError([Problem(("range",), f"is {tight!r} to {wide!r}; give two different finite numbers")])
    if scene_at(tight).planar is not None:
        return Unanswered("ways out are searched in all six freedoms, of which this scene's plane holds three")
    if scene_at(tight).has_other_shapes:
        return Unanswered("ways out are searched for boxes among points alone")
    tried = set[float]()

    def is_caged(value: float) -> bool:
        tried.add(value)
        return play(scene_at(value), search_s=0.0).verdict == "caged"

    def gets_out(value: float) -> bool:
        tried.add(value)
        return _gets_out(scene_at(value), n_motions)

    caged_at = _last(is_caged, tight, wide)
    escapes_at = _last(gets_out, wide, tight if caged_at is None else caged_at)
    return CriticalGap(caged_at, escapes_at, len(tried), n_motions)


def _last(holds: Callable[[float], bool], first: float, last: float) -> float | None:
    """Return the last value, by halving, at which something holds that holds at the first; None: not even there."""
    if not holds(first):
        return None
    if holds(last):
        return last
    known, beyond = first, last
    for _ in range(N_HALVINGS):
        middle = 0.5 * (known + beyond)
        if holds(middle):
            known = middle
        else:
            beyond = middle
    return known


def _gets_out(scene: Scene, n_motions: int) -> bool:
    """Whether so many motions lead out."""
    tree = FreeMotions(scene, PlayFrame(scene), n_motions + MOTIONS_OF_BATCH)
    while not tree.is_out and tree.n_tried < n_motions:
        tree.grow()
    return tree.is_out
