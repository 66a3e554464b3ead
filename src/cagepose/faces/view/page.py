"""One self-contained page that plays a run in any browser, with no network."""

from __future__ import annotations

import html
import json
import re
from importlib.resources import files

from cagepose.faces.view.page_data import page_data
from cagepose.faces.view.playback import Playback

SCRIPTS = ("geometry", "stage", "painter", "camera", "drawing", "plot", "player")
"""In this order; each uses only those before it."""


def page(shown: Playback) -> str:
    """Return the page. It asks nothing of any server, and tells the browser to allow nothing else."""
    folder = files("cagepose.faces.view") / "page"
    data = json.dumps(page_data(shown), allow_nan=False, separators=(",", ":"))
    parts = {
        "@TITLE@": html.escape(shown.run.scene.name),
        "@STYLE@": (folder / "page.css").read_text(encoding="utf-8"),
        "@DATA@": data.replace("<", "\\u003c"),  # a name may hold </script>
        "@SCRIPT@": "\n".join((folder / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS),
    }
    template = (folder / "page.html").read_text(encoding="utf-8")
    return re.sub("@[A-Z]+@", lambda place: parts[place[0]], template)
