"""A lock in a folder that must not be written."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cagepose.sampling.lock import LockedError, locked


def test_a_lock_of_another_user_is_read_and_one_that_cannot_be_made_is_gone_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = os.open

    def only_read(path: str, flags: int, mode: int = 0o777) -> int:
        if flags & os.O_RDWR:
            raise PermissionError(13, "not yours")
        return opened(path, flags, mode)

    (tmp_path / "theirs").touch()
    with locked(tmp_path / "theirs"):
        monkeypatch.setattr(os, "open", only_read)
        with pytest.raises(LockedError), locked(tmp_path / "theirs"):
            pass
    with locked(tmp_path / "theirs"), locked(tmp_path / "none"):
        assert not (tmp_path / "none").exists()
