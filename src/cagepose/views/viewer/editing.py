"""A scene's file beside its page: what the page asks of its text, and of the file on disk."""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

from cagepose.errors import CageposeError, FileProblem, Problem, SceneFileError, printable
from cagepose.files.files_named import files_named, stamp_of
from cagepose.files.read import MAX_FILE_BYTES, SCENE_SUFFIXES, decoded
from cagepose.files.scene_edit import edited
from cagepose.files.scene_file import SceneText, read_scene_text, scene_text_of
from cagepose.files.schema import scene_json_schema
from cagepose.files.write import write_whole
from cagepose.views.viewer.questions import QUESTIONS
from cagepose.views.viewer.vary import runs_with
from cagepose.views.viewer.what_if import WhatIf

TEXTS_KEPT = 4
Question = dict[str, Any]


class _Asked(NamedTuple):
    """What a question is about.

    Attributes
    ----------
    what_if
        Its text, to be run.
    beside
        Files that the text names, and their stamp before they were read: one that is written meanwhile is another one.
    """

    what_if: WhatIf
    beside: dict[str, Any]


class Desk:
    """Answers a page about one scene file. Each question holds the text that it is about, so that windows cannot
    disturb each other.

    Attributes
    ----------
    answers
        By the path of a question, what answers it: plain data in and out. Each raises CageposeError, ValueError,
        TimeoutError or OSError where there is no answer, see `refusal`.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        set_values: tuple[str, ...] = (),
        method: str | None = None,
        *,
        can_edit: bool = True,
    ) -> None:
        """``set_values`` and ``method`` change the text before anybody else does. Without ``can_edit`` there are
        sliders alone: no text is taken, and no file is written.

        Raises
        ------
        SceneFileError
            The scene cannot be used, see `load_scene`.
        """
        self._path, self._source, self._can_edit = Path(path), os.fspath(path), can_edit
        changes = set_values if method is None else (*set_values, f"method={method}")
        self._version = _version(self._content())
        self._scene_text_of = lru_cache(TEXTS_KEPT)(self._read)
        self._what_if_of = lru_cache(TEXTS_KEPT)(self._made)
        saved = read_scene_text(path)
        self._saved, self._start = saved.text, edited(saved, changes).text
        self._asked({})
        self._writing = Lock()
        self.answers: dict[str, Callable[[Question], dict[str, Any]]] = {
            "/run": self._run,
            "/pull": self._pull,
            "/ask": self._ask,
        }
        if can_edit:
            self.answers |= {"/file": self._file, "/save": self._save, "/save-as": self._save_as, "/vary": self._vary}

    def page_content(self) -> dict[str, Any]:
        """Return what a page needs to ask."""
        content = {
            **self._told(self._asked({})),
            "fileName": f"{self._path.stem}-changed.yaml",
            "text": _with_plain_ends(self._start),
            "questions": QUESTIONS,
        }
        if not self._can_edit:
            return content
        file = {"name": self._path.name, "version": self._version, "saved": _with_plain_ends(self._saved)}
        return {**content, "edit": {**file, "schema": scene_json_schema()}}

    def refusal(self, error: Exception) -> dict[str, Any]:
        """Return what is wrong, for people who look at sliders or at the text; and where in the text."""
        if not isinstance(error, SceneFileError):
            return {"problems": [printable(str(error))]}
        problems, mistakes = [], []
        for problem in error.problems:
            words = printable(str(Problem(problem.path, problem.message)))
            problems.append(words)
            if isinstance(problem, FileProblem) and problem.source == self._source and problem.line is not None:
                mistakes.append({"line": problem.line, "column": problem.column, "words": words})
        return {"problems": problems, "mistakes": mistakes}

    def _run(self, asked: Question) -> dict[str, Any]:
        about = self._asked(asked)
        found = about.what_if.answer(asked.get("values", {}))
        found["text"] = _with_plain_ends(found["text"])
        return {**found, **self._told(about)}

    def _told(self, about: _Asked) -> dict[str, Any]:
        """What a page is told of a text beside its run: its controls, and the files that it names."""
        return {"controls": [control.document() for control in about.what_if.controls], "beside": about.beside}

    def _pull(self, asked: Question) -> dict[str, Any]:
        return self._asked(asked).what_if.pulled(asked.get("values", {}), asked.get("pull"))

    def _ask(self, asked: Question) -> dict[str, Any]:
        return self._asked(asked).what_if.told(asked.get("values", {}), asked.get("question"), asked.get("phase"))

    def _vary(self, asked: Question) -> dict[str, Any]:
        return runs_with(self._asked(asked).what_if.scene_text, asked.get("key"), asked.get("numbers"))

    def _asked(self, asked: Question) -> _Asked:
        is_start = asked.get("text") is None
        if not (is_start or self._can_edit):
            raise ValueError("the text cannot be changed from here; serve on this machine alone, without --host")
        text = self._start if is_start else _text(asked)
        names = list(files_named(self._scene_text_of(text).yaml.data).values())
        stamp = stamp_of(self._path.parent, names)
        return _Asked(self._what_if_of(text, stamp), {"names": names, "stamp": stamp})

    def _read(self, text: str) -> SceneText:
        return scene_text_of(text, self._source)

    def _made(self, text: str, _stamp: str) -> WhatIf:
        return WhatIf(self._read(text))  # anew, as it keeps what it was built of, and files beside are other ones

    def _file(self, asked: Question) -> dict[str, Any]:
        """The file as it is now, its text only where the page knows another version; and whether the files that its
        text names are other ones now.
        """
        names = asked.get("beside", [])
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ValueError("what is beside the scene is no list of names")
        return {**self._file_now(asked), "stamp": stamp_of(self._path.parent, names)}

    def _file_now(self, asked: Question) -> dict[str, Any]:
        try:
            content = self._content()
            if _version(content) == asked.get("version"):
                return {"version": asked["version"]}
            return {"version": _version(content), "text": _with_plain_ends(decoded(content, self._source))}
        except FileNotFoundError:
            return {"version": None, "problem": f"{self._path.name} is not there any more"}
        except (OSError, CageposeError) as error:
            return {"version": None, "problem": printable(f"{self._path.name} cannot be read: {error}")}

    def _content(self) -> bytes:
        with self._path.open("rb") as stream:
            return stream.read(MAX_FILE_BYTES + 1)

    def _save(self, asked: Question) -> dict[str, Any]:
        text, name = _text(asked), self._path.name
        with self._writing:
            try:
                before = self._content()
            except FileNotFoundError:
                raise ValueError(f"not saved: {name} is not there any more; save under another name") from None
            if _version(before) != asked.get("version"):
                raise ValueError(f"not saved: {name} was changed on disk since this page read it")
            content = _as_bytes(text, has_returns=b"\r\n" in before)
            mode = self._path.stat().st_mode
            if not mode & stat.S_IWRITE:
                raise ValueError(f"not saved: {name} is write-protected; save under another name")
            try:
                write_whole(self._path, content)
                self._path.chmod(mode)
            except OSError as error:
                raise _not_written(name, error) from None
        return {"version": _version(content)}

    def _save_as(self, asked: Question) -> dict[str, Any]:
        """Write a new file beside this one."""
        content, name = _as_bytes(_text(asked)), asked.get("name")
        if not isinstance(name, str) or not name.strip() or name != Path(name).name or "\\" in name or "\0" in name:
            raise ValueError("not saved: give the name of a file, without a folder")
        name = name.strip()
        if name.startswith("."):
            raise ValueError(f"not saved: {name} begins with a dot; give another name")
        name = name if name.endswith(SCENE_SUFFIXES) else f"{name}.yaml"
        try:
            with self._path.with_name(name).open("xb") as stream:
                stream.write(content)
        except FileExistsError:
            raise ValueError(f"not saved: {name} is there already; give another name") from None
        except OSError as error:
            raise _not_written(name, error) from None
        return {"name": name}


def _text(asked: Question) -> str:
    text = asked.get("text")
    if not isinstance(text, str):
        raise ValueError("the text of the scene is missing")
    return text


def _with_plain_ends(text: str) -> str:
    """Return a text with line ends as an editor in a browser has them."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _as_bytes(text: str, *, has_returns: bool = False) -> bytes:
    try:
        content = (text.replace("\n", "\r\n") if has_returns else text).encode()
    except UnicodeEncodeError:
        raise ValueError("the text holds half a character, which no file can hold; remove it") from None
    if len(content) > MAX_FILE_BYTES:
        raise ValueError(f"not saved: the text is larger than {MAX_FILE_BYTES // 1024**2} MiB")
    return content


def _not_written(name: str, error: OSError) -> ValueError:
    return ValueError(f"not saved: {name} cannot be written: {error.strerror or error}")


def _version(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
