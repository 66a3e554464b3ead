"""All scenes of the project by both methods: solve and proof."""

from __future__ import annotations

from collections.abc import Iterator

from bench.ours import PARTS, engine_name, measure
from bench.rail_case import SCENES
from bench.rows import Row
from cagepose import load_scene, run
from cagepose.model.methods import METHODS

BUDGET_S = 0.6


def scene_rows() -> Iterator[Row]:
    """Measure every scene file."""
    for path in sorted(SCENES.glob("*.yaml")):
        scene = load_scene(path)
        for method in METHODS:
            result = run(scene, method)
            times_s, _ = measure(scene, method, BUDGET_S)
            n_events = sum(len(phase.events) for phase in result.phases)
            details: dict[str, object] = {"verdict": result.verdict, "events": n_events}
            details |= {f"{part[1:]}_us": times_s[part][0] * 1e6 for part in PARTS if part}
            yield Row("scenes", path.stem, engine_name(method), times_s[""][0], details=details)
