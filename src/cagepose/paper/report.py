"""The files of the report of the paper's cases."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from cagepose.files.write import check_can_write, is_made_by_us, write_whole
from cagepose.paper.blocks import Picture
from cagepose.paper.report_content import TITLE, report_blocks
from cagepose.paper.report_html import html_page
from cagepose.paper.report_markdown import markdown_text
from cagepose.paper.reproduction import Progress, Reproduction

HTML_NAME, MARKDOWN_NAME = "report.html", "report.md"
FIGURES = ("sample-events", "sample-pose", "rail-events", "rail-pitch", "rail-yaw", "rail-roll", "range")
"""Stems of each method's pictures; the method's name stands before them."""


def report_files(methods: Sequence[str]) -> list[str]:
    """Return the names of all files that `write_report` writes."""
    figures = [f"{method}-{figure}{suffix}" for method in methods for figure in FIGURES for suffix in (".png", ".svg")]
    return [HTML_NAME, MARKDOWN_NAME, *figures]


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


def write_report(folder: str | os.PathLike[str], reproduction: Reproduction, progress: Progress) -> list[Path]:
    """Write the report into ``folder``: a page that stands alone, the same as Markdown, and the pictures.

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
    blocks = list(report_blocks(reproduction, progress))
    contents = {
        HTML_NAME: html_page(TITLE, blocks).encode(),
        MARKDOWN_NAME: markdown_text(blocks).encode(),
    }
    for block in blocks:
        if isinstance(block, Picture):
            contents |= {f"{block.stem}.png": block.png, f"{block.stem}.svg": block.svg}
    target = Path(folder)
    target.mkdir(exist_ok=True)
    for name, content in contents.items():
        write_whole(target / name, content)
    return [target / name for name in contents]
