"""The worst and the most typical runs of a study, and these as scenes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path as PathOnDisk

import numpy as np

from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import SCENE_NAME
from cagepose.files.write import write_whole
from cagepose.model.checks import FloatArray
from cagepose.runs.solve import run
from cagepose.sampling.outcome import REFUSED, at_rest
from cagepose.sampling.results import StudyResults
from cagepose.sampling.statistics import Statistics
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback

N_WORST = 3


@dataclass(frozen=True)
class ChosenRun:
    """One row, and the scene that it is.

    Attributes
    ----------
    name, file, page
        What it is, "worst 1" or "typical", and the names of its scene and of the page that plays it in the study's
        folder.
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
        replace(found, name=name, file=f"{stem}.yaml", page=f"{stem}.html")
        for stem, (name, found) in zip(stems, named, strict=True)
    ]


def write_runs(results: StudyResults, chosen: Sequence[ChosenRun]) -> list[PathOnDisk]:
    """Write chosen runs beside the study's own scene, as its file with other numbers and as a page that plays; return
    the files.

    Raises
    ------
    OSError
        One cannot be written.
    """
    folder, paths = results.folder.path, [one.path for one in results.study.varied]
    text = (folder / SCENE_NAME).read_text(encoding="utf-8")
    written = []
    for one in chosen:
        values = dict(zip(paths, one.values.tolist(), strict=True))
        source = results.study.scene_text.scene_with(values)
        shown = page(playback(run(source.scene), source.length_unit))
        for name, content in ((one.file, with_values(text, {**values})), (one.page, shown)):
            write_whole(folder / name, content.encode())
            written.append(folder / name)
    return written
