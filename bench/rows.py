"""What a benchmark saves: rows, each of one scene and one engine."""

from __future__ import annotations

import json
import math
import os
import platform
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).resolve().parent / "results.json"


@dataclass(frozen=True)
class Row:
    """One figure of one engine on one scene; None: not measured, or it means nothing here.

    Attributes
    ----------
    table
        Which benchmark it belongs to: "rail", "scenes", "shapes", "drives", "growth", "batch", "first-use",
        "pulls".
    median_s
        Wall time of one run (of one call of all runs in "batch"), median, seconds.
    error
        Tilt error as a part of the play angle, the greatest of all phases.
    ratio_to_ours
        Its median over that of the slower of our methods, solve and proof, on the same scene.
    settings
        All that was chosen for the engine.
    details
        Further figures, each with its unit in its name.
    skipped
        Why nothing was measured.
    """

    table: str
    scene: str
    engine: str
    median_s: float | None = None
    error: float | None = None
    ratio_to_ours: float | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    details: dict[str, Any] = field(default_factory=dict)
    skipped: str | None = None

    def as_document(self) -> dict[str, Any]:
        """Return the row as JSON takes it: an infinite error (the engine lost the object) is the text "inf"."""
        document = asdict(self)
        if self.error is not None and not math.isfinite(self.error):
            document["error"] = "inf"
        return document


def with_ratios(row: Row, ours: Row) -> Row:
    """Return a row beside one of ours, by wall and by CPU times: on a busy machine long runs wait, short ones not."""
    if row.median_s is None or ours.median_s is None:
        return row
    details = row.details | {"cpu_ratio": row.details["cpu_s"] / ours.details["cpu_s"]}
    return replace(row, ratio_to_ours=row.median_s / ours.median_s, details=details)


def machine() -> dict[str, Any]:
    """Describe the machine and how busy it was: for every row, since figures of two machines must not be mixed."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "load_average_1_min": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None,
    }


def save(rows: Sequence[Row], path: Path = RESULTS) -> None:
    """Write the rows of this process, and no others, to ``path``; a reader sees the old file or the new one whole."""
    found = machine()
    documents = [row.as_document() | {"machine": found} for row in rows]
    with tempfile.NamedTemporaryFile("w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8") as part:
        json.dump(documents, part, indent=1, allow_nan=False)
        part.write("\n")
    os.replace(part.name, path)


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
