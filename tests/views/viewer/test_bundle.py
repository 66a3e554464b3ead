"""The bundles of the page are made of the sources that stand beside them."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[3] / "page"
BUILT = files("cagepose.views.viewer") / "page"
BUNDLES = ("page.js", "editor.js")


@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_names_the_sources_that_it_was_made_of(name: str) -> None:
    """Needs no node: the bundle's first line has the digest of all sources."""
    names = sorted(path.name for path in SOURCES.iterdir() if re.search(r"\.m?js$|^package.*json$", path.name))
    digest = hashlib.sha256()
    for source in names:
        digest.update(f"{source}\n".encode() + (SOURCES / source).read_bytes())
    first_line = (BUILT / name).read_text(encoding="utf-8").partition("\n")[0]
    assert digest.hexdigest() in first_line, "the page's sources were changed; run `make page`"


@pytest.mark.parametrize(
    ("name", "owners"),
    [("page.js", ["three.js authors"]), ("editor.js", ["Marijn Haverbeke", "@codemirror/view", "@lezer/yaml"])],
)
def test_a_bundle_has_the_licences_of_what_it_contains(name: str, owners: list[str]) -> None:
    head = (BUILT / name).read_text(encoding="utf-8")[:12_000]
    assert all(owner in head for owner in [*owners, "Permission is hereby granted, free of charge"])


def test_the_bundles_are_what_the_sources_give(tmp_path: Path) -> None:
    if shutil.which("node") is None or not (SOURCES / "node_modules").is_dir():
        pytest.skip("node or page/node_modules is missing; `make page` uses the one to install the other")
    subprocess.run(["node", SOURCES / "build.mjs", tmp_path], check=True, timeout=120)
    for name in BUNDLES:
        assert (tmp_path / name).read_text(encoding="utf-8") == (BUILT / name).read_text(encoding="utf-8")
