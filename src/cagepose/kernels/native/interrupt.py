"""How a kernel that takes long ends early: it asks, in each of its loops that others are made of, whether it shall."""

from __future__ import annotations

import threading

# What `signal` wraps in enumerations, which takes 3 us.
from _signal import SIGINT, default_int_handler, getsignal  # type: ignore[import-not-found]


def heed_interrupt() -> None:
    """Do nothing: plain Python hears Ctrl-C between any two lines.

    The build puts in its place what raises an exception once the call is to end (``build_kernels/interrupt.c``).
    """


def is_heard_here() -> bool:
    """Whether Ctrl-C shall end a call that is made now: in the main thread, where Python's own handler turns it into
    KeyboardInterrupt. Whoever has put another handler there decides what becomes of it.
    """
    in_main_thread = threading.get_ident() == threading.main_thread().ident
    return in_main_thread and getsignal(SIGINT) is default_int_handler
