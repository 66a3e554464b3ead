"""Each place and normal once: of features that meet at one place with one normal, those that bend least and most."""

from __future__ import annotations

from cagepose.kernels.algebra.vector import minus, norm, vector_from
from cagepose.kernels.boundary.bend import bends_by, curvatures
from cagepose.kernels.boundary.features import CIRCLE, FACE, PlacedBoundary
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.neighbours import first_in_layer, layer_of, put_in_layer
from cagepose.kernels.boundary.touching import SAME_NORMAL, Along, Meetings, Touching, is_around, is_at_place
from cagepose.kernels.native.kernel import kernel


@kernel
def append_meeting(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    along: Along,
    met: Meeting,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append a meeting, or note it beside one that has its normal at its place; there is no room: none are known."""
    at = found.used[0]
    if at < 0 or at == len(found.rows):
        found.used[0] = -1
        return
    row = found.rows[at]
    row.twin, row.cage_twin, row.gap, row.is_kept, row.group = -1, -1, met.gap, False, at
    row.beside, row.cage_beside = -1, -1
    write_features(i, j, along, row)
    for k in range(3):
        row.normal[k], row.place[k] = met.normal[k], met.place[k]
    before = same_before(found, at, touch_m)
    if before >= 0:
        note_flush(held, cage, found.rows[before], row)
        note_twin(held, cage, found.rows[before], row)
        return
    put_in_layer(found, at, touch_m)
    found.used[0] = at + 1


@kernel
def same_before(found: Meetings, at: int, touch_m: float) -> int:
    """Return which meeting is listed already at the place of another one, with its normal; -1: none is."""
    layer, normal = layer_of(found, at, touch_m), vector_from(found.rows[at].normal)
    for beside in range(layer - 1, layer + 2):
        before = first_in_layer(found, beside)
        while before >= 0:
            turned = norm(minus(vector_from(found.rows[before].normal), normal))
            if turned <= SAME_NORMAL and is_at_place(found, before, at, touch_m):
                return before
            before = int(found.behind[before])
    return -1


@kernel
def note_flush(held: PlacedBoundary, cage: PlacedBoundary, told: Touching, new: Touching) -> None:
    """Note that two faces of a body meet one feature of the other one at a place: they are flush there."""
    kind, cage_kind = held.own.features[new.feature].kind, cage.own.features[new.cage_feature].kind
    if kind == FACE and told.cage_feature == new.cage_feature:
        told.beside = new.feature
    if cage_kind == FACE and told.feature == new.feature:
        told.cage_beside = new.cage_feature


@kernel
def write_features(i: int, j: int, along: Along, out: Touching) -> None:
    out.feature, out.cage_feature = i, j
    out.angle, out.before, out.after = along.angle, along.before, along.after


@kernel
def bends_of(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, row: Touching, around: bool) -> float:
    met = Meeting(True, row.gap, vector_from(row.normal), vector_from(row.place))
    return bends_by(curvatures(held, i, cage, j, met, around))


@kernel
def note_twin(held: PlacedBoundary, cage: PlacedBoundary, told: Touching, new: Touching) -> None:
    """Keep, of features that meet at one place with one normal, those that bend least, and beside them those that bend
    most; but a circle that touches along an arc there is kept in any case. Where the arc ends, what else is there is
    kept, as an edge that crosses the circle: its place goes along both.
    """
    if is_around(told) and is_around(new) and are_of_one_circle(held, cage, told, new):
        told.before, told.after = max(told.before, new.before), max(told.after, new.after)
        return
    if is_end(new) and not is_around(told):
        return
    least = bends_of(held, told.feature, cage, told.cage_feature, told, is_around(told))
    bend = bends_of(held, new.feature, cage, new.cage_feature, new, is_around(new))
    most = least if told.twin < 0 else bends_of(held, told.twin, cage, told.cage_twin, told, False)
    if bend < least if is_around(told) == is_around(new) else is_around(new):
        if told.twin < 0 and least > bend:
            told.twin, told.cage_twin = told.feature, told.cage_feature
        write_features(new.feature, new.cage_feature, Along(new.angle, new.before, new.after), told)
    elif bend > most:
        told.twin, told.cage_twin = new.feature, new.cage_feature


@kernel
def is_end(row: Touching) -> bool:
    """Whether a meeting is at an end of an arc along which a circle touches."""
    return is_around(row) and min(row.before, row.after) == 0.0


@kernel
def are_of_one_circle(held: PlacedBoundary, cage: PlacedBoundary, one: Touching, other: Touching) -> bool:
    """Whether two meetings are of the same circle, as on two faces that are flush."""
    if one.feature == other.feature and held.own.features[one.feature].kind == CIRCLE:
        return True
    return bool(one.cage_feature == other.cage_feature and cage.own.features[one.cage_feature].kind == CIRCLE)
