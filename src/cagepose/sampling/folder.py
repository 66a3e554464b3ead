"""The folder of a study: copies of its files, and its rows in parts, each written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from cagepose import __version__
from cagepose.errors import StudyFolderError, printable
from cagepose.files.study_file import STUDY_NAME, StudyFile, copies, read_study_file
from cagepose.files.write import write_whole
from cagepose.sampling.lock import LockedError, locked

PARTS, LOCK = "parts", ".lock"


class StudyFolder:
    """A folder by its name; nothing is read or written before it is asked for."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)

    def __repr__(self) -> str:
        return f"<StudyFolder {os.fspath(self.path)!r}>"

    @contextmanager
    def begun(self, study: StudyFile, *, resume: bool) -> Iterator[None]:
        """Make the folder ready for the parts of a study, and keep it from others as long as the context lasts.

        Raises
        ------
        StudyFolderError
            It holds another study, something else, or this study without ``resume``; or it is being written.
        OSError
            It cannot be made or written.
        """
        wanted = copies(study)
        self._check(wanted, resume=resume)  # before a lock is left in a folder of somebody else
        self.path.mkdir(exist_ok=True)
        try:
            with locked(self.path / LOCK):
                self._check(wanted, resume=resume)
                self._begin(wanted)
                yield
        except LockedError:
            raise self._refused(
                "is being written by another study that runs now; wait for its end or stop it, or name another folder"
            ) from None

    def _check(self, wanted: dict[str, bytes], *, resume: bool) -> None:
        if "\0" in str(self.path):
            raise self._refused("is not a folder's name; remove the unprintable character")
        if self.path.exists() and not self.path.is_dir():
            raise self._refused("is not a folder; name one, or a new one")
        if not self.path.parent.is_dir():
            raise self._refused("its folder does not exist; make the folder first")
        if not (self.path / STUDY_NAME).exists():
            held = self.path.iterdir() if self.path.exists() else ()
            others = [path for path in held if path.name != LOCK and not _is_remnant(path)]
            if not all(_holds(path, wanted.get(path.name)) for path in others):
                raise self._refused("holds something else than a study; name another folder, or a new one")
        else:
            for name, content in wanted.items():
                if not _holds(self.path / name, content):
                    message = f"holds another study: its {name} differs; name another folder, or a new one"
                    raise self._refused(message)
            if not resume:
                raise self._refused("holds this study already; add --resume to go on with it, or name another folder")

    def _begin(self, wanted: dict[str, bytes]) -> None:
        for path in (*self.path.glob(".*"), *(self.path / PARTS).glob(".*")):
            if _is_remnant(path):
                path.unlink()  # of a process that was killed
        for name, content in sorted(wanted.items(), key=lambda item: item[0] == STUDY_NAME):
            if not (self.path / name).exists():  # the study's own file last: with it, all is there
                write_whole(self.path / name, content)
        (self.path / PARTS).mkdir(exist_ok=True)

    def study(self) -> StudyFile:
        """Return the study that the folder holds.

        Raises
        ------
        StudyFolderError
            It holds none.
        SceneFileError
            It cannot be read any more.
        """
        if not (self.path / STUDY_NAME).is_file():
            raise self._refused("holds no study; name a folder that cagepose study --out made")
        return read_study_file(self.path / STUDY_NAME)

    def has(self, first: int, last: int) -> bool:
        """Whether rows ``first`` up to, without, ``last`` are there.

        Raises
        ------
        StudyFolderError
            They are, and cannot be read or are of another cagepose.
        """
        path = self._part(first, last)
        if not path.exists():
            return False
        self._check_version(self._metadata(path))
        return True

    def write(self, first: int, last: int, table: pa.Table) -> None:
        """Write a part.

        Raises
        ------
        OSError
            It cannot be written.
        """
        sink = pa.BufferOutputStream()
        texts = [field.name for field in table.schema if pa.types.is_dictionary(field.type)]  # numbers differ
        how = {"compression": "zstd", "compression_level": 1, "write_page_checksum": True}
        pq.write_table(table, sink, use_dictionary=texts, **how)
        write_whole(self._part(first, last), sink.getvalue())

    def batches(self, columns: Sequence[str] | None = None) -> Iterator[pa.Table]:
        """Yield the parts, in order, as far as they are there.

        Raises
        ------
        StudyFolderError
            One cannot be read.
        """
        for path in self.parts():
            try:
                with pq.ParquetFile(path, page_checksum_verification=True) as part:
                    self._check_version(part.metadata)
                    table = part.read(columns=None if columns is None else list(columns))
            except (OSError, pa.ArrowException) as error:
                raise self._unreadable(path, error) from None
            yield table

    def parts(self) -> list[Path]:
        """Return the files of the parts, in order."""
        return sorted((self.path / PARTS).glob("*.parquet"))

    def n_rows(self) -> int:
        """Return how many rows are there."""
        return sum(self._metadata(path).num_rows for path in self.parts())

    def _part(self, first: int, last: int) -> Path:
        return self.path / PARTS / f"rows-{first:010d}-{last - 1:010d}.parquet"

    def _metadata(self, path: Path) -> pq.FileMetaData:
        try:
            return pq.read_metadata(path)
        except (OSError, pa.ArrowException) as error:
            raise self._unreadable(path, error) from None

    def _check_version(self, metadata: pq.FileMetaData) -> None:
        version = (metadata.metadata or {}).get(b"cagepose", b"none").decode(errors="replace")
        if version != __version__:
            raise self._refused(
                f"holds rows of cagepose {version}, and this is {__version__}; name another folder, or use that version"
            )

    def _refused(self, message: str) -> StudyFolderError:
        return StudyFolderError(printable(f"{self.path}: {message}"))

    def _unreadable(self, path: Path, error: Exception) -> StudyFolderError:
        reason = " ".join(str(error).split())
        return StudyFolderError(printable(f"{path}: cannot be read ({reason}); remove it and add --resume"))


def _is_remnant(path: Path) -> bool:
    """Whether a file is what `write_whole` leaves if its process is killed."""
    return path.name.startswith(".") and path.name.endswith(".part") and path.is_file()


def _holds(path: Path, content: bytes | None) -> bool:
    """Whether a file is there and has this content."""
    return content is not None and path.is_file() and path.read_bytes() == content
