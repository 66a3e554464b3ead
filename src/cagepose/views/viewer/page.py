"""One self-contained page that plays a run in any browser, with no network."""

from __future__ import annotations

import html
import json
import re
from importlib.resources import files

from cagepose.views.viewer.hand import grips
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback
from cagepose.views.viewer.what_if import WhatIf


def page(shown: Playback, what_if: WhatIf | None = None) -> str:
    """Return the page. It asks nothing of any server, and tells the browser to allow nothing else.

    With ``what_if`` it has controls, and asks the server that it came from.
    """
    folder = files("cagepose.views.viewer") / "page"
    content = page_data(shown)
    if what_if is not None:
        content["controls"] = [control.document() for control in what_if.controls]
        content["fileName"] = what_if.file_name
        content["grips"] = grips(shown.run)
    data = json.dumps(content, allow_nan=False, separators=(",", ":"))
    parts = {
        "@TITLE@": html.escape(shown.run.scene.name),
        "@CONNECT@": "" if what_if is None else "; connect-src 'self'",
        "@STYLE@": (folder / "page.css").read_text(encoding="utf-8"),
        "@DATA@": data.replace("<", "\\u003c"),  # a name may hold </script>
        "@SCRIPT@": (folder / "page.js").read_text(encoding="utf-8").replace("</script", "<\\/script"),
    }
    template = (folder / "page.html").read_text(encoding="utf-8")
    return re.sub("@[A-Z]+@", lambda place: parts[place[0]], template)
