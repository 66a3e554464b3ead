"""YAML 1.2 text as plain data, with the line and column of every value.

We build the data from the parser's events instead of letting a YAML library construct it: no tag is ever followed, no
alias expanded, nothing recurses, and numbers are read by the rules of YAML 1.2 alone (012 is 12, 1e-3 a number, 1_000
text).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from ruamel.yaml import YAML, events
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.reader import ReaderError

from cagepose.errors import FileProblem, Key, SceneFileError
from cagepose.files.key_path import Path

MAX_DEPTH = 32
"""A scene nests 6 levels deep; far more than that is a mistake or an attack."""

Mark = tuple[int, int]
"""Line and column, counted from 1."""

_INT = re.compile(r"[-+]?[0-9]+")
_OCTAL_OR_HEX = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)")
_WORDS: dict[str, object] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}


@dataclass
class YamlSource:
    """Plain data (dict, list, str, int, float, bool, None) and where each part of it stands.

    Attributes
    ----------
    data
        Mapping keys are always text, whatever they look like.
    source
        The file's name, for messages.
    values, keys
        Where the value of a path starts; where its key stands.
    problems
        What is wrong but does not stop the reading: keys given twice, tags, anchors and aliases.
    """

    data: object
    source: str
    values: dict[Path, Mark] = field(default_factory=dict)
    keys: dict[Path, Mark] = field(default_factory=dict)
    problems: list[FileProblem] = field(default_factory=list)

    def mark(self, path: Path, *, of_key: bool = False) -> Mark | None:
        """Return where ``path`` stands, or the closest part above it that is in the file."""
        for length in range(len(path), -1, -1):
            place = path[:length]
            if of_key and length == len(path) and place in self.keys:
                return self.keys[place]
            if place in self.values:
                return self.values[place]
        return None


def parse_yaml(text: str, source: str) -> YamlSource:
    """Read one YAML document.

    Raises
    ------
    SceneFileError
        Not YAML, empty, several documents, or nested deeper than `MAX_DEPTH`.
    """
    builder = _Builder(source)
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = None if mark is None else (mark.line + 1, mark.column + 1)
        raise builder.stopped(_syntax_message(error, text, place), place) from None
    except ReaderError as error:
        before = text[: error.position]
        place = (before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
        found = f"U+{ord(text[error.position]):04X}"
        raise builder.stopped(f"holds the control character {found}; remove it", place) from None
    except YAMLError as error:
        raise builder.stopped(f"is not YAML ({error}); correct it", None) from None
    if not builder.has_document:
        raise builder.stopped("is empty; write a scene into it (`cagepose init NAME` makes one to start from)", None)
    return builder.result


def scalar_value(text: str) -> object:
    """Return what a plain scalar means in YAML 1.2 (core schema).

    >>> [scalar_value(text) for text in ("012", "1e-3", "1_000", "yes", "null")]
    [12, 0.001, '1_000', 'yes', None]
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INT.fullmatch(text):
        # Above 300 digits a float would be infinite anyway, and Python refuses integers of more than 4300 digits.
        return int(text) if len(text) <= 300 else float(text)
    if _OCTAL_OR_HEX.fullmatch(text):
        return int(text, 0) if len(text) <= 250 else float("inf")
    if _FLOAT.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float(text.replace(".", ""))
    return text


@dataclass
class _Open:
    """A list or mapping that is being read."""

    container: list[object] | dict[Key, object]
    path: Path
    key: str | None = None
    key_mark: Mark = (1, 1)


class _Builder:
    def __init__(self, source: str) -> None:
        self.result = YamlSource(None, source)
        self.has_document = False
        self.open: list[_Open] = []

    def stopped(self, message: str, place: Mark | None) -> SceneFileError:
        """The error for what ends the reading, after all that was found before it."""
        line, column = place or (None, None)
        return SceneFileError([*self.result.problems, FileProblem((), message, self.result.source, line, column)])

    def take(self, event: events.Event) -> None:
        mark = (event.start_mark.line + 1, event.start_mark.column + 1)
        if isinstance(event, events.DocumentStartEvent):
            self._start_document(event, mark)
        elif isinstance(event, (events.MappingEndEvent, events.SequenceEndEvent)):
            self.open.pop()
        elif isinstance(event, events.NodeEvent):
            self._take_node(event, mark)

    def _start_document(self, event: events.DocumentStartEvent, mark: Mark) -> None:
        if self.has_document:
            raise self.stopped("starts a second document; keep one scene in a file and remove the line ---", mark)
        if event.version is not None and tuple(event.version) != (1, 2):
            raise self.stopped("asks for another YAML than 1.2; remove the %YAML line", mark)
        self.has_document = True

    def _take_node(self, event: events.NodeEvent, mark: Mark) -> None:
        top = self.open[-1] if self.open else None
        is_key = top is not None and isinstance(top.container, dict) and top.key is None
        if top is not None and is_key:
            if not isinstance(event, events.ScalarEvent):
                raise self.stopped("has a key that is not text; write keys as plain words", mark)
            top.key, top.key_mark = str(event.value), mark
            self._refuse_tags_and_anchors(event, (*top.path, top.key), mark)
            return
        path: Path = ()
        if top is not None:
            path = (*top.path, len(top.container) if isinstance(top.container, list) else str(top.key))
        self._refuse_tags_and_anchors(event, path, mark)
        value: object = None
        if isinstance(event, events.ScalarEvent):
            value = scalar_value(event.value) if event.implicit[0] else event.value
        elif isinstance(event, events.MappingStartEvent):
            value = {}
        elif isinstance(event, events.SequenceStartEvent):
            value = []
        self._place(value, path, mark, top, is_block=getattr(event, "flow_style", None) is False)
        if isinstance(value, (dict, list)):
            if len(self.open) == MAX_DEPTH:
                raise self.stopped(f"nests more than {MAX_DEPTH} levels deep; flatten it", mark)
            self.open.append(_Open(value, path))

    def _place(self, value: object, path: Path, mark: Mark, top: _Open | None, *, is_block: bool) -> None:
        if top is None:
            self.result.data = value
        elif isinstance(top.container, list):
            top.container.append(value)
        else:
            key, top.key = str(top.key), None
            if key in top.container:
                first_line = self.result.keys[path][0]
                message = f"stands here for the second time (first in line {first_line}); remove one of the two"
                self.result.problems.append(FileProblem(path, message, self.result.source, *top.key_mark))
                return
            top.container[key] = value
            self.result.keys.setdefault(path, top.key_mark)
            if is_block:
                mark = top.key_mark  # a block starts at its first key, lines below the key that a user looks for
        self.result.values.setdefault(path, mark)

    def _refuse_tags_and_anchors(self, event: events.NodeEvent, path: Path, mark: Mark) -> None:
        message = None
        if isinstance(event, events.AliasEvent):
            message = f"is the alias *{event.anchor}; write the value itself (scene files have no anchors and aliases)"
        elif event.anchor:
            message = f"has the anchor &{event.anchor}; remove it (scene files have no anchors and aliases)"
        elif (tag := getattr(event, "tag", None)) is not None:
            message = f"has the tag {tag}; remove it (scene files have no tags)"
        if message is not None:
            self.result.problems.append(FileProblem(path, message, self.result.source, *mark))


def _syntax_message(error: MarkedYAMLError, text: str, place: Mark | None) -> str:
    """The parser's words, with a remedy for the slips that people make."""
    problem = " ".join(str(error.problem or error.context or "unreadable").split())
    line = text.splitlines()[place[0] - 1] if place and place[0] <= len(text.splitlines()) else ""
    if place and "\t" in line[: place[1]] and "\\t" in problem:
        return "has a tab as indentation; use spaces"
    if "mapping values are not allowed" in problem:
        return "is not YAML: a second colon, or a line indented differently from those above; check both"
    if "end of stream" in problem or "<stream end>" in problem:
        problem = problem.replace("'<stream end>'", "the end of the file").replace("stream", "file")
        return f"is not YAML: {problem}; close the bracket or quote that is open"
    if "but got '['" in problem:
        return f"is not YAML: {problem}; put a key with brackets in quotes where it stands within {{ }} or [ ]"
    return f"is not YAML: {problem}; correct this line or the one above"
