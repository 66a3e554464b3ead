"""A run as text: a table of events, then pose, contacts, warnings and verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from cagepose.cli.console import print_all, screen_width, text_of, text_width
from cagepose.cli.drive_report import drive_lines
from cagepose.cli.event_table import event_table, listed
from cagepose.cli.force_table import force_table
from cagepose.cli.margin_report import margin_lines, press_lines
from cagepose.cli.styles import STYLES
from cagepose.cli.tolerances import LEAST_GAP_WORK
from cagepose.errors import printable
from cagepose.files.units import LengthUnit
from cagepose.files.words import LengthWords, friction_words
from cagepose.model.wording import duration, short
from cagepose.runs.cases import greatest_friction
from cagepose.runs.drives import bodies_off
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, CONTRADICTED, FAILURES, STOPPED, PhaseRun, Run
from cagepose.studies.ending import run_kind, turned_far
from cagepose.studies.margin import Margin

POSES = {
    "escapes": "where no more contact is ahead; from here the object moves away",
    **dict.fromkeys(FAILURES, "where the run stopped; not a position of rest"),
}
"""Where the pose is taken from, if it is not that of a rest."""
SLIPPED_OFF = "where what presses came off the object"
LARGE_FORCE_IN_LOADS = 10.0
"""In loads. A greater force of the proof is told."""


def print_report(
    run: Run,
    unit: LengthUnit,
    notes: Sequence[str] = (),
    margins: Sequence[Margin | None] | None = None,
    *,
    is_verbose: bool = False,
) -> None:
    """Print ``run`` to standard output, lengths in ``unit``; ``notes`` stand below the warnings.

    Of ``margins``, one for each phase, the last is shown; None: they were not asked for. ``is_verbose``: with what
    touches after each event, contacts without a force, and pose and proof of every phase.
    """
    print_all(*_parts(run, unit, screen_width(), notes, margins, is_verbose=is_verbose))


def report_text(run: Run, unit: LengthUnit = "mm") -> str:
    """Return what `print_report` prints, without colours."""
    width = text_width()
    return text_of(*_parts(run, unit, width), width=width)


def _parts(
    run: Run,
    unit: LengthUnit,
    width: int,
    notes: Sequence[str] = (),
    margins: Sequence[Margin | None] | None = None,
    *,
    is_verbose: bool = False,
) -> list[RenderableType]:
    writer = _Writer(run, unit, is_verbose=is_verbose)
    if margins is not None:
        writer.margin = press_lines(run) if run.phases[-1].press else margin_lines(margins[-1], writer.words)
    return [
        writer.title(),
        "",
        *event_table(run, writer.words, width, is_verbose=is_verbose),
        "",
        *force_table(run, writer.words, width, is_verbose=is_verbose),
        writer.summary(),
        *(Text(f"warning: {printable(warning)}", style="yellow") for warning in run.warnings),
        *(Text(note) for note in notes),
    ]


class _Writer:
    def __init__(self, run: Run, unit: LengthUnit, *, is_verbose: bool) -> None:
        self.run = run
        self.words = LengthWords(unit, run.scene.size_m)
        self.is_verbose = is_verbose
        self.margin: list[tuple[str, str]] = []

    def title(self) -> Text:
        title = Text(f"{self.run.scene.name}: ")
        title.append(self.run.verdict, style=STYLES[run_kind(self.run)])
        if self.run.is_contradicted:
            title.append(f" {CONTRADICTED}")
        return title.append(f"  ({self.run.method}, {duration(self.run.solve_s)})")

    def summary(self) -> Table:
        run = self.run
        table = Table.grid(padding=(0, 2))
        for name, value in (
            *(line for phase in run.phases[:-1] if self.is_verbose for line in self._end(phase)),
            ("pose", SLIPPED_OFF if self._is_off() else POSES.get(run.verdict, "")),
            *self._end(run.phases[-1]),
            ("turned", "; ".join(turned_far(run))),
            *drive_lines(run, self.words),
            ("verdict", _verdicts(run)),
            *((f"proof of {phase.name}", _proof(phase)) for phase in run.phases[:-1] if self.is_verbose),
            ("mechanics" if run.is_contradicted else "proof", _proof(run.phases[-1])),
            ("initial motion", self._onset()),
            ("critical friction", _critical(run)),
            *self.margin,
        ):
            if not value:
                continue
            table.add_row(Text(name), Text(value, overflow="fold"))
        return table

    def _end(self, phase: PhaseRun) -> list[tuple[str, str]]:
        """Where a phase has left the object, and what touches there."""
        pose, unit = phase.pose, self.words.unit
        center = pose.transform(self.run.scene.object.center_of_gravity_m)
        angles = ", ".join(short(math.degrees(angle), 6, 1e-10) for angle in pose.euler_zyx)
        after = "" if phase is self.run.phases[-1] else f" after {phase.name}"
        return [
            (f"position{after}", f"({self.words.lengths(pose.position_m)}) {unit}"),
            ("yaw, pitch, roll", f"({angles}) deg"),
            ("centre of gravity", f"({self.words.lengths(center)}) {unit}"),
            ("contacts", "; ".join(_contact_texts(phase, is_verbose=self.is_verbose)) or "none"),
        ]

    def _onset(self) -> str:
        """How the object begins to move where nothing stops it, or could begin to where it only may rest."""
        motion = self.run.phases[-1].proof.motion
        if motion is None or self.run.failed or self._is_off():
            return ""
        return self.words.onset(motion)

    def _is_off(self) -> bool:
        """Whether the run ends as what presses came off the object."""
        run = self.run
        return bool(bodies_off(run.scene, run.phases[-1], run.scene.loads[len(run.phases) - 1]))


def _contact_texts(phase: PhaseRun, *, is_verbose: bool) -> list[str]:
    """``pin1 and pin2 on plate``: the points of each box, in the order of the contacts."""
    points: dict[str, list[str]] = {}
    for contact in phase.contacts:
        names = points.setdefault(contact.box, [])
        if contact.point not in names:  # a point on an edge touches two faces
            names.append(contact.point)
    return [f"{listed(names, is_verbose=is_verbose)} on {box}" for box, names in points.items()]


def _verdicts(run: Run) -> str:
    return ", ".join(f"{phase.name}: {phase.verdict}{_firmness(phase)}" for phase in run.phases)


def _firmness(phase: PhaseRun) -> str:
    """How a held phase answers small disturbances, and which freedoms its load leaves open."""
    proof = phase.proof
    if phase.verdict not in AT_REST or proof.stability is None:
        return ""
    left = f", free to move in {' '.join(proof.undetermined)}" if proof.undetermined else ""
    return f" ({'stability not shown' if proof.stability == 'not shown' else proof.stability}{left})"


def _proof(phase: PhaseRun) -> str:
    proof = phase.proof
    if phase.verdict not in AT_REST | STOPPED:
        return ""
    sizes = [f"residual {proof.residual:.1e}"]
    if proof.gap_work is not None and abs(proof.gap_work) > LEAST_GAP_WORK:
        sizes.append(f"gap work {proof.gap_work:.1e}")
    if proof.largest_force is not None and proof.largest_force > LARGE_FORCE_IN_LOADS:
        sizes.append(f"largest force {proof.largest_force:.3g} loads")
    beside = " with the bodies where they stopped" if phase.verdict in STOPPED else ""
    return f"{proof.verdict}{beside}: {proof.reason} ({', '.join(sizes)})"


def _critical(run: Run) -> str:
    scene, texts = run.scene, list[str]()
    scale = greatest_friction(scene, chosen_method(scene, run.method).friction(scene)) if scene.friction_of else None
    for phase in run.phases:
        least = phase.proof.critical_friction
        if least is None:
            continue
        enough = "no friction is enough" if math.isinf(least) else friction_words(least, scale)
        texts.append(f"{phase.name}: {enough}")
    return ", ".join(texts)
