from __future__ import annotations

import pytest

SAMPLE = """\
name: sample
object:
  boxes:
    - size: [10, 10, 10]
      position: [0, 0, 0]
  pose: {position: [2, 4, 10]}
cage:
  points: [[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]
loads:
  - name: gravity
    gravity: [0, 0, -1]
"""


@pytest.fixture
def sample_text() -> str:
    return SAMPLE
