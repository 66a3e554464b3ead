"""What is drawn of a drive: force, contacts and pose over its way, `DriveCurves`."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.scene import Scene
from cagepose.runs.driven import DriveRun
from cagepose.runs.drives import turns_alone, way_of
from cagepose.runs.run import Event, PhaseRun


@dataclass(frozen=True, eq=False)
class DriveCurves:
    """A phase's drive over its way; what is of places has a row for each, (n,) or (n, 3).

    Attributes
    ----------
    phase, load, drive
        What is drawn.
    label, whole
        What the way is, with its unit, and how far it goes.
    ways, forces
        How far each place is, and the force there; NaN: no body moved.
    moved, angles_deg
        The way of the centre of gravity, in the unit of the figure, and angles.
    snaps
        Where on the way the object snaps.
    stays
        (name, first and last place on the way) of what touched all between two events.
    driven
        Names of what is of bodies that are driven.
    """

    phase: PhaseRun
    load: Load
    drive: DriveRun
    label: str
    whole: float
    ways: FloatArray
    forces: FloatArray
    moved: FloatArray
    angles_deg: FloatArray
    snaps: list[float]
    stays: list[tuple[str, float, float]]
    driven: set[str]


def drive_curves(scene: Scene, phase: PhaseRun, load: Load, unit: LengthUnit) -> DriveCurves:
    """Return the curves of a phase that has driven bodies, lengths in a unit."""
    drive = phase.drive
    assert drive is not None
    label, per_share = _way(load, unit)
    shares, cage = drive.curve.share, scene.cage
    bodies = ["", *(body.name for body in cage.bodies)]
    driven = {
        name for name, body in zip(cage.element_names, cage.element_bodies, strict=True) if bodies[body] in load.drive
    }
    is_on_springs = any(spring.of in load.drive for spring in load.springs)
    advanced = np.diff(shares, prepend=shares[0]) > 0.0
    free = [not is_on_springs and driven.isdisjoint(event.contacts) for event in _events_of_places(phase)]
    forces = [shown_along(along, load, share, unit) for share, along, _ in drive.curve.places()]
    poses = [pose for _, _, pose in drive.curve.places()]
    places = np.array([pose.transform(scene.object.center_of_gravity_m) for pose in poses])
    return DriveCurves(
        phase=phase,
        load=load,
        drive=drive,
        label=f"{phase.name}: {label}" if len(scene.loads) > 1 else label,
        whole=per_share,
        ways=per_share * shares,
        forces=np.where(advanced | np.array(free), forces, np.nan),
        moved=from_metres(places - places[0], unit),
        angles_deg=np.degrees(np.unwrap([pose.euler_zyx for pose in poses], axis=0)),
        snaps=(per_share * np.unique(shares[1:][~advanced[1:]])).tolist(),
        stays=[
            (name, per_share * before.share, per_share * after.share)
            for before, after in pairwise(phase.events)
            if after.share > before.share
            for name in after.contacts
            if name in before.contacts
        ],
        driven=driven,
    )


def _events_of_places(phase: PhaseRun) -> list[Event]:
    """Return the event that ends at or beyond each place of a drive's curve; its first place is before the drive."""
    first = next((place for place, event in enumerate(phase.events) if event.share > 0.0), len(phase.events))
    before = phase.events[max(first - 1, 0)]
    return [before, *(event for event in phase.events[first:] for _ in event.path)]


def _way(load: Load, unit: LengthUnit) -> tuple[str, float]:
    """Return what the way of a drive is, and how far it goes: that of one body along one line or about one axis."""
    if len(load.drive) == 1:
        ((name, legs),) = load.drive.items()
        travel_m, angle = way_of(legs, 1.0)
        if len(legs) == 1:
            if legs[0].is_turn:
                return f"{name}, turned [deg]", abs(float(np.degrees(angle)))
            return f"{name}, travelled [{unit}]", float(from_metres(travel_m, unit))
    return "share of the way [%]", 100.0


def shown_along(along: float, load: Load, share: float, unit: LengthUnit) -> float:
    """Return what is along the way at a share: a force as it is, a moment in the unit of length."""
    return float(from_metres(along, unit)) if turns_alone(load, share) else along
