"""What runs of scenes end with, to the last digit; asked of a process of its own, whose kernels may be other ones.

As a program, ``answers.py N`` prints the answers of all our scenes and of ``N`` random ones.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cagepose import Run, Scene, load_scene, run
from cagepose.kernels.native.library import kernel_library
from cagepose.model.methods import DEFAULT_METHOD, METHODS

TESTS = Path(__file__).resolve().parents[2]
SCENES = sorted((TESTS.parent / "scenes").glob("*.yaml"))
SLOW_AS_PLAIN_PYTHON = ("rail", "ladder", "drawer", "tapered-pin", "dock", "grip.", "latch", "jaws")
"""They take a minute and more: proofs with friction, drives along rails and pads, and the pin's slide down the chamfer.
"""
SECONDS_AS_PLAIN_PYTHON = ("phone-dock", "plate-on-pins")
"""They are asked where many random scenes are, too."""
MANY = 6
SEED = 20261123


def asked(level: str | None, n_random: int) -> dict[str, Any]:
    """The answers of a new process with the machine code of a level; None: of plain Python."""
    environment = {
        **os.environ,
        "CAGEPOSE_KERNELS": level or "python",
        "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path]),
    }
    done = subprocess.run(
        [sys.executable, __file__, str(n_random)], env=environment, capture_output=True, text=True, check=True
    )
    told = json.loads(done.stdout)
    assert told["level"] == level
    answers: dict[str, Any] = told["answers"]
    return answers


def scenes(n_random: int) -> Iterator[tuple[str, Scene]]:
    from audit.families import drawn_scenes
    from quasistatic.paths import again

    left_out = SLOW_AS_PLAIN_PYTHON + (SECONDS_AS_PLAIN_PYTHON if n_random < MANY else ())
    for path in SCENES:
        if os.environ.get("CAGEPOSE_KERNELS") != "python" or not path.name.startswith(left_out):
            yield path.stem, load_scene(path)
        if path.stem == "tapered-pin":
            yield f"{path.stem} over its hole", load_scene(path).changed("object.pose.position", (0.0, 0.0, 0.01))
    for number, scene in enumerate(drawn_scenes("union", n_random, SEED)):
        yield f"random {number}", again(scene, friction=(None, 0.3)[number % 2])


def answer(result: Run) -> list[Any]:
    """Each phase's verdict, proof and poses; JSON keeps every digit of a number."""
    return [
        [
            phase.verdict,
            phase.proof.verdict,
            [[*pose.position_m, *pose.quaternion_wxyz] for pose in (e.pose_world_object for e in phase.events)],
            [[c.point, c.force_normal_n, None if c.force_normal_n is None else [*c.force_tangential_n]]
             for c in phase.contacts],
        ]
        for phase in result.phases
    ]  # fmt: skip


if __name__ == "__main__":
    answers = {
        f"{name}, {method}": answer(run(scene, method))
        for name, scene in scenes(int(sys.argv[1]))
        for method in METHODS
        if method == DEFAULT_METHOD or not scene.has_other_shapes
    }
    native = kernel_library()
    json.dump({"level": None if native is None else native.level, "answers": answers}, sys.stdout)
