"""What came of an insertion: `Insertion`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray, expect_choice
from cagepose.model.scene import Scene
from cagepose.runs.driven import DriveRun
from cagepose.runs.drives import way_of
from cagepose.runs.misaligned_scene import misaligned_scene
from cagepose.runs.run import PhaseRun, Run, Verdict
from cagepose.studies.misalignment import FREEDOMS, Misalignment, out_of_place, turned_through


@dataclass(frozen=True, eq=False)
class Insertion:
    """How far a phase's drive gets, with which force, where the object could jam, and how far all may be out of place.

    Attributes
    ----------
    run
        That of the scene as it is.
    phase
        Number of the phase that was asked about, from 0.
    friction
        The greatest coefficient of all contacts that there can be.
    jam_friction
        At each place of the drive's curve the least coefficient of friction with which the object could jam there,
        (n,), to 1e-5 of itself; inf: none up to 10; nan: too much touches there to ask. Of several coefficients it is
        the greatest, the others in proportion.
    bodies
        Names of the bodies whose drive may be out of place.
    takes_object
        Whether the object is out of place with them: it hangs on them by springs alone.
    misalignment
        How far, by freedom: "x", "y", "z" (shifts, metres), "roll", "pitch", "yaw" (turns about these axes of the
        cage's frame through the object's origin at the start, radians).
    """

    run: Run
    phase: int
    friction: float
    jam_friction: FloatArray
    bodies: tuple[str, ...]
    takes_object: bool
    misalignment: dict[str, Misalignment]

    def __repr__(self) -> str:
        share = "not begun" if self.drive is None else f"{self.drive.share:.6g} of the way"
        jam = "cannot jam" if self.cannot_jam else "could jam"
        return f"<Insertion of {self.run.scene.name!r}: {self.verdict}, {share}, {jam}>"

    @property
    def ended(self) -> PhaseRun | None:
        """The phase as it was run; None: one before it did not come to rest."""
        return self.run.phases[self.phase] if self.phase < len(self.run.phases) else None

    @property
    def verdict(self) -> Verdict:
        """How the phase ended, or the one before it that did not come to rest."""
        return self.run.verdict if self.ended is None else self.ended.verdict

    @property
    def drive(self) -> DriveRun | None:
        """What came of its drive; None: it did not begin."""
        return None if self.ended is None else self.ended.drive

    @property
    def depth_m(self) -> FloatArray:
        """How far the first body that is driven has travelled at each place of the drive's curve, (n,), metres."""
        if self.drive is None:
            return np.zeros(0)
        legs = next(iter(self.run.scene.loads[self.phase].drive.values()))
        return np.array([way_of(legs, share)[0] for share in self.drive.curve.share.tolist()])

    def scene_out_of_place(self, freedom: str, amount: float) -> Scene:
        """Return the scene in which the drive is out of place along one freedom, by metres or radians.

        Raises
        ------
        SceneError
            No such freedom, or the object would start inside the cage.
        """
        expect_choice(freedom, FREEDOMS, "freedom")
        scene = self.run.scene
        return misaligned_scene(scene, self.phase, out_of_place(freedom, amount, turned_through(scene)))

    @property
    def cannot_jam(self) -> bool:
        """Whether at no place of the way forces in the cones could stand against the drive: with these contacts along
        this path, at this friction and below.
        """
        return self.drive is not None and not self.drive.jam_possible

    @property
    def least_jam_friction(self) -> float | None:
        """The least coefficient with which the object could jam anywhere on the way; None: none, or nothing driven."""
        return None if self.drive is None else self.drive.critical_jam_friction

    @property
    def least_jam_share(self) -> float | None:
        """After which share of the drive that is; None: nowhere."""
        if self.drive is None or not np.isfinite(self.jam_friction).any():
            return None
        return float(self.drive.curve.share[int(np.nanargmin(self.jam_friction))])
