"""Sphinx settings. Everything is built and read offline: no web fonts, no scripts from the network."""

from __future__ import annotations

import itertools
import re
from importlib.metadata import version as installed_version
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

import latex2mathml.converter
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.config import Config
from sphinx.writers.html5 import HTML5Translator

from cagepose import Design, Study, insertion, load_scene, play, run
from cagepose.files.scene_file import read_scene_file
from cagepose.model.wording import percent
from cagepose.paper.report import write_report
from cagepose.paper.reproduction import METHODS, reproduce
from cagepose.views.insertion_figure import insertion_figure
from cagepose.views.play_figure import play_figure
from cagepose.views.style import figure_bytes
from cagepose.views.viewer.film import png_bytes
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback

project = "cagepose"
author = "the cagepose developers"
copyright = author
release = version = installed_version("cagepose")

extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc"]
exclude_patterns = ["generated"]  # included by the page about the paper
highlight_language = "python"

html_theme = "furo"
html_title = f"cagepose {version}"
html_show_copyright = False
html_math_renderer = "mathml"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "FloatArray": "FloatArray"}
autodoc_default_options = {"members": True}
python_use_unqualified_type_names = True
autoclass_content = "both"  # what a class raises stands in the docstring of its __init__
numpydoc_show_class_members = False  # autodoc lists them


def _mathml(node: nodes.Element, display: str) -> str:
    """Write an equation as MathML, which browsers draw themselves; MathJax would be loaded from the network."""
    return latex2mathml.converter.convert(node.astext(), display=display)


def _inline_math(translator: HTML5Translator, node: nodes.Element) -> None:
    translator.body.append(_mathml(node, "inline"))
    raise nodes.SkipNode


def _display_math(translator: HTML5Translator, node: nodes.Element) -> None:
    translator.body.append(translator.starttag(node, "div", CLASS="math"))
    if node["number"]:
        translator.body.append(f'<span class="eqno">({node["number"]})</span>')
    translator.body.append(_mathml(node, "block"))
    translator.body.append("</div>")
    raise nodes.SkipNode


def _plain_aliases(*event: object) -> tuple[str, str] | None:
    """Name a type alias as the source does: autodoc wraps it where it stands in a union."""
    signature, returns = event[-2:]
    if signature is None:
        return None
    return tuple(re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", part or "") for part in (signature, returns))


def _reproduce(app: Sphinx) -> None:
    """Run the paper's cases, so that the page about them shows what this very source finds."""
    reproduction = reproduce(METHODS, lambda _: None)
    write_report(Path(app.srcdir) / "generated", reproduction, lambda _: None)


def _draw_play(app: Sphinx) -> None:
    """Draw the play of the two scenes on the page about it."""
    folder = Path(app.srcdir) / "generated"
    folder.mkdir(exist_ok=True)
    for name, point_m in (("rail-pitch", (-0.6, 0.02, -0.060747)), ("gripper", (0.04, 0.0, 0.0))):
        found = play(load_scene(Path(app.srcdir).parent / "scenes" / f"{name}.yaml"))
        (folder / f"play-{name}.svg").write_bytes(figure_bytes(play_figure(found, [point_m]), ".svg"))


def _draw_insertion(app: Sphinx) -> None:
    """Ask the scene about its insertion that the page about it shows, and draw the answer."""
    folder = Path(app.srcdir) / "generated"
    folder.mkdir(exist_ok=True)
    found = insertion(load_scene(Path(app.srcdir).parent / "scenes" / "dock.yaml"), along=["z", "pitch"])
    (folder / "insertion-dock.svg").write_bytes(figure_bytes(insertion_figure(found), ".svg"))


def _comment(scene_file: Path) -> str:
    """Return the first paragraph of the comment that a scene file begins with."""
    lines = scene_file.read_text(encoding="utf-8").splitlines()
    paragraph = itertools.takewhile(lambda line: line.startswith("# "), lines)
    return " ".join(line.removeprefix("# ") for line in paragraph)


def _gallery(app: Sphinx, _config: Config) -> None:
    """Run every scene and write its picture, its page and a few words."""
    generated = Path(app.srcdir) / "generated"
    for folder in ("pictures", "playable/play"):
        (generated / folder).mkdir(parents=True, exist_ok=True)
    words = []
    for scene_file in sorted((Path(app.srcdir).parent / "scenes").glob("*.yaml")):
        source = read_scene_file(scene_file)
        answer = run(source.scene)
        shown = playback(answer, source.length_unit)
        name = scene_file.stem
        (generated / "pictures" / f"{name}.png").write_bytes(png_bytes(shown))
        (generated / "playable/play" / f"{name}.html").write_text(page(shown), encoding="utf-8")
        link = f'<a href="play/{name}.html">Play it</a> ({answer.verdict}, {answer.method})'
        picture = f"![The end of the run of {name}](pictures/{name}.png)"
        words += [f"## {source.scene.name}", _comment(scene_file), picture, link]
    (generated / "gallery.md").write_text("\n\n".join(words) + "\n", encoding="utf-8")


def _studies(app: Sphinx, _config: Config) -> None:
    """Run every worked study and design, and write its page, a picture and a few words."""
    generated = Path(app.srcdir) / "generated"
    words = []
    for file in sorted((Path(app.srcdir).parent / "scenes" / "studies").glob("*.yaml")):
        text, name = file.read_text(encoding="utf-8"), file.stem
        pages = generated / "playable/study" / name
        pages.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory() as folder:
            if "\nwish:" in text:
                found = Design.load(file).run()
                found.write(folder)
                picture, told = "design.png", f"{found.sentence()}."
            elif "\nvary:" in text:
                report = Study.load(file).run(folder).report()
                is_all_good = all(min(map(min, one["accepted_cells"])) for one in report["maps"])
                picture = "spread.png" if is_all_good else "map.png"
                told = f'<a href="study/{name}/report.html">Its report</a> (yield {percent(report["yield"]["share"])})'
            else:
                continue  # a scene of theirs
            for written in (*Path(folder).glob("*.html"), *Path(folder).glob("*.yaml")):
                copy(written, pages)
            copy(Path(folder) / picture, generated / "pictures" / f"study-{name}.png")
        words += [f"## {name}", _comment(file), f"![A picture of {name}](pictures/study-{name}.png)", told]
    (generated / "studies.md").write_text("\n\n".join(words) + "\n", encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Register the equations' writer, the repair of signatures, and what draws the gallery, play and the report."""
    app.connect("config-inited", _gallery, priority=100)  # before Sphinx looks for the pages in `html_extra_path`
    app.connect("config-inited", _studies, priority=101)
    app.connect("builder-inited", _reproduce)
    app.connect("builder-inited", _draw_play)
    app.connect("builder-inited", _draw_insertion)
    app.connect("autodoc-process-signature", _plain_aliases)
    app.add_html_math_renderer("mathml", (_inline_math, None), (_display_math, None))


html_extra_path = ["generated/playable"]
html_static_path = ["_static"]
html_css_files = ["equations.css", "tables.css"]
