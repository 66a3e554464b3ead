"""The report of a study: a page that stands alone and plays chosen runs, its numbers as JSON, pictures, and scenes."""

from __future__ import annotations

import json
from base64 import b64encode
from pathlib import Path
from typing import Any

from markupsafe import Markup

from cagepose import __version__
from cagepose.files.write import MADE_BY, json_text, write_whole
from cagepose.model.wording import number_or_dash, percent, range_or_dash
from cagepose.sampling.chosen_runs import NOMINAL, REPORT, played_runs, write_scenes
from cagepose.sampling.figures import draw
from cagepose.sampling.findings import Findings, document
from cagepose.sampling.results import StudyResults
from cagepose.views.style import figure_bytes, inner_svg
from cagepose.views.templates import environment
from cagepose.views.viewer.film import png_bytes
from cagepose.views.viewer.packed import packed_pages
from cagepose.views.viewer.playback import Playback

NUMBERS_NAME, MECHANISM_NAME = "report.json", "mechanism.png"
PICTURES = (".svg", ".png")


def write_report(findings: Findings) -> list[Path]:
    """Write everything into the study's folder; return the files, the page first.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    folder, numbers = findings.results.folder.path, document(findings)
    figures, played = draw(findings), played_runs(findings.results, findings.chosen)
    contents = {
        f"{name}{suffix}": figure_bytes(figure, suffix) for name, figure in figures.items() for suffix in PICTURES
    }
    contents[MECHANISM_NAME] = png_bytes(played[NOMINAL])
    contents[NUMBERS_NAME] = numbers_text(numbers).encode()
    svgs = {name: contents[f"{name}.svg"] for name in figures}
    contents[REPORT] = page_text(numbers, findings, svgs, contents[MECHANISM_NAME], played).encode()
    for name, content in contents.items():
        write_whole(folder / name, content)
    return [*(folder / name for name in reversed(contents)), *write_scenes(findings.results, findings.chosen)]


def numbers_text(numbers: dict[str, Any]) -> str:
    """Return the numbers as JSON, the maps' cells on one line."""
    return json_text({key: value for key, value in numbers.items() if key != "maps"}, maps=numbers["maps"])


def kept_numbers(results: StudyResults) -> dict[str, Any] | None:
    """Return the numbers of a report that was written of these rows; None: there is none, of fewer rows, or of another
    cagepose.
    """
    try:
        numbers: dict[str, Any] = json.loads((results.folder.path / NUMBERS_NAME).read_text(encoding="utf-8"))
        is_of_these = (numbers["version"], numbers["runs"]) == (__version__, len(results))
        return numbers if is_of_these else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def page_text(
    numbers: dict[str, Any],
    findings: Findings,
    pictures: dict[str, bytes],
    mechanism: bytes,
    played: dict[str, Playback],
) -> str:
    """Return the page; ``mechanism``: the picture that it begins with, PNG."""
    templates = environment("cagepose.sampling")
    templates.filters |= {"number": number_or_dash, "percent": percent, "range": range_or_dash}
    svgs = {name: Markup(inner_svg(content)) for name, content in pictures.items()}
    return templates.get_template("report.jinja").render(
        made_by=MADE_BY,
        found=numbers,
        pictures=svgs,
        planned=findings.n_planned,
        mechanism=b64encode(mechanism).decode(),
        nominal=played[NOMINAL].run.verdict,
        packed=Markup(packed_pages(played)),
    )
