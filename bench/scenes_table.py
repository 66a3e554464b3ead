"""All scenes of the project by the methods that run them: solve and proof."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from bench.ours import PARTS, engine_name, measure
from bench.rail_case import SCENES
from bench.rows import Row
from cagepose import Scene, SceneError, load_scene, run
from cagepose.model.methods import METHODS
from cagepose.runs.methods import chosen_method

BUDGET_S = 0.6


def scene_rows() -> Iterator[Row]:
    """Measure every scene file; the stepwise method runs boxes, points and one force alone."""
    for path in sorted(SCENES.glob("*.yaml")):
        scene = load_scene(path)
        for method in filter(partial(_runs, scene), METHODS):
            result = run(scene, method)
            times_s, _ = measure(scene, method, BUDGET_S)
            n_events = sum(len(phase.events) for phase in result.phases)
            details: dict[str, object] = {"verdict": result.verdict, "events": n_events}
            details |= {f"{part[1:]}_us": times_s[part][0] * 1e6 for part in PARTS if part}
            yield Row("scenes", path.stem, engine_name(method), times_s[""][0], details=details)


def _runs(scene: Scene, method: str) -> bool:
    try:
        chosen_method(scene, method)
    except SceneError:
        return False
    return True
