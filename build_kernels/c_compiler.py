"""Which C compiler links the library: `c_compiler`. Needs nothing but Python."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
import sysconfig


def c_compiler() -> list[str] | None:
    """Return the command of the machine's C compiler; None: there is none.

    What ``CC`` names comes first, then what Python was built with, then the usual names.
    """
    if sys.platform == "win32":
        return None
    for named in (os.environ.get("CC"), sysconfig.get_config_var("CC"), "cc", "gcc", "clang"):
        command = shlex.split(named or "")
        if command and shutil.which(command[0]):
            return command
    return None
