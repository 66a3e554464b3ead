"""Design files: text in, a `DesignFile` or every problem found out."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from cagepose.errors import Problem
from cagepose.files.messages import Finding
from cagepose.files.read import read_text
from cagepose.files.schema_study import DesignModel, DistributionModel, RunsModel, SampleModel, StudyModel
from cagepose.files.study_file import ALL, StudyFile, checked_model, placed, study_of


@dataclass(frozen=True)
class DesignFile:
    """A design that can be searched.

    Attributes
    ----------
    model
        As it was written, and checked.
    study
        The study of all numbers that vary, and, as the last of them, the one that is to be chosen.
    tight, loose
        The two ends of that one.
    """

    model: DesignModel
    study: StudyFile
    tight: float
    loose: float

    def __repr__(self) -> str:
        return f"<DesignFile of {self.study.nominal.scene.name!r}: {self.study.varied[-1].key} is to be chosen>"


def read_design_file(path: str | os.PathLike[str]) -> DesignFile:
    """Read a design file and the scene that it names.

    Raises
    ------
    SceneFileError
        Either cannot be used; lists every problem with its line and column.
    """
    source = os.fspath(path)
    return parse_design(read_text(Path(source), source), source)


def parse_design(text: str, source: str = "design.yaml") -> DesignFile:
    """As `read_design_file`, from text; ``source`` as in `parse_study`.

    Raises
    ------
    SceneFileError
        As `read_design_file`.
    """
    yaml, model = checked_model(text, source, DesignModel)
    ((key, (tight, loose)),) = model.change.items()
    problems = []
    if key in model.vary:
        problems.append(Problem(("change", key), "varies, too; keep one of the two"))
    if ALL in key:
        problems.append(Problem(("change", key), f"has a {ALL}; make what changes together a parameter and name that"))
    if model.wish.capture is None and model.sample is None:
        problems.append(Problem((), "has no sample, which a yield needs; add, for example, sample: {runs: 4096}"))
    if problems:
        raise placed(yaml, [Finding(problem, True) for problem in problems])
    shared = {name: getattr(model, name) for name in RunsModel.model_fields if name != "vary"}
    vary = {**model.vary, key: DistributionModel.model_validate({"uniform": sorted((tight, loose))})}
    sample = model.sample or SampleModel.model_validate({"runs": 1})
    asked = StudyModel.model_validate({**shared, "vary": vary, "sample": sample})
    study = study_of(yaml, asked, text, changed=key)
    varied = [one.key for one in study.varied[:-1]]
    for captured in model.wish.capture or ():
        if captured not in varied:
            message = f"does not vary; use one of: {', '.join(varied)}"
            raise placed(yaml, [Finding(Problem(("wish", "capture", captured), message), True)])
    return DesignFile(model, study, tight, loose)
