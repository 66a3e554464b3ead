"""What a design has found, in words, as plain data, as a picture, and as files."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

import cagepose
from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import SCENE_NAME, STUDY_NAME, copies
from cagepose.files.write import check_can_write, is_made_by_us, json_text, write_whole
from cagepose.model.wording import percent
from cagepose.runs.methods import chosen_method
from cagepose.views.style import BLACK, BLUE, GREEN, PAGE_WIDTH_IN, VERMILLION, figure_bytes, styled

if TYPE_CHECKING:
    from cagepose.sampling.design import DesignResults

LOOSEST_NAME, MARK = "loosest.yaml", "# The loosest value that keeps the wish, made by cagepose design."


def wish_text(results: DesignResults) -> str:
    """Return what was wished: "yield >= 99.700 %", "capture range of parameters.pitch >= 0.5"."""
    wish = results.file.model.wish
    if wish.share is not None:
        return f"yield >= {percent(wish.share)}"
    ((key, width),) = (wish.capture or {}).items()
    return f"capture range of {key} >= {width:g}"


def reached_text(results: DesignResults, reached: float) -> str:
    """Return a yield in percent, or a range as it is."""
    return percent(reached) if results.file.model.wish.share is not None else f"{reached:.5g}"


def sentence(results: DesignResults) -> str:
    """Return what was found, in a few sentences."""
    found, key, wish = results.trade_off, results.file.study.varied[-1].key, wish_text(results)
    ends = f"{results.file.tight:g} to {results.file.loose:g}"
    if found.loosest is None:
        best = max(found.points, key=lambda point: point.reached)
        return f"no {key} from {ends} keeps {wish}: at best {reached_text(results, best.reached)}, at {best.value:.5g}"
    if found.loosest == results.file.loose:
        told = f"{key} = {found.loosest:.5g}, the loose end, still keeps {wish}; looser values were not asked"
    else:
        told = f"{key} = {found.loosest:.5g} is the loosest that keeps {wish}, to within {found.accuracy:.1g}"
    if not found.is_monotone:
        ranges = " and ".join(f"{low:.5g} to {high:.5g}" for low, high in found.kept)
        told += f"; not all tighter values keep it: {ranges} alone"
    if results.file.model.wish.share is not None:
        told += f"; {_confidence(results)}"
    return told


def _confidence(results: DesignResults) -> str:
    surely, perhaps = results.trade_off.between
    to = "" if perhaps == results.file.loose else f" and {perhaps:.5g}"
    if surely is None:
        n_runs = results.file.study.model.sample.runs
        return f"but no value keeps it with 95 % confidence by {n_runs} runs: ask for more"
    if not to:
        return f"with 95 % confidence at least {surely:.5g}"
    return f"with 95 % confidence between {surely:.5g}{to}"


def document(results: DesignResults) -> dict[str, Any]:
    """Return all of it as plain data: dict, list, str, int, finite float, bool and None."""
    file, found = results.file, results.trade_off
    study = file.study
    return {
        "version": cagepose.__version__,
        "scene": study.nominal.scene.name,
        "method": chosen_method(study.nominal.scene).name,
        "units": {"length": study.nominal.length_unit},
        "change": {"key": study.varied[-1].key, "tight": file.tight, "loose": file.loose},
        "wish": file.model.wish.model_dump(by_alias=True, exclude_none=True),
        "accept": study.model.accept,
        "found": sentence(results),
        "loosest": found.loosest,
        "between": list(found.between) if file.model.wish.share is not None else None,
        "accuracy": found.accuracy,
        "kept": [list(ends) for ends in found.kept],
        "is_monotone": found.is_monotone,
        "runs": results.n_runs,
        "curve": [
            {"value": point.value, "reached": point.reached, "low": point.low, "high": point.high}
            for point in found.points
        ],
    }


def trade_off_figure(results: DesignResults) -> Figure:
    """Return the trade-off curve: what is reached over the changed number, and the wish."""
    found, wish = results.trade_off, results.file.model.wish
    values = [point.value for point in found.points]
    unit = 100.0 if wish.share is not None else 1.0
    with styled():
        figure = Figure(figsize=(PAGE_WIDTH_IN, 3.4), layout="constrained")
        panel = figure.subplots()
        if wish.share is not None:
            low, high = ([unit * getattr(point, name) for point in found.points] for name in ("low", "high"))
            panel.fill_between(values, low, high, color=BLUE, alpha=0.25, linewidth=0, label="95 % interval")
        panel.plot(values, [unit * point.reached for point in found.points], color=BLUE, marker="o", label="reached")
        panel.axhline(
            unit * wish.at_least, color=BLACK, linestyle="--", linewidth=1.0, label=f"wish: {wish_text(results)}"
        )
        for number, (tight, loose) in enumerate(found.kept):
            span = sorted((tight, loose))
            panel.axvspan(*span, color=GREEN, alpha=0.12, linewidth=0, label="kept" if number == 0 else None)
        if found.loosest is not None:
            label = f"loosest: {found.loosest:.5g}"
            panel.axvline(found.loosest, color=VERMILLION, linestyle="-.", linewidth=1.0, label=label)
        panel.set_xlabel(results.file.study.varied[-1].key)
        panel.set_ylabel("yield, %" if wish.share is not None else f"capture range of {next(iter(wish.capture or ()))}")
        figure.legend(loc="outside lower center", ncols=3)
    return figure


def write_design(results: DesignResults, folder: str | os.PathLike[str]) -> list[str]:
    """Write all files of `DesignResults.write`.

    Raises
    ------
    OSError
        As there.
    """
    home, figure = Path(folder), trade_off_figure(results)
    contents = {f"design{suffix}": figure_bytes(figure, suffix) for suffix in (".svg", ".png")}
    contents["design.json"] = json_text({"about": "made by cagepose", **document(results)}).encode()
    named = dict[str, bytes]()
    if results.loosest is not None:
        study = results.file.study
        named = copies(study)
        text, _ = named.pop(SCENE_NAME).decode(), named.pop(STUDY_NAME)
        loosest = with_values(text, {study.varied[-1].path: results.loosest})
        contents[LOOSEST_NAME] = f"{MARK}\n{loosest}".encode()
    home.mkdir(exist_ok=True)
    for name in (*contents, *named):
        is_ours = partial(_holds, named[name]) if name in named else is_made_by_us
        check_can_write(home / name, is_ours, "what cagepose design wrote")
    contents |= named
    for name, content in contents.items():
        write_whole(home / name, content)
    return [str(home / name) for name in contents]


def _holds(content: bytes, path: Path) -> bool:
    return path.read_bytes() == content
