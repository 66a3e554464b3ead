from __future__ import annotations

import pytest

from cagepose.kernels.stability import uniqueness
from jit import JIT_IS_OFF


@pytest.fixture(autouse=True)
def short_search_as_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The proof of a run may ask four thousand systems for another onset: 20 ms compiled, a minute as plain Python."""
    if JIT_IS_OFF:
        monkeypatch.setattr(uniqueness, "SYSTEM_LIMIT", 40)
