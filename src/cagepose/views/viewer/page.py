"""One self-contained page that plays a run in any browser, with no network."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from cagepose.views.viewer.hand import grips
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback
from cagepose.views.viewer.what_if import WhatIf

DATA = "@DATA@"
"""Where the data of a run stand in the page."""


def page(shown: Playback, what_if: WhatIf | None = None) -> str:
    """Return the page. It asks nothing of any server, and tells the browser to allow nothing else.

    With ``what_if`` it has controls, and asks the server that it came from.
    """
    content = page_data(shown)
    if what_if is not None:
        content["controls"] = [control.document() for control in what_if.controls]
        content["fileName"] = what_if.file_name
        content["grips"] = grips(shown.run)
    return page_of(shown.run.scene.name, data_text(content), "" if what_if is None else "; connect-src 'self'")


def page_of(title: str, data: str, connect: str = "") -> str:
    """Return the page with a title and data of a run; ``connect``: what it may ask of a server."""
    folder = files("cagepose.views.viewer") / "page"
    parts = {
        "@TITLE@": html.escape(title),
        "@CONNECT@": connect,
        "@STYLE@": (folder / "page.css").read_text(encoding="utf-8"),
        DATA: data,
        "@SCRIPT@": (folder / "page.js").read_text(encoding="utf-8").replace("</script", "<\\/script"),
    }
    template = (folder / "page.html").read_text(encoding="utf-8")
    return re.sub("@[A-Z]+@", lambda place: parts[place[0]], template)


def data_text(content: Mapping[str, Any]) -> str:
    """Return data as they stand in a page."""
    data = json.dumps(content, allow_nan=False, separators=(",", ":"))
    return data.replace("<", "\\u003c")  # a name may hold </script>
