"""``cagepose export``: a scene, and the poses that its run found, for another program."""

from __future__ import annotations

import sys
from typing import Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, MethodOption, SetOption, refusal
from cagepose.cli.run_source import RunOrSceneArgument, read_run_or_scene, run_of

SUFFIXES = {
    "mjcf": (".xml", ".mjcf"),
    "urdf": (".urdf", ".xml"),
    "step": (".step", ".stp"),
    "stl": (".stl",),
    "csv": (".csv",),
}
"""Suffixes of what is written. Others that no kind has are not looked at."""


def export_command(
    run_or_scene: RunOrSceneArgument,
    /,
    *,
    to: Annotated[
        Literal["mjcf", "urdf", "step", "stl", "csv"],
        Parameter(
            help="mjcf: a MuJoCo model, a keyframe at the end of each phase. urdf: a ROS model at the start pose, its"
            " meshes in a folder beside. step: solids for CAD, and stl: triangles, both at the end of the run. csv: the"
            " poses alone."
        ),
    ],
    out: Annotated[FileName, FILE, Parameter(name=("--out", "-o"), help="File to write, such as rollers.xml.")],
    method: MethodOption = None,
    set_values: SetOption = (),
) -> int:
    """Run a scene, write it for another program, and list what the file cannot hold."""
    from pathlib import Path

    from cagepose.errors import SceneError, printable
    from cagepose.exchange.export import exported
    from cagepose.files.write import check_can_write, is_made_by_us, write_whole
    from cagepose.model.wording import counted

    def check(path: Path) -> None:
        check_can_write(path, is_made_by_us, "an export of cagepose")

    option, suffix = f"--out {out}", Path(out).suffix.lower()
    if suffix not in SUFFIXES[to] and any(suffix in others for others in SUFFIXES.values()):
        proposed = Path(out).with_suffix(SUFFIXES[to][0])
        sys.stderr.write(printable(f"{option}: is not the name of a {to} file; write --out {proposed}") + "\n")
        return 2
    source = read_run_or_scene(run_or_scene, set_values, method, lambda: check(Path(out)), option)
    if source is None:
        return 2
    run = run_of(source, method).run
    folder = Path(out).parent
    try:
        found = exported(run, to, Path(out).name)
        for name in list(found.files)[:-1]:
            (folder / name).parent.mkdir(exist_ok=True)
            check(folder / name)
        for name, content in found.files.items():
            write_whole(folder / name, content)
    except SceneError as error:
        sys.stderr.write("".join(f"{run_or_scene}: {problem}\n" for problem in error.problems))
        return 2
    except OSError as error:
        sys.stderr.write(refusal(option, error) + "\n")
        return 2
    beside = len(found.files) - 1
    files = f"{out} and {counted((beside, 'file', 'files'))} beside it" if beside else out
    sys.stdout.write(printable(f"wrote {files}: {run.scene.name}, {run.verdict} ({run.method})") + "\n")
    sys.stdout.write("".join(printable(f"note: {note}") + "\n" for note in found.notes))
    return 0
