"""The golden run of each scene: what ``cagepose run --json`` says, without the time. ``make golden`` renews them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cagepose import run
from cagepose.files.document import run_document
from cagepose.files.scene_file import read_scene_file

ROOT = Path(__file__).resolve().parent.parent
GOLDEN = ROOT / "tests" / "golden"
SCENES = sorted((ROOT / "scenes").glob("*.yaml"))


def current(scene_path: Path) -> dict[str, Any]:
    scene_file = read_scene_file(scene_path)
    document = run_document(run(scene_file.scene), scene_file.length_unit)
    del document["timing_s"]
    return document


def golden(scene_path: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((GOLDEN / f"{scene_path.stem}.json").read_text())
    return document


def write_all() -> None:
    for scene_path in SCENES:
        target = GOLDEN / f"{scene_path.stem}.json"
        target.write_text(json.dumps(current(scene_path), indent=1) + "\n")
        print(f"wrote {target.relative_to(ROOT)}")


if __name__ == "__main__":
    write_all()
