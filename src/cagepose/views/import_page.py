"""A page about an import: what became of each solid or body, and pictures of both: `write_import_page`."""

from __future__ import annotations

import io
import os
from base64 import b64encode
from collections.abc import Sequence

from cagepose.exchange.import_summary import HEADINGS, summary_rows, weight_words
from cagepose.exchange.imported import Import
from cagepose.exchange.tolerances import ROUNDING_OF_MEASURES
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, write_whole
from cagepose.views.source_picture import Pair, pictures_of
from cagepose.views.templates import environment


def write_import_page(found: Import, path: str | os.PathLike[str]) -> None:
    """Write a page that stands alone.

    Raises
    ------
    OSError
        It cannot be written, or something else than a page of ours stands there.
    """
    check_can_write(path, is_made_by_us, "a page or picture that cagepose made")
    bodies = [(body, [part for part in found.parts if part.body == body]) for body in ("object", "cage")]
    text = (
        environment("cagepose.views", "pages")
        .get_template("import.jinja")
        .render(
            made_by=MADE_BY,
            scene=found.scene.name,
            headings=HEADINGS,
            rows=summary_rows(found.parts),
            rounding=f"{ROUNDING_OF_MEASURES:g}",
            weight=weight_words(found.weight) if found.weight else "",
            notes=found.notes,
            pictures=[(body, [_embedded(pair) for pair in pictures_of(parts)]) for body, parts in bodies if parts],
        )
    )
    write_whole(path, text.encode())


def _embedded(pair: Pair) -> Sequence[str]:
    found = []
    for picture in pair:
        stream = io.BytesIO()
        picture.save(stream, "PNG")
        found.append(b64encode(stream.getvalue()).decode())
    return found
