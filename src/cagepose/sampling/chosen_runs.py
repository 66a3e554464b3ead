"""The worst and the most typical runs of a study, and these as scenes and as runs to be played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path as PathOnDisk

import numpy as np

from cagepose.files.key_path import Path
from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import SCENE_NAME
from cagepose.files.write import write_whole
from cagepose.model.checks import FloatArray
from cagepose.runs.solve import run
from cagepose.sampling.outcome import REFUSED, at_rest
from cagepose.sampling.results import StudyResults
from cagepose.sampling.statistics import Statistics
from cagepose.views.viewer.playback import Playback, playback

REPORT, NOMINAL = "report.html", "nominal"
"""The page of a study, and the run that it shows first."""
N_WORST = 3


@dataclass(frozen=True)
class ChosenRun:
    """One row, and the scene that it is.

    Attributes
    ----------
    name, file, page
        What it is, "worst 1" or "typical", the name of its scene in the study's folder, and where it is played: in the
        report.
    run, verdict, accepted
        Its number, and how it ended.
    distance
        How far its quantities are from their means over the runs that came to rest, in standard deviations (root mean
        square).
    values
        Of the varied numbers, (n_varied,).
    """

    name: str
    file: str
    page: str
    run: int
    verdict: str
    accepted: bool
    distance: float
    values: FloatArray


def chosen_runs(results: StudyResults, statistics: Statistics) -> list[ChosenRun]:
    """Return the worst runs (without a rest, else not accepted, else far from the mean) and the most typical one.

    A row that was refused is none of them: it has no run.
    """
    columns = results.columns
    used = [name for name in columns.quantities if statistics.spreads[name].sigma > columns.resolution[name]]
    names = ["run", *columns.varied, "verdict", "accepted", *used]
    worst: list[tuple[tuple[int, float, int], ChosenRun]] = []
    typical: list[tuple[tuple[int, float, int], ChosenRun]] = []
    for part in results.parts(names):
        distances = np.zeros(len(part["run"]))
        for name in used:
            spread = statistics.spreads[name]
            distances += ((part[name] - spread.mean) / spread.sigma) ** 2
        distances = np.sqrt(distances / max(len(used), 1))
        ranks = np.where(at_rest(part["verdict"]), np.where(part["accepted"], 0, 1), 2)
        ran = np.flatnonzero(part["verdict"] != REFUSED)
        order = ran[np.lexsort((part["run"][ran], -distances[ran], -ranks[ran]))]
        nearest = ran[np.lexsort((part["run"][ran], distances[ran], ranks[ran]))]
        for chosen, rows, sign in ((worst, order[:N_WORST], -1), (typical, nearest[:1], 1)):
            for row in rows.tolist():
                key = (sign * int(ranks[row]), sign * float(distances[row]), int(part["run"][row]))
                values = np.array([part[name][row] for name in columns.varied])
                verdict, accepted = str(part["verdict"][row]), bool(part["accepted"][row])
                chosen.append((key, ChosenRun("", "", "", key[2], verdict, accepted, abs(key[1]), values)))
        worst.sort(key=lambda item: item[0])
        typical.sort(key=lambda item: item[0])
        del worst[N_WORST:], typical[1:]
    named = [(f"worst {number}", found) for number, (_, found) in enumerate(worst, 1)]
    named += [("typical", found) for _, found in typical]
    stems = [name.replace(" ", "-") for name, _ in named]
    return [
        replace(found, name=name, file=f"{stem}.yaml", page=f"{REPORT}#{stem}")
        for stem, (name, found) in zip(stems, named, strict=True)
    ]


def write_scenes(results: StudyResults, chosen: Sequence[ChosenRun]) -> list[PathOnDisk]:
    """Write the scenes of chosen runs beside the study's own, as its file with other numbers; return the files.

    Raises
    ------
    OSError
        One cannot be written.
    """
    folder = results.folder.path
    text = (folder / SCENE_NAME).read_text(encoding="utf-8")
    for one in chosen:
        write_whole(folder / one.file, with_values(text, {**_values(results, one)}).encode())
    return [folder / one.file for one in chosen]


def played_runs(results: StudyResults, chosen: Sequence[ChosenRun]) -> dict[str, Playback]:
    """Return the nominal run and chosen ones, by what stands behind the report's name in their addresses."""
    scenes = {NOMINAL: results.study.nominal}
    for one in chosen:
        scenes[one.page.removeprefix(f"{REPORT}#")] = results.study.scene_text.scene_with(_values(results, one))
    return {name: playback(run(source.scene), source.length_unit) for name, source in scenes.items()}


def _values(results: StudyResults, one: ChosenRun) -> dict[Path, float]:
    paths = [varied.path for varied in results.study.varied]
    return dict(zip(paths, one.values.tolist(), strict=True))
