"""The columns of a study's table: `RowColumns`, from outcomes to what people ask for by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from cagepose import __version__
from cagepose.files.expression import Formula
from cagepose.files.key_path import Path
from cagepose.files.study_file import StudyFile
from cagepose.files.units import from_metres
from cagepose.files.watched import watched_points
from cagepose.model.checks import FloatArray
from cagepose.model.wording import few
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import FAILURES
from cagepose.sampling.asked import AskedColumns
from cagepose.sampling.measured import MeasuredColumns
from cagepose.sampling.outcome import REFUSED, Outcomes, at_rest

SAME_LENGTH_OF_SIZE = 1e-8
"""Fraction of the scene's size. Lengths that differ by less are the same."""
SAME_DEG = 1e-6
"""Degrees. Angles that differ by less are the same."""
SAME_COMPUTED = 1e-9
"""Computed numbers that differ by less are the same."""
SAME_DRIVE = {"drive": 1e-9, "force_max": 1e-9}
"""What is measured of each drive: the share of it that is done, and the greatest force. Shares, and newtons or loads,
that differ by less are the same."""
WITHOUT_ANSWER = [REFUSED, *sorted(FAILURES)]
AXES, ANGLES = ("x", "y", "z"), ("yaw_deg", "pitch_deg", "roll_deg")


class NoColumnError(Exception):
    """What a study asks for is no column.

    Attributes
    ----------
    path
        Where it stands in the study's file.
    """

    def __init__(self, path: Path, message: str) -> None:
        super().__init__(message)
        self.path = path


class RowColumns:
    """Names and makes the columns of one study.

    Attributes
    ----------
    varied, quantities
        Names of the varied numbers, and of what is measured of each run: the final pose, what is watched, how far each
        drive got with which force, what is asked, and what is computed of these.
    watched
        Those of the quantities that are watched: the coordinates of points, and gaps, angles and distances.
    resolution
        By quantity: what varies by less does not vary, but for rounding and the touch tolerance.
    units
        Of varied numbers and quantities, by name; empty where there is none or it is not known.
    verdicts
        Those of the verdicts, the last one first.
    driven
        By the name of a phase that drives bodies of the cage, its place among the phases.
    touching, forces
        Those of the cage's points and shapes, by their names; no forces where the study asks for none.
    """

    def __init__(self, study: StudyFile) -> None:
        self._study, scene = study, study.nominal.scene
        watched, unit = study.model.watch or {}, study.nominal.length_unit
        self._points, self._measures = watched_points(watched, unit), MeasuredColumns(watched, unit).names
        angles = {*ANGLES, *(name for name in self._measures if watched[name].kind == "angle")}
        elements = scene.cage.element_names
        self.varied = tuple(one.key for one in study.varied)
        self.watched = (*(f"{name}_{axis}" for name in self._points for axis in AXES), *self._measures)
        lengths = float(from_metres(SAME_LENGTH_OF_SIZE * scene.size_m, unit))
        self.driven = {load.name: place for place, load in enumerate(scene.loads) if load.drive}
        pose = (*(f"position_{axis}" for axis in AXES), *ANGLES, *self.watched)
        drives = {f"{kind}_{phase}": same for phase in self.driven for kind, same in SAME_DRIVE.items()}
        asked = AskedColumns(study.model.ask or (), scene, unit).columns
        self.quantities = (*pose, *drives, *(column.name for column in asked), *study.compute)
        self.resolution = {name: SAME_DEG if name in angles else lengths for name in pose} | drives
        self.resolution |= {column.name: column.same for column in asked}
        self.resolution |= dict.fromkeys(study.compute, SAME_COMPUTED)
        of_quantities = {name: "deg" if name in angles else unit for name in pose}
        of_quantities |= {f"drive_{phase}": "" for phase in self.driven}
        of_quantities |= {f"force_max_{phase}": self._unit_along(phase) for phase in self.driven}
        of_quantities |= {column.name: column.unit for column in asked}
        self.units = study.units | of_quantities | dict.fromkeys(study.compute, "")
        self.verdicts = ("verdict", *(f"verdict_{load.name}" for load in scene.loads))
        self.touching = {f"touching_{name}": name for name in elements}
        self.forces = {f"force_{name}": name for name in elements} if study.model.forces else {}

    def __repr__(self) -> str:
        return f"<RowColumns: {few(self.varied)} vary; {few(self.quantities)} measured>"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all columns, in their order."""
        jams = (f"jam_possible_{phase}" for phase in self.driven)
        measured = (*self.verdicts, *self.quantities, *jams, *self.touching, *self.forces)
        return ("run", *self.varied, *measured, "accepted", "error", "solve_us")

    def quantities_of(self, values: FloatArray, outcomes: Outcomes) -> dict[str, FloatArray]:
        """Return what is measured of runs that came to rest, in the scene file's unit and degrees; NaN: it did not.
        ``values``: their varied numbers, (n, n_varied).
        """
        columns, rests = self.columns(values, outcomes), at_rest(outcomes.verdict)
        return {name: np.where(rests, columns[name], np.nan) for name in self.quantities}

    def _measured(self, outcomes: Outcomes) -> dict[str, FloatArray]:
        """Return the same of all runs that ended at a pose, wherever they were on their way."""
        unit = self._study.nominal.length_unit
        watched = [outcomes.points_world_m(point) for point in self._points.values()]
        position, *points = (from_metres(places, unit).T for places in (outcomes.position_m, *watched))
        found = np.concatenate([position, np.degrees(outcomes.euler_zyx).T, *points])
        if outcomes.measured is not None:
            found = np.concatenate([found, outcomes.measured.T])
        drives = list[FloatArray]()
        for phase, place in self.driven.items():
            greatest = outcomes.greatest_along[:, place]
            turns = self._turns_alone(phase)
            drives += [outcomes.drive_shares[:, place], from_metres(greatest, unit) if turns else greatest]
        found = np.concatenate([found, np.reshape(drives, (-1, len(outcomes)))])
        if outcomes.answers is not None:
            found = np.concatenate([found, outcomes.answers.T])
        return dict(zip(self.quantities, found + 0.0, strict=False))  # -0.0 becomes 0.0; none is computed yet

    def _turns_alone(self, phase: str) -> bool:
        """Whether the bodies that a phase drives turn and do not travel, so that a moment drives them."""
        drive = self._study.nominal.scene.loads[self.driven[phase]].drive
        return all(leg.is_turn for legs in drive.values() for leg in legs)

    def _unit_along(self, phase: str) -> str:
        scene = self._study.nominal.scene
        force = force_unit(scene, scene.loads[self.driven[phase]])
        return f"{force} {self._study.nominal.length_unit}" if self._turns_alone(phase) else force

    def columns(self, values: FloatArray, outcomes: Outcomes) -> dict[str, NDArray[Any]]:
        """Return all columns but ``run``, ``error`` and ``solve_us``.

        Raises
        ------
        NoColumnError
            What ``compute`` or ``accept`` asks for is none.
        """
        columns: dict[str, NDArray[Any]] = dict(zip(self.varied, values.T, strict=True))
        columns["verdict"] = outcomes.verdict
        columns |= zip(self.verdicts[1:], outcomes.phase_verdicts.T, strict=True)
        columns |= self._measured(outcomes)
        columns |= {f"jam_possible_{phase}": outcomes.jam_possible[:, place] for phase, place in self.driven.items()}
        columns |= zip(self.touching, outcomes.touching.T, strict=True)
        if outcomes.forces is not None:
            columns |= zip(self.forces, outcomes.forces.T, strict=True)
        has_answer = ~np.isin(columns["verdict"], WITHOUT_ANSWER)
        for name, formula in self._study.compute.items():
            columns[name] = np.where(has_answer, self._computed(name, formula, columns), np.nan)
        columns["accepted"] = self._accepted(columns)
        return {name: columns[name] for name in self.names if name in columns}

    def _computed(self, name: str, formula: Formula, columns: Mapping[str, NDArray[Any]]) -> FloatArray:
        try:
            found = np.asarray(formula.value(columns))
        except ValueError as error:
            raise NoColumnError(("compute", name), str(error)) from None
        if found.dtype != np.float64:
            raise NoColumnError(("compute", name), "comes to no number; write a formula, such as 2 * position_x")
        return found + 0.0

    def _accepted(self, columns: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
        """Return which rows are good, (n,); none that was refused or whose run failed: these have no answer.

        Raises
        ------
        NoColumnError
            The expression has no truth value.
        """
        if self._study.accept is None:
            return at_rest(columns["verdict"])
        try:
            found = np.asarray(self._study.accept.value(columns))
        except ValueError as error:
            raise NoColumnError(("accept",), str(error)) from None
        if found.dtype != np.bool_:
            message = "is no comparison; write what is true of a good run, such as verdict == 'rests'"
            raise NoColumnError(("accept",), message)
        accepted: NDArray[np.bool_] = ~np.isin(columns["verdict"], WITHOUT_ANSWER) & found
        return accepted

    def table(self, first: int, values: FloatArray, outcomes: Outcomes) -> pa.Table:
        """Return rows as they are kept; what there is none of is null."""
        arrays: dict[str, pa.Array] = {"run": pa.array(np.arange(first, first + len(values)))}
        for name, column in self.columns(values, outcomes).items():
            if column.dtype.kind == "U":
                found = pa.array(column.astype(object), pa.string(), mask=column == "").dictionary_encode()
            else:
                found = pa.array(column, from_pandas=True)  # NaN is null
            arrays[name] = found
        arrays["error"] = pa.array(outcomes.errors, pa.string())
        arrays["solve_us"] = pa.array(outcomes.solve_us)
        return pa.table(arrays).replace_schema_metadata({"cagepose": __version__})
