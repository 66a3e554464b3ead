"""What work that takes seconds is at: told by those who do it (`tell`) to whoever asked to hear it (`told_to`)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Listener = Callable[[str], None]

_listener: ContextVar[Listener | None] = ContextVar("listener", default=None)


def tell(doing: str) -> None:
    """Say what is begun now; nothing: it is done."""
    listener = _listener.get()
    if listener is not None:
        listener(doing)


@contextmanager
def told_to(listener: Listener | None) -> Iterator[None]:
    """Let somebody hear what is told within; None: nobody."""
    before = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(before)
