from __future__ import annotations

import pytest

from cagepose.kernels.native.library import kernel_library
from cagepose.kernels.stability import uniqueness


@pytest.fixture(autouse=True)
def short_search_as_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The proof of a run may ask four thousand systems for another onset: 20 ms, and a minute as plain Python."""
    if kernel_library() is None:
        monkeypatch.setattr(uniqueness, "SYSTEM_LIMIT", 40)
