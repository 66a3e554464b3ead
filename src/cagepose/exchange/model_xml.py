"""XML of models: `parsed`, whose elements know where they stand, and `LineText`, which MuJoCo's compiler gets."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from cagepose.errors import FileProblem, SceneFileError
from cagepose.files.read import MAX_FILE_BYTES, read_text

DECLARATIONS = re.compile("<!(DOCTYPE|ENTITY)", re.IGNORECASE)
MOST_ELEMENTS = 50_000
"""Of a model with all that it includes. The greatest that we know, a dog with its bones, has 2,500."""
SAID_LINE = re.compile(r",? ?\bline (\d+)")
"""How MuJoCo says where an element stands."""


class Place(NamedTuple):
    """Where an element begins: its file, line and column."""

    source: str
    line: int
    column: int


Places = dict[Element, Place]


def parsed(path: Path, source: str, places: Places) -> Element:
    """Return the root element of a file, and note where its elements stand; names keep their prefixes.

    Raises
    ------
    SceneFileError
        It cannot be read, is larger than `MAX_FILE_BYTES`, is no XML, declares entities, or has too many elements.
    """
    if path.is_file() and path.stat().st_size > MAX_FILE_BYTES:
        message = f"is larger than {MAX_FILE_BYTES // 1024**2} MiB, the size limit of models; put meshes into files"
        raise SceneFileError([FileProblem((), message, source)])
    text = read_text(path, source)
    if DECLARATIONS.search(text):
        message = "declares a document type or entities, which models need not and bombs are made of; remove them"
        raise SceneFileError([FileProblem((), message, source)])
    builder, parser = TreeBuilder(), expat.ParserCreate("utf-8")

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(places) >= MOST_ELEMENTS:
            message = f"has more than {MOST_ELEMENTS:,} elements; import the bodies that touch alone"
            raise SceneFileError([FileProblem((), message, source, parser.CurrentLineNumber, 1)])
        places[builder.start(tag, attributes)] = Place(source, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    parser.StartElementHandler, parser.EndElementHandler = start, builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        message = f"is not XML ({str(error).partition(':')[0]}); correct this line"
        raise SceneFileError([FileProblem((), message, source, error.lineno, error.offset + 1)]) from None
    root: Element = builder.close()
    return root


class LineText(NamedTuple):
    """A model as text with one element a line.

    Attributes
    ----------
    text
        Elements and attributes; what stands between elements no compiler asks for.
    places
        Where the element of each line stands in the files that it came from; None: it ends there.
    """

    text: str
    places: tuple[Place | None, ...]

    @classmethod
    def of(cls, root: Element, places: Places) -> LineText:
        lines, found = list[str](), list[Place | None]()

        def write(element: Element) -> None:
            given = "".join(f" {key}={quoteattr(value)}" for key, value in element.attrib.items())
            lines.append(f"<{element.tag}{given}{'' if len(element) else '/'}>")
            found.append(places.get(element))
            for child in element:
                write(child)
            if len(element):
                lines.append(f"</{element.tag}>")
                found.append(None)

        write(root)
        return cls("\n".join(lines), tuple(found))

    def problem(self, message: str, source: str) -> FileProblem:
        """Return what a compiler of the text says, with the lines of the files instead of the text's."""
        said = SAID_LINE.search(message)
        line = int(said[1]) - 1 if said else -1
        place = self.places[line] if 0 <= line < len(self.places) else None
        return FileProblem((), SAID_LINE.sub("", message), *(place or (source,)))
