"""What the questions of ``cagepose ask`` share: their options, the scene, its run, and how an answer is printed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, TypeVar

from cyclopts import Parameter

from cagepose.cli.options import Switch

if TYPE_CHECKING:
    from cagepose.files.answers import AnswerModule
    from cagepose.files.scene_file import SceneFile
    from cagepose.files.units import LengthUnit
    from cagepose.questions.unanswered import Unanswered
    from cagepose.runs.run import Run

Answer = TypeVar("Answer")

PhaseOption = Annotated[
    str | None, Parameter(help="The phase at whose end it is asked. Left out: the last.", show_default=False)
]
JsonOption = Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the lines.")]


@dataclass(frozen=True)
class AskedRun:
    """A run that questions are asked about, and the unit of its file."""

    run: Run
    unit: LengthUnit

    def tell(self, question: Callable[[Run], Answer | Unanswered], answers: AnswerModule[Answer], json: bool) -> int:
        """Print the answer to a question and return the exit code: 1 if the run failed, 2 if the question is wrong."""
        from cagepose.errors import SceneError

        try:
            found = question(self.run)
        except SceneError as error:
            sys.stderr.write(f"--{error}\n")
            return 2
        print_answer(self.run.scene.name, found, answers, self.unit, self.run.scene.size_m, json=json)
        return 1 if self.run.failed else 0


def read_asked(scene: str, set_values: Sequence[str], problems: Sequence[str] = ()) -> SceneFile | None:
    """Return the scene of a file; None if anything is wrong with it or the other arguments, which is then printed."""
    from cagepose.errors import SceneFileError
    from cagepose.files.scene_file import read_scene_file

    told, found = list(problems), None
    try:
        found = read_scene_file(scene, set_values)
    except SceneFileError as error:
        told.append(str(error))
    sys.stderr.write("".join(f"{problem}\n" for problem in told))
    return None if told else found


def run_asked(scene: str, set_values: Sequence[str], problems: Sequence[str] = ()) -> AskedRun | None:
    """As `read_asked`, and run it."""
    source = read_asked(scene, set_values, problems)
    if source is None:
        return None
    from cagepose.runs.solve import run

    return AskedRun(run(source.scene), source.length_unit)


def print_answer(
    name: str,
    answer: Answer | Unanswered,
    answers: AnswerModule[Answer],
    unit: LengthUnit,
    size_m: float,
    *,
    json: bool,
) -> None:
    """Print an answer, or why there is none, about the scene of a name and a size."""
    if json:
        from cagepose.files.document import FORMAT_VERSION
        from cagepose.files.results import plain_data
        from cagepose.files.write import json_text

        document = plain_data(answer, unit)
        sys.stdout.write(json_text({"version": FORMAT_VERSION, "scene": name, "units": {"length": unit}, **document}))
        return
    from rich.table import Table
    from rich.text import Text

    from cagepose.cli.console import print_all
    from cagepose.cli.styles import plain_table
    from cagepose.files.answers import told
    from cagepose.files.words import LengthWords

    (lines, rows), grid = told(answer, answers, LengthWords(unit, size_m)), Table.grid(padding=(0, 2))
    for title, text in lines:
        grid.add_row(Text(title), Text(text, overflow="fold"))
    print_all(Text(name), "", grid)
    if rows:
        table = plain_table(*rows[0])
        for row in rows[1:]:
            table.add_row(*map(Text, row))
        print_all("", table)
