"""A run as text: a table of events, then pose, contacts, warnings and verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.margin_report import margin_lines
from cagepose.errors import printable
from cagepose.files.units import LengthUnit
from cagepose.files.words import LengthWords, components, line_of, short
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.run import AT_REST, FAILURES, Event, PhaseRun, Run
from cagepose.studies.margin import Margin


def print_report(
    run: Run, unit: LengthUnit, notes: Sequence[str] = (), margins: Sequence[Margin | None] | None = None
) -> None:
    """Print ``run`` to standard output, lengths in ``unit``; ``notes`` stand below the warnings.

    Of ``margins``, one for each phase, the last is shown; None: they were not asked for.
    """
    writer = _Writer(run, unit)
    if margins is not None:
        writer.margin = margin_lines(margins[-1], unit)
    warnings = [Text(f"warning: {printable(warning)}", style="yellow") for warning in run.warnings]
    print_all(writer.title(), "", writer.events(), "", writer.summary(), *warnings, *(Text(note) for note in notes))


class _Writer:
    def __init__(self, run: Run, unit: LengthUnit) -> None:
        self.run = run
        self.words = LengthWords(unit, run.scene.size_m)
        self.margin: list[tuple[str, str]] = []

    def title(self) -> Text:
        solve_ms = self.run.solve_s * 1000.0
        title = Text(f"{self.run.scene.name}: ")
        title.append(self.run.verdict, style=verdict_style(self.run.verdict))
        return title.append(f"  ({self.run.method}, {solve_ms:.3g} ms)")

    def events(self) -> Table:
        table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
        for heading in ("#", "phase", "rule", "motion", "along / about", "amount", "hit", "contacts"):
            is_number = heading in ("#", "amount")
            table.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number, overflow="fold")
        number = 0
        for phase in self.run.phases:
            for event in phase.events:
                number += 1
                last = event is phase.events[-1]
                table.add_row(*self._event_row(number, phase.name, event, phase.verdict if last else None))
            table.add_section()
        return table

    def _event_row(self, number: int, phase: str, event: Event, verdict: str | None) -> list[Text]:
        if event.motion is None:
            motion = Text(verdict or "-", style=verdict_style(verdict) if verdict else "")
            along = amount = ""
        else:
            motion, along, amount = Text(event.motion.kind), line_of(event.motion), self.words.amount(event.motion)
        cells = (along, amount, " ".join(event.hit), " ".join(event.contacts))
        return [Text(str(number)), Text(phase), Text(event.rule), motion, *(Text(cell) for cell in cells)]

    def summary(self) -> Table:
        run = self.run
        table = Table.grid(padding=(0, 2))
        angles = ", ".join(short(math.degrees(angle), 6, 1e-10) for angle in run.pose.euler_zyx)
        for name, value in (
            ("position", f"({self.words.lengths(run.pose.position_m)}) {self.words.unit}"),
            ("yaw, pitch, roll", f"({angles}) deg"),
            ("centre of gravity", f"({self.words.lengths(run.center_of_gravity_world)}) {self.words.unit}"),
            ("contacts", ", ".join(_contact_texts(run)) or "none"),
            ("forces", _forces(run)),
            ("verdict", _verdicts(run)),
            ("proof", _proof(run)),
            ("onset", self._onset()),
            ("critical friction", _critical(run)),
            *self.margin,
        ):
            if not value:
                continue
            table.add_row(Text(name), Text(value, overflow="fold"))
        return table

    def _onset(self) -> str:
        """How the object begins to move where nothing stops it, or could begin to where it only may rest."""
        motion = self.run.phases[-1].proof.motion
        if motion is None or self.run.failed:
            return ""
        if motion.direction_world is not None:
            return f"travel along ({components(motion.direction_world)})"
        assert motion.axis_world is not None
        assert motion.through_world is not None
        line = (
            f"({components(motion.axis_world)}) through ({self.words.lengths(motion.through_world)}) {self.words.unit}"
        )
        pitch = (
            f", {self.words.lengths([motion.pitch_m])} {self.words.unit} along it per radian"
            if motion.kind == "screw"
            else ""
        )
        return f"{motion.kind} about {line}{pitch}"


def _contact_texts(run: Run) -> list[str]:
    """``pin1 and pin2 on plate``: the points of each box, in the order of the contacts."""
    points: dict[str, list[str]] = {}
    for contact in run.contacts:
        names = points.setdefault(contact.box, [])
        if contact.point not in names:  # a point on an edge touches two faces
            names.append(contact.point)
    return [f"{' '.join(names)} on {box}" for box, names in points.items()]


def _forces(run: Run) -> str:
    """``of the load: C1 0.5, C3 0.5 (+ 0.05 sideways)``: what presses at the end; or ``in newtons: ...``."""
    texts = []
    for contact in run.contacts:
        if contact.force_normal_n:
            sideways = math.hypot(*contact.force_tangential_n) if contact.force_tangential_n is not None else 0.0
            beside = f" (+ {sideways:.4g} sideways)" if sideways > 1e-9 * contact.force_normal_n else ""
            texts.append(f"{contact.point} {contact.force_normal_n:.4g}{beside}")
    shared = run.phases[-1].proof.shared
    if shared:
        texts.append(f"one way of many to share the load between {' '.join(shared)}")
    in_newtons = scaled_load(run.scene, run.scene.loads[len(run.phases) - 1]).in_newtons
    return f"{'in newtons' if in_newtons else 'of the load'}: {', '.join(texts)}" if texts else ""


def _verdicts(run: Run) -> str:
    return ", ".join(f"{phase.name}: {phase.verdict}{_firmness(phase)}" for phase in run.phases)


def _firmness(phase: PhaseRun) -> str:
    """How a held phase answers small disturbances, and which freedoms its load leaves open."""
    proof = phase.proof
    if phase.verdict not in AT_REST or proof.stability is None:
        return ""
    left = f", free along {' '.join(proof.undetermined)}" if proof.undetermined else ""
    return f" ({'stability not shown' if proof.stability == 'not shown' else proof.stability}{left})"


def _proof(run: Run) -> str:
    proof = run.phases[-1].proof
    if run.phases[-1].verdict not in AT_REST:
        return ""
    return f"{proof.verdict}: {proof.reason} (residual {proof.residual:.1e})"


def _critical(run: Run) -> str:
    texts = []
    for phase in run.phases:
        least = phase.proof.critical_friction
        if least is not None:
            texts.append(f"{phase.name}: {'none is enough' if math.isinf(least) else f'{least:.10g}'}")
    return ", ".join(texts)


def verdict_style(verdict: str) -> str:
    """Return the colour of a verdict."""
    if verdict in AT_REST:
        return "bold green"
    return "bold red" if verdict in FAILURES else "bold yellow"
