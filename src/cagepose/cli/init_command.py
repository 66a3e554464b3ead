"""``cagepose init``: a commented scene to start from."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter


def init_command(
    name: Annotated[str, Parameter(help="The scene's name; the file is NAME.yaml.")],
    /,
    *,
    holes: Annotated[
        bool, Parameter(negative="", show_default=False, help="A pin in a round hole, instead of a plate on points.")
    ] = False,
) -> int:
    """Write NAME.yaml into the current folder; an existing file is left alone."""
    from cagepose.errors import printable
    from cagepose.files.starter import write_starter

    try:
        path = write_starter(name, holes=holes)
    except FileExistsError:
        message = "exists already; choose another name or remove the file"
        sys.stderr.write(printable(f"{name.removesuffix('.yaml')}.yaml: {message}") + "\n")
        return 2
    except OSError as error:
        message = f"cannot be written ({error.strerror}); choose another folder"
        sys.stderr.write(printable(f"{name.removesuffix('.yaml')}.yaml: {message}") + "\n")
        return 2
    except ValueError as error:
        sys.stderr.write(f"cagepose init: {error}\n")
        return 2
    sys.stdout.write(f"wrote {path}; try: cagepose run {path}\n")
    return 0
