"""Pages that play runs inside another page: `packed_pages`. What they share is there once, and all of it is gzipped."""

from __future__ import annotations

import gzip
import json
from base64 import b64encode
from collections.abc import Mapping
from functools import cache

from cagepose.views.viewer.page import DATA, data_text, page_of
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback


def packed_pages(shown: Mapping[str, Playback]) -> str:
    """Return runs by their names as JSON, which ``packed.js`` makes pages of: the text that they share, and the data of
    each. Names must not hold a ``<``.
    """
    runs = {name: _packed(data_text(page_data(one))) for name, one in shown.items()}
    return json.dumps({"page": _packed_page(), "runs": runs})


@cache
def _packed_page() -> str:
    return _packed(page_of("cagepose", DATA))


def _packed(text: str) -> str:
    return b64encode(gzip.compress(text.encode(), mtime=0)).decode()
