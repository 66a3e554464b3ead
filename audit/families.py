"""The families by name, and any case of them by its index."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from itertools import count

import numpy as np

from audit import (
    caged_families,
    drawn_families,
    exact_families,
    loose_families,
    mechanism_families,
    ordinary_families,
    prism_families,
    round_families,
    union_families,
)
from audit.case import Case
from cagepose import Scene, SceneError

DRAWN: dict[str, Callable[[np.random.Generator], Scene]] = {
    "near-contact": loose_families.near_contact,
    "grid": loose_families.grid,
    "needle": loose_families.needle,
    "far-gravity": loose_families.far_gravity,
    "wedge": loose_families.wedge,
    "floor": loose_families.floor,
    "many-loads": loose_families.many_loads,
    "any-scale": loose_families.any_scale,
    "twins": loose_families.twins,
    "block": loose_families.block,
    "mixed-friction": loose_families.mixed_friction,
    "slot": exact_families.slot,
    "open-plate": exact_families.open_plate,
    "stopped-plate": exact_families.stopped_plate,
    "prism": prism_families.prism,
    "stopped-prism": prism_families.stopped_prism,
    "edge-prism": prism_families.edge_prism,
    "tapered-pin": round_families.tapered_pin,
    "square-hole": round_families.square_hole,
    "ball-on-hole": round_families.ball_on_hole,
    "peg": round_families.peg,
    "countersunk": round_families.countersunk,
    "coin": round_families.coin,
    "roller": round_families.roller,
    "rolling": round_families.rolling,
    "caged": caged_families.caged,
    "caged-seams": caged_families.caged_seams,
    "pushed-block": caged_families.pushed_block,
    "union": union_families.union,
    "cam": mechanism_families.cam,
    "v-rollers": mechanism_families.v_rollers,
    "dovetail": mechanism_families.dovetail,
    "puck": mechanism_families.puck,
    "ordinary": ordinary_families.ordinary,
}
"""Families of random scenes."""

NUMBERED: dict[str, Callable[[int], Scene]] = {
    "rail": drawn_families.rail,
    "drawer": drawn_families.drawer,
    "dock": drawn_families.dock,
    "table": drawn_families.table,
}
"""Families of one drawing each, whose index sets the friction."""

ROUND = ("tapered-pin", "square-hole", "ball-on-hole", "peg", "countersunk", "coin", "roller", "rolling")
"""Families with circles."""
WITH_SHAPES = (*ROUND, "cam", "v-rollers", "dovetail", "puck", "ordinary")
"""Families with other shapes than points and boxes, which take most of the time: a quarter as many are asked, unless
they are asked alone.
"""

ENDINGS = {"open-plate": "escapes", "stopped-plate": "rests", "prism": "escapes"}
"""Verdicts that are known by hand."""

FAMILIES = (*DRAWN, *NUMBERED)


def make_case(family: str, index: int, seed: int = 0) -> Case:
    """Return one case, which is the same however many are asked."""
    if family in NUMBERED:
        return Case(family, index, seed, NUMBERED[family](index))
    rng = np.random.default_rng([seed, zlib.crc32(family.encode()), index])
    return Case(family, index, seed, _drawn(family, rng), ENDINGS.get(family))


def drawn_scenes(family: str, n_scenes: float, seed: int) -> Iterator[Scene]:
    """Yield so many scenes of a family, or without end, from one generator: the same ones for the same seed."""
    rng = np.random.default_rng(seed)
    for number in count():
        if number >= n_scenes:
            return
        yield _drawn(family, rng)


def _drawn(family: str, rng: np.random.Generator) -> Scene:
    """Draw a scene; a draw that is none (a point inside, two points on each other) is drawn again."""
    while True:
        try:
            return DRAWN[family](rng)
        except SceneError:
            continue
