"""The report: it stands alone, shows every number and every picture, and destroys nobody's work."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cagepose.paper import cases, comparison, reproduction
from cagepose.paper.comparison import Printed, Row
from cagepose.paper.figures import FIGURES, Picture
from cagepose.paper.report import check_report_folder, report_files, report_text, write_report
from cagepose.paper.reproduction import METHODS, reproduce

VOID = {"meta", "img", "link", "br", "hr", "input"}


class Page(HTMLParser):
    """What a browser would see: references, images, cells; and whether tags are closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.references: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.cells: list[str] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.tags.append(tag)
        self.references += [found[name] for name in ("src", "href", "srcset", "action", "data") if name in found]
        if tag == "img":
            self.images.append(found)
        if tag in ("td", "th"):
            self.cells.append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.cells[-1] += data


@pytest.fixture(scope="module")
def result():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cases, "TIMED_RUNS", 1)
        patch.setattr(reproduction, "RANGE_RAD", np.radians([-0.5, 0.0, 0.5]))
        return reproduce(METHODS, lambda _: None)


@pytest.fixture(scope="module")
def written(result, tmp_path_factory):
    return write_report(tmp_path_factory.mktemp("reports") / "new", result, lambda _: None)


@pytest.fixture(scope="module")
def page(written):
    return Page(written[0].read_text(encoding="utf-8"))


def test_the_files_are_those_announced(written):
    assert [path.name for path in written] == ["report.html", "report.md", *(path.name for path in written[2:])]
    assert sorted(path.name for path in written) == sorted(report_files(METHODS))
    assert sorted(path.name for path in written[0].parent.iterdir()) == sorted(report_files(METHODS))


def test_the_page_needs_nothing_from_outside(written, page):
    """No address, no script, no style sheet, no font: every reference is data within the page."""
    text = written[0].read_text(encoding="utf-8")
    assert page.references
    assert all(reference.startswith("data:image/png;base64,") for reference in page.references)
    assert not re.search(r"https?:|//\w|@import|url\(", re.sub(r'src="data:[^"]*"', "", text))
    assert not {"script", "link", "iframe", "object", "form"} & set(page.tags)
    assert page.open == []


def test_every_image_decodes_and_says_what_it_shows(page, written):
    assert len(page.images) == 14
    for image in page.images:
        content = base64.b64decode(image["src"].partition(",")[2], validate=True)
        with Image.open(io.BytesIO(content)) as picture:
            picture.load()
            assert picture.size[0] == 1500
            assert np.asarray(picture.convert("L")).std() > 5.0  # not an empty sheet
        assert len(image["alt"]) > 40
        assert content in [path.read_bytes() for path in written if path.suffix == ".png"]


def test_the_markdown_shows_pictures_that_lie_beside_it(written):
    text = written[1].read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    assert len(pictures) == 14
    assert all((written[1].parent / name).is_file() for name in pictures)
    assert "http" not in text


def test_page_and_markdown_hold_every_row(result, written, page):
    markdown = written[1].read_text(encoding="utf-8").replace("\\", "")
    for row in result.rows:
        cells = comparison.cells(row)
        place = page.cells.index(cells[1])
        assert page.cells[place - 1 : place + len(cells) - 1] == cells
        assert "| " + " | ".join(cells) + " |" in markdown


def test_numbers_are_shown_in_the_papers_units_with_three_more_digits(result):
    cells = {row.quantity: comparison.cells(row) for row in result.rows}
    assert comparison.headings(METHODS) == [
        "section", "quantity", "paper", "stepwise", "quasistatic", "closed form", "difference", "explanation",
    ]  # fmt: skip
    assert cells["A-2: turn"][2:7] == ["28.96 deg", "28.95502 deg", "-", "28.95502 deg", "-0.00498 deg"]
    assert cells["pitch after the weight"][2:7] == ["0.392 deg", *3 * ["0.413084 deg"], "+0.021084 deg"]
    assert cells["pitch up to which the push lowers the pins"][2:7] == ["< 5 deg", "-", "-", "5.781 deg", "+0.781 deg"]
    assert cells["A-1: travel"][2:7] == ["5 mm", "5.000 mm", "5.000 mm", "5.000 mm", "0 mm"]
    assert cells["roll after the push"][-1].startswith("Not derivable. ")
    assert cells["time of the run"][-1].startswith("Measured. ")


def test_a_method_without_such_a_thing_gets_a_dash():
    row = Row("I", "angle", Printed("0.5", "rad"), {"stepwise": 0.6, "other": None}, 0.7, "differs", "Why.")
    assert comparison.cells(row) == [
        "I", "angle", "0.5 rad", "0.6000 rad", "-", "0.7000 rad", "+0.1000 rad", "Differs. Why.",
    ]  # fmt: skip
    assert comparison.error_cells(row) == ["angle", "-1.0e-01 rad", "-"]


def test_markup_in_texts_is_shown_and_not_obeyed(result):
    found = {"stepwise": 0.6, "quasistatic": None}
    odd = Row("<td>", "|a|", Printed("*x*"), found, "<td>", "differs", "a <b> & 'c'")
    picture = Picture(b"", b"")
    pictures = {f"{method}-{name}": picture for method in METHODS for name in FIGURES}
    page, text = (report_text(form, replace(result, rows=(odd,)), pictures) for form in ("html", "markdown"))
    cells = Page(page).cells
    assert cells[len(comparison.headings(METHODS)) :][:3] == ["<td>", "|a|", "*x*"]
    assert "a &lt;b&gt; &amp; &#39;c&#39;" in page
    assert r"| \<td\> | \|a\| | \*x\* |" in text
    assert r"Differs. a \<b\> & 'c' |" in text


def test_a_report_may_replace_an_earlier_one_and_leaves_other_files_alone(result, written, monkeypatch, tmp_path: Path):
    for path in written:
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    monkeypatch.setattr("cagepose.paper.report.draw_pictures", lambda *_: {})
    monkeypatch.setattr("cagepose.paper.report.report_text", lambda *_: "<h1>Short</h1>")
    write_report(tmp_path, result, lambda _: None)
    assert (tmp_path / "notes.txt").read_text(encoding="utf-8") == "mine"
    assert "<h1>Short</h1>" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["report.html", "report.md", "stepwise-range.png", "stepwise-rail-yaw.svg"])
def test_somebody_elses_file_is_not_replaced(result, tmp_path: Path, name):
    (tmp_path / name).write_bytes(b"mine")
    with pytest.raises(FileExistsError, match=f"{name} holds something else than a file of an earlier report"):
        write_report(tmp_path, result, lambda _: None)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"mine"


def test_folders_that_cannot_be_are_refused(tmp_path: Path):
    (tmp_path / "file").write_bytes(b"mine")
    (tmp_path / "full" / "report.md").mkdir(parents=True)
    for folder, message in (
        (tmp_path / "file", "is not a folder; name one, or a new one"),
        (tmp_path / "none" / "new", "the folder that it would lie in does not exist"),
        (tmp_path / "full", "report.md is a directory"),
        ("a\0b", "is not a folder's name"),
    ):
        with pytest.raises(OSError, match=re.escape(message)):
            check_report_folder(folder, METHODS)
