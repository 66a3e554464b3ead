"""What a study has found: `StudyResults`, read from its folder."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cagepose.errors import StudyFolderError
from cagepose.model.wording import number_of
from cagepose.views.extra import require_study

if TYPE_CHECKING:
    import pandas
    import pyarrow


class StudyResults:
    """The rows of a study's folder, as far as they are there.

    Attributes
    ----------
    study
        What was asked.
    columns
        Names of the columns, by kind.

    Raises
    ------
    StudyFolderError
        The folder holds no study, or a part of it cannot be read.
    MissingExtraError
        The extra ``study`` is not installed.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        require_study()
        from cagepose.sampling.folder import StudyFolder  # the class itself can be imported without the extra
        from cagepose.sampling.row_columns import RowColumns

        self.folder = StudyFolder(folder)
        self.study = self.folder.study()
        self.columns = RowColumns(self.study)
        self._n_rows = self.folder.n_rows()

    def __len__(self) -> int:
        return self._n_rows

    def __repr__(self) -> str:
        return f"<StudyResults: {number_of(len(self), 'run')} in {os.fspath(self.folder.path)!r}>"

    def require_rows(self) -> None:
        """Do nothing if there is at least one row.

        Raises
        ------
        StudyFolderError
            There is none.
        """
        if not len(self):
            raise StudyFolderError(f"{self.folder.path}: holds no rows yet; run the study with --resume")

    def report(self, workers: int | None = None) -> dict[str, Any]:
        """Write the report into the folder and return its numbers; ``workers`` as for `Study.run`.

        Raises
        ------
        StudyFolderError
            There are no rows.
        OSError
            It cannot be written.
        """
        from cagepose.sampling.findings import document, findings_of  # which read results
        from cagepose.sampling.report import write_report

        findings = findings_of(self, workers)
        write_report(findings)
        return document(findings)

    def table(self, columns: Sequence[str] | None = None) -> pyarrow.Table:
        """Return the rows, or some columns of them, as a table of pyarrow."""
        self.require_rows()
        import pyarrow

        return pyarrow.concat_tables(self.folder.batches(columns)).unify_dictionaries()

    def to_frame(self, columns: Sequence[str] | None = None) -> pandas.DataFrame:
        """Return the rows, or some columns of them, as a ``pandas.DataFrame``."""
        return self.table(columns).to_pandas()

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write all rows as comma-separated values, part by part; where there is nothing, nothing.

        Numbers have as many digits as they need to be read again exactly. A file of that name is replaced if it begins
        with the same columns.

        Raises
        ------
        StudyFolderError
            There are no rows.
        OSError
            It cannot be written, or holds something else.
        """
        self.require_rows()
        from cagepose.sampling.csv_file import write_csv

        write_csv(self.folder.batches(), path)

    def parts(self, columns: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
        """Yield some columns part by part, so that memory does not grow with the rows; where there is nothing, NaN."""
        for table in self.folder.batches(columns):
            yield {name: _array(table.column(name)) for name in columns}


def _array(column: Any) -> np.ndarray:
    """Texts are kept once each, and rows hold their numbers: one by one they would take a third of all the reading."""
    found: np.ndarray
    if not hasattr(column.type, "value_type"):
        found = column.to_numpy()
        return found
    rows = column.combine_chunks()
    texts = rows.dictionary.to_pylist()
    found = np.array([*texts, ""])[rows.indices.fill_null(len(texts)).to_numpy()]
    return found
