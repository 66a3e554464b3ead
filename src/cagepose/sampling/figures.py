"""The pictures of a study's report: what matters, derivatives, how quantities are spread, and the capture map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from cagepose.files.units import with_unit
from cagepose.model.checks import FloatArray
from cagepose.sampling.capture_map import CaptureMap
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.findings import Findings
from cagepose.sampling.sensitivity import ACCEPTED, Sensitivity
from cagepose.sampling.statistics import N_BINS, Spread
from cagepose.sampling.tolerances import ToleranceRow
from cagepose.views.style import (
    BLACK,
    BLUE,
    BROWN,
    GREEN,
    GREY,
    ORANGE,
    PAGE_WIDTH_IN,
    PALE,
    PURPLE,
    SAND,
    SKY,
    VERMILLION,
    styled,
)

MOST_BARS = 12
"""The first so many numbers that matter have a bar."""
LEAST_HEIGHT_IN = 1.7
"""Least height of a picture. It leaves room for a panel of one bar between its title and the legend."""
VERDICT_COLOURS = {
    "stable": GREEN,
    "rests": GREEN,
    "may rest": ORANGE,
    "escapes": SKY,
    "blocked": BLUE,
    "jams": BROWN,
    "stops": SAND,
    "moves": PURPLE,
    "refused": PALE,
}
"""All others are failures."""


def draw(findings: Findings) -> dict[str, Figure]:
    """Return the pictures by name, only those that there is something to show in."""
    asked = _asked(findings)
    known = [found for found in findings.sensitivities if found.missing is None and found.name in (ACCEPTED, *asked)]
    rows = [row for row in findings.tolerances if row.name in asked and np.isfinite(row.derivatives).all()]
    names, units = findings.results.columns.varied, findings.results.columns.units
    pictures = {}
    with styled():
        if known:
            pictures["sobol"] = _sobol_figure(known, names)
        changing = [row for row in rows if np.ptp(row.worst) > row.resolution]
        if changing:
            pictures["tornado"] = _tornado_figure(changing, names, findings.distributions, units)
        resolution, all_spreads = findings.results.columns.resolution, findings.statistics.spreads
        spreads = {
            name: all_spreads[name]
            for name in asked
            if all_spreads[name].greatest - all_spreads[name].least > resolution[name]
        }
        if spreads:
            pictures["spread"] = _spread_figure(spreads, units)
        if findings.maps:
            pictures["map"] = _map_figure(findings.maps, units)
            ends = {name: found for name, found in findings.maps[0].quantities.items() if name in asked}
            ends = {name: found for name, found in ends.items() if _reach(found) > resolution[name]}
            if ends:
                pictures["ends"] = _ends_figure(findings.maps[0], ends, units)
    return pictures


def _asked(findings: Findings) -> tuple[str, ...]:
    """The watched quantities, or those of the pose where none is watched."""
    columns = findings.results.columns
    return columns.watched or columns.quantities


def _panels(n_panels: int, height_in: float, columns: int) -> tuple[Figure, list]:  # type: ignore[type-arg]
    n_columns = min(columns, n_panels)
    n_rows = -(-n_panels // n_columns)
    height_in = max(height_in * n_rows, LEAST_HEIGHT_IN)
    figure = Figure(figsize=(PAGE_WIDTH_IN, height_in), layout="constrained")
    panels = figure.subplots(n_rows, n_columns, squeeze=False).ravel()
    for panel in panels[n_panels:]:
        panel.set_axis_off()
    return figure, list(panels[:n_panels])


def _sobol_figure(known: Sequence[Sensitivity], names: Sequence[str]) -> Figure:
    n_bars = min(len(names), MOST_BARS)
    figure, panels = _panels(len(known), 0.7 + 0.28 * n_bars, 2)
    for panel, found in zip(panels, known, strict=True):
        order = np.argsort(-found.total, kind="stable")[:n_bars][::-1]
        places = np.arange(n_bars)
        looks = {"capsize": 2, "height": 0.36, "error_kw": {"elinewidth": 0.8}}
        panel.barh(
            places + 0.19,
            found.first[order],
            xerr=found.first_interval[order],
            color=BLUE,
            label="first order",
            **looks,
        )
        panel.barh(
            places - 0.19, found.total[order], xerr=found.total_interval[order], color=SKY, hatch="//",
            label="total", **looks,
        )  # fmt: skip
        panel.set_yticks(places, [names[one] for one in order])
        panel.set_xlim(left=min(0.0, panel.get_xlim()[0]))
        panel.set_title(found.name, loc="right")  # there is room for a long one over the labels, and none beside
        panel.set_xlabel("share of the variance")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def _tornado_figure(
    rows: Sequence[ToleranceRow], names: Sequence[str], distributions: Sequence[Distribution], units: Mapping[str, str]
) -> Figure:
    n_bars = min(len(names), MOST_BARS)
    reaches = np.array([(one.high - one.low) / 2.0 for one in distributions])
    figure, panels = _panels(len(rows), 0.7 + 0.2 * n_bars, 2)
    for panel, row in zip(panels, rows, strict=True):
        changes = row.derivatives * reaches
        order = np.argsort(-np.abs(changes), kind="stable")[:n_bars][::-1]
        sizes = np.abs(changes[order])
        panel.barh(np.arange(n_bars), 2.0 * sizes, left=-sizes, color=BLUE, height=0.6)
        panel.axvline(0.0, color=BLACK, linewidth=0.8)
        reach = 1.1 * float(sizes.max()) or 1.0
        panel.set_xlim(-reach, reach)
        panel.locator_params(axis="x", nbins=5)
        panel.xaxis.set_major_formatter("{x:g}")
        panel.set_yticks(np.arange(n_bars), [names[one] for one in order])
        panel.set_title(row.name, loc="right")
        panel.set_xlabel(with_unit("change to either end", units[row.name]))
    return figure


def _spread_figure(spreads: dict[str, Spread], units: Mapping[str, str]) -> Figure:
    figure, panels = _panels(len(spreads), 1.7, 3)
    for panel, (name, spread) in zip(panels, spreads.items(), strict=True):
        counts = spread.counts.reshape(80, N_BINS // 80).sum(axis=1)
        edges = np.linspace(spread.least, spread.greatest, 81)
        panel.stairs(counts / counts.max(), edges, fill=True, color=BLUE, alpha=0.7)
        panel.axvline(spread.mean, color=VERMILLION, linewidth=1.0)
        panel.set_title(name)
        panel.set_xlabel(f"[{units[name]}]")
        panel.set_yticks([])
        panel.locator_params(axis="x", nbins=4)
    return figure


def _map_figure(maps: Sequence[CaptureMap], units: Mapping[str, str]) -> Figure:
    figure, panels = _panels(len(maps), 4.6 if len(maps) == 1 else 3.2, 2)
    verdicts = sorted({str(verdict) for found in maps for verdict in np.unique(found.verdicts)})
    colours = [VERDICT_COLOURS.get(verdict, VERMILLION) for verdict in verdicts]
    for panel, found in zip(panels, maps, strict=True):
        _draw_map(
            panel, found, np.array([to_rgb(colour) for colour in colours])[np.searchsorted(verdicts, found.verdicts)]
        )
        across, up = (with_unit(key, units[key]) for key in found.keys)
        panel.set_xlabel(across)
        panel.set_ylabel(up)
        if found.layer is not None:
            panel.set_title(f"{found.layer[0]} = {found.layer[1]:.5g} {units[found.layer[0]]}".rstrip())
    handles = [Patch(color=colour, label=verdict) for verdict, colour in zip(verdicts, colours, strict=True)]
    if any(found.box is not None for found in maps):
        handles.append(Patch(fill=False, edgecolor=BLACK, linestyle="--", label="largest box of accepted runs"))
    if not all(found.accepted.all() for found in maps):
        handles.append(Patch(facecolor=GREY, alpha=0.25, label="pale: not accepted"))
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _reach(values: FloatArray) -> float:
    """How far known values are apart; 0 where there are none."""
    known = values[~np.isnan(values)]
    return float(np.ptp(known)) if len(known) else 0.0


def _ends_figure(found: CaptureMap, ends: dict[str, FloatArray], units: Mapping[str, str]) -> Figure:
    figure, panels = _panels(len(ends), 2.3, 3)
    for panel, (name, values) in zip(panels, ends.items(), strict=True):
        panel.set_facecolor(PALE)
        across, up = found.across[found.lattice], found.up[found.lattice]
        picture = panel.pcolormesh(across, up, values, shading="nearest", rasterized=True)
        bar = figure.colorbar(picture, ax=panel, location="bottom", shrink=0.9, label=f"[{units[name]}]")
        bar.locator = MaxNLocator(4)
        _draw_boundary(panel, found)
        panel.set_title(name)
        panel.set_yticks([])
        panel.locator_params(axis="x", nbins=4)
    keys = [with_unit(key, units[key]) for key in found.keys]
    figure.supxlabel(f"across: {keys[0]}; up: {keys[1]}", fontsize=8.5)
    return figure


def _extent(found: CaptureMap) -> tuple[float, float, float, float]:
    half = [(axis[-1] - axis[0]) / (len(axis) - 1) / 2.0 for axis in (found.across, found.up)]
    return found.across[0] - half[0], found.across[-1] + half[0], found.up[0] - half[1], found.up[-1] + half[1]


def _draw_boundary(panel: Axes, found: CaptureMap) -> None:
    if found.accepted.any() and not found.accepted.all():
        panel.contour(found.across, found.up, found.accepted.astype(float), [0.5], colors=[BLACK], linewidths=1.0)


def _draw_map(panel: Axes, found: CaptureMap, shades: FloatArray) -> None:
    """Draw one map; ``shades`` are the colours of its verdicts, (n, n, 3)."""
    shades = np.where(found.accepted[..., None], shades, 0.55 + 0.45 * shades)  # what is not accepted is pale
    panel.imshow(shades, origin="lower", extent=_extent(found), aspect="auto", interpolation="none")
    _draw_boundary(panel, found)
    if found.box is not None:
        (left, right), (bottom, top) = found.box
        panel.add_patch(
            Rectangle((left, bottom), right - left, top - bottom, fill=False, edgecolor=BLACK, linestyle="--")
        )
