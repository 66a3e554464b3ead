"""How deep is the object in its cage on its whole way, and is that more than a run allows itself?"""

from __future__ import annotations

from dataclasses import dataclass

from audit.case import Answer, FloatArray
from audit.overlap import FINEST, Bodies
from audit.stations import Station, stations
from cagepose import Run

DEEP_BETWEEN = 5e-5
"""Of the size: between the poses of a run a part moves on screws, whose points cut a bent way short."""


@dataclass(frozen=True)
class Depth:
    """How deep the object is in the cage at a pose, at which place, and what of it is no fault; metres."""

    station: Station
    depth_m: float
    error_m: float
    place_world: FloatArray

    @property
    def excess_m(self) -> float:
        return self.depth_m - self.error_m


def inside(run: Run) -> Answer:
    """At none of the poses of a phase, nor between them, is the object deeper in the cage than the error allows."""
    try:
        found = deepest(run)
    except NotImplementedError:
        return None
    return [_words(run, one) for one in found if one.excess_m > 0.0]


def deepest(run: Run) -> list[Depth]:
    """Return for each phase the pose whose depth exceeds its error most; none of a phase where nothing is near.

    Raises
    ------
    NotImplementedError
        A part is a flat polygon with a radius.
    """
    looked_at, best = stations(run), dict[int, Depth]()
    for overlap in Bodies(run.scene).overlaps([station.pose for station in looked_at]):
        station = looked_at[overlap.index]
        one = Depth(station, overlap.depth_m, error_m(run, is_told=station.is_told), overlap.place_world)
        if station.phase not in best or one.excess_m > best[station.phase].excess_m:
            best[station.phase] = one
    return list(best.values())


def error_m(run: Run, *, is_told: bool) -> float:
    """Return how deep the object may seem, metres: what the run allows itself at a pose, told by it or between two that
    are, and the spacing at which the search for the deepest place ends.
    """
    of_size = 1.001 * run.scene.tolerances.touch + FINEST + (0.0 if is_told else DEEP_BETWEEN)
    return of_size * run.scene.size_m


def _words(run: Run, one: Depth) -> str:
    phase, station, size_m = run.phases[one.station.phase], one.station, run.scene.size_m
    rule = phase.events[station.event].rule if phase.events else "start"
    place = ", ".join(f"{value:.4g}" for value in one.place_world * 1e3)
    depth = (
        f"{one.depth_m / size_m:.1e} sizes in the cage ({one.depth_m * 1e3:.3g} mm; error {one.error_m / size_m:.1e})"
    )
    return f"{phase.name}: {depth} in event {station.event + 1} ({rule}), pose {station.number}, at ({place}) mm"
