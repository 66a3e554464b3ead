"""A run as text: a table of events, then pose, contacts, warnings and verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from cagepose.cli.console import fits_screen, print_all
from cagepose.cli.margin_report import margin_lines
from cagepose.errors import printable
from cagepose.files.units import LengthUnit
from cagepose.files.words import LengthWords, components, line_of, names_of
from cagepose.model.wording import short
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import AT_REST, FAILURES, Event, PhaseRun, Run
from cagepose.studies.margin import Margin

POSES = {
    "escapes": "where nothing is ahead any more; the object goes on from here",
    **dict.fromkeys(FAILURES, "where the run stopped; it is no end"),
}
"""Where the pose is taken from, if it is not that of a rest."""
NO_GAP_WORK, LARGE_FORCE = 1e-12, 10.0
"""Of the proof's numbers, those above these are told: more than rounding, and more than ten loads."""


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
    events: list[RenderableType] = [writer.events(), ""]
    if not fits_screen(events[0]):
        events = writer.events_of_phases()
    print_all(writer.title(), "", *events, writer.summary(), *warnings, *(Text(note) for note in notes))


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
        table = _table("#", "phase", "rule", "motion", "along / about", "amount", "hit", "contacts")
        number = 0
        for phase in self.run.phases:
            for event in phase.events:
                number += 1
                moved = self._moved(event, phase)
                names = (Text(names_of(event.hit)), Text(names_of(event.contacts)))
                table.add_row(Text(str(number)), Text(phase.name), *moved, *names)
            table.add_section()
        return table

    def events_of_phases(self) -> list[RenderableType]:
        """The same for a screen on which names leave no room: a table for each phase, its contacts below it."""
        parts, number = list[RenderableType](), 0
        for phase in self.run.phases:
            table, touching = _table("#", "rule", "motion", "along / about", "amount"), Table.grid(padding=(0, 1))
            for event in phase.events:
                number += 1
                table.add_row(Text(str(number)), *self._moved(event, phase))
                hit = f"hits {names_of(event.hit)}; " if event.hit else ""
                touching.add_row(Text(f"{number}:"), Text(f"{hit}touching {names_of(event.contacts) or 'nothing'}"))
            parts += [Text(f"{phase.name}:"), table, touching, ""]
        return parts

    def _moved(self, event: Event, phase: PhaseRun) -> list[Text]:
        """Rule, motion (or, where nothing moved, what the phase came to), line and amount of an event."""
        if event.motion is not None:
            motion = event.motion
            return [Text(text) for text in (event.rule, motion.kind, line_of(motion), self.words.amount(motion))]
        verdict = phase.verdict if event is phase.events[-1] else None
        came_to = Text(verdict or "-", style=verdict_style(verdict) if verdict else "")
        return [Text(event.rule), came_to, Text(""), Text("")]

    def summary(self) -> Table:
        run = self.run
        table = Table.grid(padding=(0, 2))
        angles = ", ".join(short(math.degrees(angle), 6, 1e-10) for angle in run.pose.euler_zyx)
        for name, value in (
            ("pose", POSES.get(run.verdict, "")),
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


def _table(*headings: str) -> Table:
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in headings:
        is_number = heading in ("#", "amount")
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number, overflow="fold")
    return table


def _contact_texts(run: Run) -> list[str]:
    """``pin1 and pin2 on plate``: the points of each box, in the order of the contacts."""
    points: dict[str, list[str]] = {}
    for contact in run.contacts:
        names = points.setdefault(contact.box, [])
        if contact.point not in names:  # a point on an edge touches two faces
            names.append(contact.point)
    return [f"{names_of(names)} on {box}" for box, names in points.items()]


def _forces(run: Run) -> str:
    """``of the load: C1 0.5, C3 0.5 (+ 0.05 sideways)``: what presses at the end; or ``in newtons: ...``."""
    texts = []
    for contact in run.contacts:
        if contact.force_normal_n:
            sideways = math.hypot(*contact.force_tangential_n) if contact.force_tangential_n is not None else 0.0
            beside = f" (+ {sideways:.4g} sideways)" if sideways > 1e-9 * contact.force_normal_n else ""
            name = f"{contact.point}:" if " " in contact.point else contact.point
            texts.append(f"{name} {contact.force_normal_n:.4g}{beside}")
    shared = run.phases[-1].proof.shared
    if shared:
        texts.append(f"one way of many to share the load between {names_of(shared)}")
    unit = force_unit(run.scene, run.scene.loads[len(run.phases) - 1])
    return f"{'in newtons' if unit == 'N' else 'of the load'}: {', '.join(texts)}" if texts else ""


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
    sizes = [f"residual {proof.residual:.1e}"]
    if proof.gap_work is not None and abs(proof.gap_work) > NO_GAP_WORK:
        sizes.append(f"gap work {proof.gap_work:.1e}")
    if proof.largest_force is not None and proof.largest_force > LARGE_FORCE:
        sizes.append(f"largest force {proof.largest_force:.3g} loads")
    return f"{proof.verdict}: {proof.reason} ({', '.join(sizes)})"


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
