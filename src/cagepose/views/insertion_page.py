"""An insertion as one page: the mechanism, what came of its drive, and runs from just beyond what is permitted."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence

from markupsafe import Markup

from cagepose.files.units import LengthUnit
from cagepose.files.write import MADE_BY
from cagepose.runs.misaligned import OVERLAPS
from cagepose.runs.run import Run
from cagepose.runs.solve import run
from cagepose.studies.insertion_result import Insertion
from cagepose.studies.misalignment import MisalignmentEnd
from cagepose.views.insertion_figure import insertion_figure
from cagepose.views.style import figure_bytes, inner_svg
from cagepose.views.templates import environment
from cagepose.views.viewer.film import png_bytes
from cagepose.views.viewer.packed import packed_pages
from cagepose.views.viewer.playback import playback

NOMINAL = "nominal"
"""The run of the scene as it is."""


def insertion_page(
    insertion: Insertion,
    unit: LengthUnit,
    lines: Sequence[tuple[str, str]],
    meaning: str,
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
) -> str:
    """Return the page, which stands alone; the words are those of the terminal, see `cagepose.cli.insertion_report`."""
    found = insertion.run
    beyond = _runs_beyond(insertion)
    runs = {NOMINAL: found, **{name: one for name, (one, _) in beyond.items()}}
    played = {name: playback(one, unit) for name, one in runs.items()}
    phase = min(insertion.phase, len(found.phases) - 1)
    templates = environment("cagepose.views", "pages")
    return templates.get_template("insertion.jinja").render(
        made_by=MADE_BY,
        scene=found.scene.name,
        phase=found.scene.loads[insertion.phase].name,
        verdict=insertion.verdict,
        mechanism=b64encode(png_bytes(played[NOMINAL], phase)).decode(),
        lines=lines,
        meaning=meaning,
        headings=headings,
        rows=rows,
        links={name: _does_not_fail(one, end) for name, (one, end) in beyond.items()},
        figure=Markup(inner_svg(figure_bytes(insertion_figure(insertion, unit), ".svg"))),
        warnings=found.warnings,
        packed=Markup(packed_pages(played)),
    )


def _runs_beyond(insertion: Insertion) -> dict[str, tuple[Run, MisalignmentEnd]]:
    """Return the runs from where each side is no longer good, by freedom and side, such as ``x-below``."""
    runs = {}
    for name, found in insertion.misalignment.items():
        for end, side in ((found.low, "below"), (found.high, "above")):
            if end.fails_at and end.verdict != OVERLAPS:  # at 0 it is the run of the scene itself
                runs[f"{name}-{side}"] = run(insertion.scene_out_of_place(name, end.fails_at)), end
    return runs


def _does_not_fail(one: Run, end: MisalignmentEnd) -> str:
    """Return a remark if the search failed where a run does not: rounding decides, as the scene is drawn anew."""
    return f" (this run does not fail: {one.verdict})" if end.is_failure and not one.failed else ""
