"""How far a cage may open before its part gets out: `critical_gap`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import expect_count, is_finite
from cagepose.model.scene import Scene
from cagepose.questions.plane_escape import ENDLESS, N_POSES, way_out_in_plane
from cagepose.questions.unanswered import Unanswered
from cagepose.studies.free_motions import MOTIONS_OF_BATCH, FreeMotions
from cagepose.studies.plane_frame import has_endless_holes
from cagepose.studies.play import play
from cagepose.studies.play_frame import PlayFrame

N_MOTIONS = 20_000
N_HALVINGS = 14
"""Of the range, for each of the two ends that are closed in."""
N_AROUND = 5
"""Halvings towards a value of which it was not found out, on either side: each takes as long as that did."""


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
        That the search for a way out tried at each value, at most; in a plane, poses at which it asked.
    in_plane
        Whether the scene moves in a plane.
    """

    caged_at: float | None
    escapes_at: float | None
    n_tried: int
    n_motions: int
    in_plane: bool = False


def critical_gap(
    scene_at: Callable[[float], Scene], tight: float, wide: float, *, n_motions: int | None = None
) -> CriticalGap | Unanswered:
    """Close in the value of a number of a scene from which the part gets out of its cage.

    Both ends are proven: at one there is no way out, at the other there is one. What is between them is not known, and
    neither is whether it changes more than once. In a plane (`Scene.planar`) a search that leaves no way out proves
    either, for parts and cages of any shape.

    Parameters
    ----------
    scene_at
        Returns the scene at a value.
    tight, wide
        The range: towards ``wide`` the cage opens.
    n_motions
        As many motions the search for a way out tries at each value, at most; the same ones each time. In a plane, at
        so many poses it asks. None: 20,000 and 60,000.

    Raises
    ------
    SceneError
        Ends that are not two different finite numbers, no count of motions, or no such scene at some value.
    """
    if n_motions is not None:
        expect_count(n_motions, "n_motions")
    if not (is_finite(tight) and is_finite(wide)) or tight == wide:
        raise SceneError([Problem(("range",), f"is {tight!r} to {wide!r}; give two different finite numbers")])
    at_first = scene_at(tight)
    in_plane = at_first.planar is not None
    if in_plane and has_endless_holes(at_first):
        return Unanswered(ENDLESS)
    if at_first.has_other_shapes and not in_plane:
        return Unanswered("ways out are searched for boxes among points alone")
    n_tries = n_motions if n_motions is not None else N_POSES if in_plane else N_MOTIONS
    if in_plane:

        @cache
        def way_out(value: float) -> bool | None:
            return way_out_in_plane(scene_at(value), n_tries)

        caged_at, escapes_at = _bracket(way_out, tight, wide)
        return CriticalGap(caged_at, escapes_at, way_out.cache_info().currsize, n_tries, in_plane)
    tried = set[float]()

    def is_caged(value: float) -> bool:
        tried.add(value)
        return play(scene_at(value), search_s=0.0).verdict == "caged"

    def gets_out(value: float) -> bool:
        tried.add(value)
        return _gets_out(scene_at(value), n_tries)

    caged_at = _last(is_caged, tight, wide)
    escapes_at = _last(gets_out, wide, tight if caged_at is None else caged_at)
    return CriticalGap(caged_at, escapes_at, len(tried), n_tries, in_plane)


def _bracket(way_out: Callable[[float], bool | None], tight: float, wide: float) -> tuple[float | None, float | None]:
    """Return the last values, by halving, at which there is no way out and at which there is one. Where it is not found
    out of a value which of both, both are closed in to there.
    """
    is_caged, gets_out = way_out(tight) is False, way_out(wide) is True
    if way_out(tight) is True and way_out(wide) is False:
        found = "it gets out at the first value, and is caged at the second; give them the other way round"
        raise SceneError([Problem(("range",), found)])
    low, high, unknown = tight, wide, wide if is_caged else tight
    if is_caged and gets_out:
        for _ in range(N_HALVINGS):
            unknown = 0.5 * (low + high)
            is_out = way_out(unknown)
            if is_out is None:
                break
            low, high = (low, unknown) if is_out else (unknown, high)
        else:
            return low, high
    caged_at = _last(lambda value: way_out(value) is False, low, unknown, N_AROUND)
    return caged_at, _last(lambda value: way_out(value) is True, high, unknown, N_AROUND)


def _last(holds: Callable[[float], bool], first: float, last: float, n_halvings: int = N_HALVINGS) -> float | None:
    """Return the last value, by halving, at which something holds that holds at the first; None: not even there."""
    if not holds(first):
        return None
    if holds(last):
        return last
    known, beyond = first, last
    for _ in range(n_halvings):
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
