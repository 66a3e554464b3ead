"""``cagepose compare``: the same scene by both methods, side by side."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import SceneArgument, SetOption, Switch

if TYPE_CHECKING:
    from cagepose.studies.comparison import Comparison


def compare_command(
    scene: SceneArgument,
    /,
    *,
    friction: Annotated[
        tuple[float, ...],
        Parameter(
            help="A coefficient of friction for the mechanics; may be given several times. Left out: 0 and the scene's"
            " own.",
            negative=(),
        ),
    ] = (),
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the tables.")] = False,
) -> int:
    """Print final poses and verdicts of all variants, and where each differs from the paper's rules."""
    from cagepose.errors import SceneFileError
    from cagepose.files.scene_file import read_scene_file

    wrong = [value for value in friction if not 0.0 <= value < float("inf")]
    for value in wrong:
        sys.stderr.write(f"--friction {value:g}: is no coefficient of friction; give a finite number, zero or above\n")
    try:
        scene_file = read_scene_file(scene, set_values)
    except SceneFileError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if wrong:
        return 2

    from cagepose.studies.comparison import compare

    comparison = compare(scene_file.scene, friction or None)
    if json:
        from cagepose.files.comparison_document import comparison_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(comparison_document(comparison, scene_file.length_unit)))
        return _exit_code(comparison)

    from cagepose.cli.comparison_report import print_comparison

    print_comparison(comparison, scene_file.length_unit)
    return _exit_code(comparison)


def _exit_code(comparison: Comparison) -> int:
    """1 where every variant failed: then nothing was reached."""
    return 1 if all(variant.run.failed for variant in comparison.variants) else 0
