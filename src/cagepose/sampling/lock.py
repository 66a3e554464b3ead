"""One process at a time: a lock on a file that the system itself gives up when its holder ends, however it ends."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

NO_LOCKS = (errno.ENOSYS, errno.ENOTSUP, errno.ENOLCK)
"""What file systems answer that know no locks."""


NOT_TO_BE_WRITTEN = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT)
"""What is answered where a file of another one, or in a folder of another one, is to be written or not there."""


class LockedError(Exception):
    """Another process, or another place of this one, holds the lock."""


@contextmanager
def locked(path: str | os.PathLike[str]) -> Iterator[None]:
    """Hold the lock of a file, which is made if it is not there, and stays. Without it where there are no locks, and
    where the file cannot be made, as nothing else can be written there either.

    Raises
    ------
    LockedError
        It is held.
    OSError
        The file cannot be opened, for another reason than that it must not be written.
    """
    descriptor = _opened(path)
    if descriptor is None:
        yield
        return
    try:
        try:
            _lock(descriptor)
        except OSError as error:
            if error.errno in (errno.EACCES, errno.EAGAIN):
                raise LockedError from None
            if error.errno not in NO_LOCKS:
                raise
        yield
    finally:
        os.close(descriptor)  # gives up the lock, too


def _opened(path: str | os.PathLike[str]) -> int | None:
    """Open the file of a lock, to be read alone if it is another one's; None: there is none, and none may be made."""
    for flags in (os.O_RDWR | os.O_CREAT, os.O_RDONLY):
        try:
            return os.open(path, flags, 0o666)
        except OSError as error:
            if error.errno not in NOT_TO_BE_WRITTEN:
                raise
    return None


def _lock(descriptor: int) -> None:
    if sys.platform == "win32":
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
