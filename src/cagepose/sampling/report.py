"""The report of a study: a page that stands alone, its numbers as JSON, its pictures, and chosen runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from markupsafe import Markup

from cagepose import __version__
from cagepose.files.write import MADE_BY, json_text, write_whole
from cagepose.model.wording import number_or_dash, percent, range_or_dash
from cagepose.sampling.chosen_runs import write_runs
from cagepose.sampling.figures import draw
from cagepose.sampling.findings import Findings, document
from cagepose.sampling.results import StudyResults
from cagepose.views.style import figure_bytes
from cagepose.views.templates import environment

PAGE_NAME, NUMBERS_NAME = "report.html", "report.json"
PICTURES = (".svg", ".png")


def write_report(findings: Findings) -> list[Path]:
    """Write everything into the study's folder; return the files, the page first.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    folder, numbers = findings.results.folder.path, document(findings)
    figures = draw(findings)
    contents = {
        f"{name}{suffix}": figure_bytes(figure, suffix) for name, figure in figures.items() for suffix in PICTURES
    }
    contents[NUMBERS_NAME] = numbers_text(numbers).encode()
    contents[PAGE_NAME] = page_text(numbers, findings, {name: contents[f"{name}.svg"] for name in figures}).encode()
    for name, content in contents.items():
        write_whole(folder / name, content)
    return [*(folder / name for name in reversed(contents)), *write_runs(findings.results, findings.chosen)]


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


def page_text(numbers: dict[str, Any], findings: Findings, pictures: dict[str, bytes]) -> str:
    """Return the page."""
    templates = environment("cagepose.sampling")
    templates.filters |= {"number": number_or_dash, "percent": percent, "range": range_or_dash}
    svgs = {name: Markup(_inner_svg(content)) for name, content in pictures.items()}
    return templates.get_template("report.jinja").render(
        made_by=MADE_BY, found=numbers, pictures=svgs, planned=findings.n_planned
    )


def _inner_svg(content: bytes) -> str:
    """An SVG file without what stands before its first tag, to stand within a page."""
    text = content.decode()
    return text[text.index("<svg") :]
