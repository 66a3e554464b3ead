"""Rows as comma-separated values."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pyarrow as pa
from pyarrow import csv

from cagepose.files.write import check_can_write, whole_file


def write_csv(parts: Iterator[pa.Table], path: str | os.PathLike[str]) -> None:
    """Write tables of the same columns, at least one, into one file, whole or not at all; one is in memory at a time.

    Raises
    ------
    OSError
        It cannot be written, or a file of other columns stands there.
    """
    first = _plain(next(parts))
    header = pa.BufferOutputStream()
    csv.write_csv(first.slice(0, 0), header)
    expected = header.getvalue().to_pybytes()

    def has_our_columns(target: Path) -> bool:
        with target.open("rb") as stream:
            return stream.read(len(expected)) in (expected, b"")

    check_can_write(path, has_our_columns, "these columns as CSV")
    with whole_file(path) as stream, csv.CSVWriter(stream, first.schema) as writer:
        for part in chain([first], map(_plain, parts)):
            writer.write_table(part)


def _plain(table: pa.Table) -> pa.Table:
    """Texts as such, where they are kept once each."""
    texts = [(place, field) for place, field in enumerate(table.schema) if pa.types.is_dictionary(field.type)]
    for place, field in texts:
        table = table.set_column(place, field.name, table.column(place).cast(pa.string()))
    return table
