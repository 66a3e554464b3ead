from __future__ import annotations

import pytest

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.native.library import kernel_library
from cagepose.kernels.stability import strong

dtype_of(strong.ModeTree)  # its layout is that of the limit that is, whichever test comes first


@pytest.fixture(autouse=True)
def short_search_as_plain_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The proof of a run may divide contact modes thousands of times: 0.1 s, and minutes as plain Python."""
    if kernel_library() is None:
        monkeypatch.setattr(strong, "NODE_LIMIT", 40)
