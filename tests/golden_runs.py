"""The golden run of each scene by each method: what ``cagepose run --json`` says, without the time.

``make golden`` renews them.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cagepose import Run, run
from cagepose.files.document import run_document
from cagepose.files.scene_file import read_scene_file
from our_scenes import CASES

ROOT = Path(__file__).resolve().parent.parent
GOLDEN = ROOT / "tests" / "golden"


def golden_path(scene_path: Path, method: str) -> Path:
    return GOLDEN / f"{scene_path.stem}.{method}.json"


def current(scene_path: Path, method: str) -> tuple[Run, dict[str, Any]]:
    scene_file = read_scene_file(scene_path)
    result = run(scene_file.scene, method)
    document = run_document(result, scene_file.length_unit)
    del document["timing_s"]
    return result, document


def golden(scene_path: Path, method: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(golden_path(scene_path, method).read_text())
    return document


def write_all() -> None:
    for scene_path, method in CASES:
        target = golden_path(scene_path, method)
        target.write_text(json.dumps(current(scene_path, method)[1], indent=1) + "\n")
        print(f"wrote {target.relative_to(ROOT)}")


if __name__ == "__main__":
    write_all()
