"""One self-contained page that plays a run in any browser, with no network."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from cagepose.views.viewer.editing import Desk
from cagepose.views.viewer.hand import grips
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback

DATA = "@DATA@"
"""Where the data of a run stand in the page."""


def page(shown: Playback, desk: Desk | None = None) -> str:
    """Return the page. It asks nothing of any server, and tells the browser to allow nothing else.

    With ``desk`` it has controls and, where the text may be edited, an editor, and asks the server that it came from.
    """
    content = page_data(shown)
    if desk is None:
        return page_of(shown.run.scene.name, data_text(content))
    content |= {**desk.page_content(), "grips": grips(shown.run)}
    connect = "; connect-src 'self'"
    return page_of(shown.run.scene.name, data_text(content), connect, has_editor="edit" in content)


def page_of(title: str, data: str, connect: str = "", *, has_editor: bool = False) -> str:
    """Return the page with a title and data of a run; ``connect``: what it may ask of a server."""
    parts = {
        "@TITLE@": html.escape(title),
        "@CONNECT@": connect,
        "@STYLE@": _read("page.css"),
        DATA: data,
        "@EDITOR@": _editor() if has_editor else "",
        "@SCRIPT@": _script("page.js"),
    }
    template = _read("page.html")
    return re.sub("@[A-Z]+@", lambda place: parts[place[0]], template)


def _editor() -> str:
    return f"<style>\n{_read('editor.css')}\n</style>\n<script>\n{_script('editor.js')}\n</script>\n"


def _script(name: str) -> str:
    return _read(name).replace("</script", "<\\/script")


def _read(name: str) -> str:
    return (files("cagepose.views.viewer") / "page" / name).read_text(encoding="utf-8")


def data_text(content: Mapping[str, Any]) -> str:
    """Return data as they stand in a page."""
    data = json.dumps(content, allow_nan=False, separators=(",", ":"))
    return data.replace("<", "\\u003c")  # a name may hold </script>
