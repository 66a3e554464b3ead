"""What a design has found: `DesignResults`, in words, as plain data, as a picture, and as files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cagepose
from cagepose.files.design_file import DesignFile
from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import SCENE_NAME, STUDY_NAME, copies
from cagepose.files.units import with_unit
from cagepose.files.write import check_can_write, is_made_by_us, json_text, write_whole
from cagepose.model.wording import number_of, percent
from cagepose.runs.methods import chosen_method
from cagepose.sampling.trade_off import TradeOff

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOOSEST_NAME, MARK = "loosest.yaml", "# The loosest value that keeps the wish, made by cagepose design."


@dataclass(frozen=True)
class DesignResults:
    """What a design has found.

    Attributes
    ----------
    file
        What was asked.
    trade_off
        What is reached at each value that was asked, and the loosest that keeps the wish.
    n_runs
        How many runs it took.
    """

    file: DesignFile
    trade_off: TradeOff
    n_runs: int

    def __repr__(self) -> str:
        return f"<DesignResults: {self.sentence()}>"

    @property
    def loosest(self) -> float | None:
        """The loosest value that keeps the wish, in the scene file's unit; None: none does."""
        return self.trade_off.loosest

    def wish_text(self) -> str:
        """Return what was wished: "yield >= 99.700 %", "capture range of parameters.pitch >= 0.5"."""
        wish = self.file.model.wish
        if wish.share is not None:
            return f"yield >= {percent(wish.share)}"
        ((key, width),) = (wish.capture or {}).items()
        return f"capture range of {key} >= {width:g}"

    def reached_text(self, reached: float) -> str:
        """Return a yield in percent, or a range as it is."""
        return percent(reached) if self.file.model.wish.share is not None else f"{reached:.5g}"

    def sentence(self) -> str:
        """Return what was found, in a few sentences."""
        found, key, wish = self.trade_off, self.file.study.varied[-1].key, self.wish_text()
        ends = f"{self.file.tight:g} to {self.file.loose:g}"
        if found.loosest is None:
            best = max(found.points, key=lambda point: point.reached)
            return f"no {key} from {ends} meets {wish}: at best {self.reached_text(best.reached)}, at {best.value:.5g}"
        if found.loosest == self.file.loose:
            told = f"{key} = {found.loosest:.5g}, the loose end, still meets {wish}; looser values were not tried"
        else:
            told = f"{key} = {found.loosest:.5g} is the loosest that meets {wish}, to within {found.accuracy:.1g}"
        if not found.is_monotone:
            ranges = " and ".join(f"{low:.5g} to {high:.5g}" for low, high in found.kept)
            told += f"; not all tighter values do: only {ranges}"
        if self.file.model.wish.share is not None:
            told += f"; {self._confidence()}"
        return told

    def _confidence(self) -> str:
        surely, perhaps = self.trade_off.between
        to = "" if perhaps == self.file.loose else f" and {perhaps:.5g}"
        if surely is None:
            n_runs = self.n_runs // len(self.trade_off.points)
            return f"but no value does with 95 % confidence in {number_of(n_runs, 'run')}: set more runs"
        if not to:
            return f"with 95 % confidence at least {surely:.5g}"
        return f"with 95 % confidence between {surely:.5g}{to}"

    def document(self) -> dict[str, Any]:
        """Return all of it as plain data: dict, list, str, int, finite float, bool and None."""
        file, found = self.file, self.trade_off
        study = file.study
        return {
            "version": cagepose.__version__,
            "scene": study.nominal.scene.name,
            "method": chosen_method(study.nominal.scene).name,
            "units": {"length": study.nominal.length_unit},
            "change": {"key": study.varied[-1].key, "tight": file.tight, "loose": file.loose},
            "wish": file.model.wish.model_dump(by_alias=True, exclude_none=True),
            "accept": study.model.accept,
            "found": self.sentence(),
            "loosest": found.loosest,
            "between": list(found.between) if file.model.wish.share is not None else None,
            "accuracy": found.accuracy,
            "kept": [list(ends) for ends in found.kept],
            "is_monotone": found.is_monotone,
            "runs": self.n_runs,
            "curve": [
                {"value": point.value, "reached": point.reached, "low": point.low, "high": point.high}
                for point in found.points
            ],
        }

    def figure(self) -> Figure:
        """Return the trade-off curve: what is reached over the changed number, and the wish."""
        from matplotlib.figure import Figure  # what no search waits for

        from cagepose.views.style import BLACK, BLUE, GREEN, PAGE_WIDTH_IN, VERMILLION, styled

        found, wish = self.trade_off, self.file.model.wish
        values = [point.value for point in found.points]
        unit = 100.0 if wish.share is not None else 1.0
        with styled():
            figure = Figure(figsize=(PAGE_WIDTH_IN, 3.4), layout="constrained")
            panel = figure.subplots()
            if wish.share is not None:
                low, high = ([unit * getattr(point, name) for point in found.points] for name in ("low", "high"))
                panel.fill_between(values, low, high, color=BLUE, alpha=0.25, linewidth=0, label="95 % interval")
            panel.plot(
                values, [unit * point.reached for point in found.points], color=BLUE, marker="o", label="reached"
            )
            panel.axhline(
                unit * wish.at_least, color=BLACK, linestyle="--", linewidth=1.0, label=f"target: {self.wish_text()}"
            )
            for number, (tight, loose) in enumerate(found.kept):
                span = sorted((tight, loose))
                panel.axvspan(*span, color=GREEN, alpha=0.12, linewidth=0, label="target met" if number == 0 else None)
            if found.loosest is not None:
                label = f"loosest: {found.loosest:.5g}"
                panel.axvline(found.loosest, color=VERMILLION, linestyle="-.", linewidth=1.0, label=label)
            units = self.file.study.units
            panel.set_xlabel(with_unit(self.file.study.varied[-1].key, units[self.file.study.varied[-1].key]))
            captured = next(iter(wish.capture or ()), None)
            ranged = "" if captured is None else with_unit(f"capture range of {captured}", units[captured])
            panel.set_ylabel(ranged or "yield, %")
            figure.legend(loc="outside lower center", ncols=3)
        return figure

    def write(self, folder: str | os.PathLike[str]) -> list[str]:
        """Write ``design.json``, the trade-off curve as ``design.svg`` and ``design.png``, and the scene with the
        loosest value as ``loosest.yaml``, if there is one; return the files.

        Parameters
        ----------
        folder
            Made if it is not there. Files of these names in it must be ours.

        Raises
        ------
        OSError
            It cannot be written, or holds a file of such a name that is not ours.
        """
        from cagepose.views.style import figure_bytes

        home, figure = Path(folder), self.figure()
        contents = {f"design{suffix}": figure_bytes(figure, suffix) for suffix in (".svg", ".png")}
        contents["design.json"] = json_text({"about": "made by cagepose", **self.document()}).encode()
        named = dict[str, bytes]()
        if self.loosest is not None:
            study = self.file.study
            named = copies(study)
            text, _ = named.pop(SCENE_NAME).decode(), named.pop(STUDY_NAME)
            loosest = with_values(text, {study.varied[-1].path: self.loosest})
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
