"""The bundle of the page is made of the sources that stand beside it."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[3] / "page"
BUNDLE = files("cagepose.views.viewer") / "page" / "page.js"


def test_the_bundle_names_the_sources_that_it_was_made_of():
    """Needs no node: the bundle's first line has the digest of all sources."""
    names = sorted(path.name for path in SOURCES.iterdir() if re.search(r"\.m?js$|^package.*json$", path.name))
    digest = hashlib.sha256()
    for name in names:
        digest.update(f"{name}\n".encode() + (SOURCES / name).read_bytes())
    first_line = BUNDLE.read_text(encoding="utf-8").partition("\n")[0]
    assert digest.hexdigest() in first_line, "the page's sources were changed; run `make page`"


def test_the_bundle_has_the_licence_of_what_it_contains():
    head = BUNDLE.read_text(encoding="utf-8")[:3000]
    assert "three.js authors" in head
    assert "The MIT License" in head


def test_the_bundle_is_what_the_sources_give(tmp_path):
    if shutil.which("node") is None or not (SOURCES / "node_modules").is_dir():
        pytest.skip("node or page/node_modules is missing; `make page` uses the one to install the other")
    built = tmp_path / "page.js"
    subprocess.run(["node", SOURCES / "build.mjs", built], check=True, timeout=120)
    assert built.read_text(encoding="utf-8") == BUNDLE.read_text(encoding="utf-8")
