"""The report of the paper's cases: `templates/report.jinja`, filled in once as HTML and once as Markdown."""

from __future__ import annotations

import os
import platform
import re
from base64 import b64encode
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from markdown_it import MarkdownIt
from markupsafe import Markup

import cagepose
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, write_whole
from cagepose.paper import cases
from cagepose.paper.cases import Progress
from cagepose.paper.comparison import cells, error_cells, headings
from cagepose.paper.figures import FIGURES, Picture, draw_pictures
from cagepose.paper.range_study import RangeStudy
from cagepose.paper.reproduction import Reproduction
from cagepose.paper.tables import end_rows, planar_rows
from cagepose.views.templates import environment

Form = Literal["html", "markdown"]
NAMES: dict[Form, str] = {"html": "report.html", "markdown": "report.md"}


TITLE = "The paper, reproduced"


def report_text(form: Form, reproduction: Reproduction, pictures: Mapping[str, Picture]) -> str:
    """Return the whole report: as Markdown that names the files of its pictures, or as a page that holds them."""
    templates = environment("cagepose.paper")
    if form == "markdown":
        templates.finalize = _escaped_for_markdown
    templates.globals |= {"title": TITLE, "made_by": MADE_BY}
    text = templates.get_template("report.jinja").render(form=f"{form}.jinja", **_content(reproduction))
    text = re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"
    if form == "markdown":
        return text
    body = Markup(MarkdownIt("commonmark", {"html": True}).render(text))
    page = templates.get_template("page.jinja").render(body=body)
    return re.sub(r'src="([\w-]+)\.png"', lambda source: _embedded(pictures[source[1]]), page)


def _content(reproduction: Reproduction) -> dict[str, Any]:
    methods, rows = reproduction.methods, reproduction.rows
    return {
        "version": cagepose.__version__,
        "machine": f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}",
        "timed_runs": cases.TIMED_RUNS,
        "methods": methods,
        "headings": headings(methods),
        "number_rows": [cells(row) for row in rows],
        "statuses": [row.status for row in rows],
        "error_rows": [
            error_cells(row)
            for row in rows
            if row.status != "not derivable" and any(row.error(method) is not None for method in methods)
        ],
        "end_rows": end_rows(reproduction.runs),
        "planar_rows": planar_rows(),
        "ranges": reproduction.ranges,
        "where": _where,
        "ends": lambda study: ", ".join(f"{count} {verdict}" for verdict, count in Counter(study.verdicts).items()),
    }


def _escaped_for_markdown(value: object) -> Markup:
    r"""Escape what Markdown would take for markup, unless a template wrote it: Jinja itself escapes for HTML alone.

    >>> str(_escaped_for_markdown("|a| < 5 *deg*"))
    '\\|a\\| \\< 5 \\*deg\\*'
    """
    return value if isinstance(value, Markup) else Markup(re.sub(r"([\\|*_<>`\[\]#])", r"\\\1", str(value)))


def _embedded(picture: Picture) -> str:
    return f'src="data:image/png;base64,{b64encode(picture.png).decode()}"'


def _where(study: RangeStudy, chosen: np.ndarray) -> str:
    if not chosen.any():
        return "at no misalignment"
    angles = np.degrees(study.misalignments_rad[chosen])
    return f"at {chosen.sum()} of {len(chosen)} misalignments ({angles[0]:+.3f} to {angles[-1]:+.3f} deg)"


def report_files(methods: Sequence[str]) -> list[str]:
    """Return the names of all files that `write_report` writes."""
    figures = [f"{method}-{figure}{suffix}" for method in methods for figure in FIGURES for suffix in (".png", ".svg")]
    return [*NAMES.values(), *figures]


def check_report_folder(folder: str | os.PathLike[str], methods: Sequence[str]) -> None:
    """Find out before the runs whether `write_report` can write into ``folder``, which it makes if it is not there.

    Raises
    ------
    OSError
        It cannot: a file of that name, no folder to make it in, no permission, or a file of somebody else under a name
        that the report needs. Says which file.
    """
    if "\0" in os.fspath(folder):
        raise OSError("is not a folder's name; remove the unprintable character")
    target = Path(folder)
    if target.is_dir():
        for name in report_files(methods):
            try:
                check_can_write(target / name, is_made_by_us, "a file of an earlier report")
            except OSError as error:
                raise type(error)(f"{name} {error.strerror or error}") from None
    elif target.exists():
        raise NotADirectoryError("is not a folder; name one, or a new one")
    elif not target.parent.is_dir():
        raise FileNotFoundError("cannot be made, as the folder that it would lie in does not exist; make that first")
    elif not os.access(target.parent, os.W_OK | os.X_OK):
        raise PermissionError("cannot be made, as the folder that it would lie in cannot be written; name another")


def write_report(
    folder: str | os.PathLike[str],
    reproduction: Reproduction,
    progress: Progress,
    pictures: dict[str, Picture] | None = None,
) -> list[Path]:
    """Write the report into ``folder``: a page that stands alone, the same as Markdown, and the pictures.

    ``pictures`` are those of an earlier report, by name: they are not drawn again, and new ones are added to them.

    Returns
    -------
    list of Path
        What was written, the page first.

    Raises
    ------
    OSError
        See `check_report_folder`; or the disk is full.
    """
    check_report_folder(folder, reproduction.methods)
    pictures = {} if pictures is None else pictures
    new = [method for method in reproduction.methods if f"{method}-{FIGURES[-1]}" not in pictures]
    pictures |= draw_pictures(reproduction, new, progress)
    contents = {name: report_text(form, reproduction, pictures).encode() for form, name in NAMES.items()}
    for name, picture in pictures.items():
        contents |= {f"{name}.png": picture.png, f"{name}.svg": picture.svg}
    target = Path(folder)
    target.mkdir(exist_ok=True)
    for name, content in contents.items():
        write_whole(target / name, content)
    return [target / name for name in contents]
