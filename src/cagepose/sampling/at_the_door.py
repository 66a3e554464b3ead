"""What can be found wrong with a study only by running its nominal scene or drawing its sample: before it begins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cagepose.files.key_path import Path
from cagepose.files.study_file import StudyFile, VariedKey, refused_at
from cagepose.model.checks import duplicates
from cagepose.sampling.distribution import distribution_of
from cagepose.sampling.row_columns import NoColumnError, RowColumns
from cagepose.sampling.runner import Runner
from cagepose.sampling.sample import Sample


def checked_columns(file: StudyFile, source: str) -> RowColumns:
    """Return the columns of a study whose nominal scene can be run and judged; ``source`` is its file in messages.

    Raises
    ------
    SceneFileError
        Two columns of one name, a scene that its method cannot run, a formula that comes to no column, or an ``accept``
        without a truth value.
    """
    columns = RowColumns(file)
    for name in duplicates(columns.names):
        path, what = _second(name, file)
        message = f"gives the column {name} a second meaning; rename {what}"
        raise refused_at(path, file, source, message)
    nominal = np.array([[one.nominal for one in file.varied]])
    outcomes = Runner(file).run_nominal()
    if outcomes.errors[0] is not None:
        raise refused_at(("scene",), file, source, f"cannot be run: {outcomes.errors[0]}")
    try:
        columns.columns(nominal, outcomes)
    except NoColumnError as error:
        raise refused_at(error.path, file, source, str(error)) from None
    return columns


def _second(name: str, file: StudyFile) -> tuple[Path, str]:
    """Return where a column that there are two of can be renamed, and what has its name."""
    if name in file.compute:
        return ("compute", name), "what is computed"
    if name in (file.model.watch or {}):
        return ("watch", name), "what is measured"
    return ("watch",), "the point that is watched"


def checked_sample(file: StudyFile, source: str, varied: Sequence[VariedKey] | None = None) -> Sample:
    """Return the sample of a study, of all that varies if ``varied`` is not given.

    Raises
    ------
    SceneFileError
        It is too large.
    """
    try:
        return Sample(file.model.sample, [distribution_of(one) for one in varied or file.varied])
    except ValueError as error:
        raise refused_at(("sample",), file, source, str(error)) from None
