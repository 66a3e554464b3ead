"""The command ``cagepose``: which commands there are, and what becomes of an error.

Exit codes: 0 a verdict was reached, 1 the run failed by name, 2 bad input, 3 a bug of ours.
The overview is printed without loading any command, and each command loads only what it needs.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import io
import os
import sys
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from cagepose.files.progress import told_to

if TYPE_CHECKING:
    from pathlib import Path

    from cyclopts import App, CycloptsError

BAD_INPUT = 2
EXIT_OF_BUG = 3
EXIT_INTERRUPTED = 130
OBJECTS_BETWEEN_COLLECTIONS = 100_000
COLUMNS_SHOWN = 78
"""Columns of what a command is doing."""
BROKEN_PIPE = 141  # 128 + SIGPIPE
STANDARD_INPUT = "/dev/stdin"
"""Its name where there are such files, and in messages elsewhere, too."""

PURPOSE = "How much play a loosely held part has, where it comes to rest, through which contacts, and why."
COMMANDS = {
    "run": (
        "cagepose.cli.run_command:run_command",
        "Where the part comes to rest: events, contact forces, final pose, verdict.",
    ),
    "compare": (
        "cagepose.cli.compare_command:compare_command",
        "Run a scene by mechanics and by the paper's rules: where do the two differ?",
    ),
    "play": (
        "cagepose.cli.play_command:play_command",
        "How much play the part has in each direction, what limits it, and whether it can get out.",
    ),
    "insertion": (
        "cagepose.cli.insertion_command:insertion_command",
        "How far a drive gets, with which force, where it could jam, and the misalignment it permits.",
    ),
    "ask": (
        "cagepose.cli.ask_command:ask",
        "Ask one question, answered with its certainty, such as: how much friction does this need?",
    ),
    "check": (
        "cagepose.cli.check_command:check_command",
        "Check a scene file without running it, or the proofs of a saved run.",
    ),
    "plot": ("cagepose.cli.plot_command:plot_command", "Draw a scene's run, or a saved run, into a picture file."),
    "view": (
        "cagepose.cli.view_command:view_command",
        "See a run in three dimensions: live, or as a page that plays offline.",
    ),
    "study": (
        "cagepose.cli.study_command:study_command",
        "Run a scene many times with numbers that vary: yield, tolerances, sensitivities.",
    ),
    "design": (
        "cagepose.cli.design_command:design_command",
        "Find the loosest value of a number that still gives a wanted yield or capture range.",
    ),
    "reproduce": (
        "cagepose.cli.reproduce_command:reproduce_command",
        "Run the paper's cases and write a report of its numbers beside ours.",
    ),
    "export": (
        "cagepose.cli.export_command:export_command",
        "Write a scene and its final poses for other programs: MJCF, URDF, STEP, STL, CSV.",
    ),
    "import": (
        "cagepose.cli.import_command:import_command",
        "Make a scene from an MJCF, URDF, STEP, STL, OBJ, PLY or GLB file, or from several files of parts.",
    ),
    "crosscheck": (
        "cagepose.cli.crosscheck_command:crosscheck_command",
        "Run a scene in MuJoCo as well: does it end at the same poses, and if not, why?",
    ),
    "schema": ("cagepose.cli.schema_command:schema_command", "Print the JSON Schema of scene files, for editors."),
    "init": (
        "cagepose.cli.init_command:init_command",
        "Write a commented scene to start from: a plate in a fixture, or with --holes a pin in a hole.",
    ),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; ``arguments`` are those of the process if left out."""
    if arguments is not None:
        return _run(list(arguments))
    # The process is ours. Python looks for garbage after each 700 new objects, hundreds of times while it imports, and
    # at the end once more through all of them: a fifth of the time of a short run.
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    try:
        return _run(sys.argv[1:])
    finally:
        gc.freeze()


def _run(tokens: list[str]) -> int:
    if sys.stderr is None:  # the shell closed it; Python then has none
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  (for as long as the process lives)
    if sys.stdout is None:
        sys.stderr.write("cagepose: standard output is closed; send it to a file, or to /dev/null\n")
        return BAD_INPUT
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a name that the terminal cannot show is no reason to stop
    try:
        with told_to(_show if sys.stderr.isatty() else None):
            code = _dispatch(tokens)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        sys.stderr.write("cagepose: stopped\n")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        _abandon_output()  # whoever read it has left
        return BROKEN_PIPE
    except Exception as error:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EIO, errno.EDQUOT):
            _abandon_output()
            sys.stderr.write(f"cagepose: the output cannot be written: {error.strerror}\n")
            return BAD_INPUT
        import traceback  # 10 ms that only this branch needs

        traceback.print_exc()
        sys.stderr.write("cagepose: this is a bug of ours; please report it with the lines above and the scene file\n")
        return EXIT_OF_BUG


def _show(doing: str) -> None:
    """Show on a terminal what is being done, in the place of what was before."""
    sys.stderr.write(f"\r{doing[:COLUMNS_SHOWN]:{COLUMNS_SHOWN}}\r")
    sys.stderr.flush()


def _abandon_output() -> None:
    """Send what is left of standard output nowhere, or Python would complain once more when it closes it."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _dispatch(tokens: list[str]) -> int:
    if tokens in ([], ["-h"], ["--help"]):
        sys.stdout.write(overview())
        return 0
    if tokens == ["--version"]:
        from cagepose import __version__

        sys.stdout.write(f"cagepose {__version__}\n")
        return 0

    from cyclopts import App, CycloptsError
    from cyclopts.completion.install import create_install_completion_command

    from cagepose.errors import CageposeError

    if tokens[0] == "run":
        tokens = [*map(_named_input, ["", *tokens], tokens)]
    app = App(
        name="cagepose",
        help=PURPOSE,
        version_flags=[],
        help_format="plaintext",  # our help texts need no Markdown parser, which costs 0.05 s
        suppress_keyboard_interrupt=False,
    )
    for name, (home, summary) in COMMANDS.items():
        app.command(home, name=name, help=summary)
    app.command(
        create_install_completion_command(partial(_install_completion, app), False), name="--install-completion"
    )
    try:
        code = app(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        if _is_scene_name(tokens[0]):
            sys.stderr.write(f"cagepose: {tokens[0]} is no command; did you mean: cagepose run {tokens[0]}\n")
            return BAD_INPUT
        help_command = f"cagepose {tokens[0]} --help" if tokens[0] in COMMANDS else "cagepose --help"
        sys.stderr.write(f"cagepose: {_usage_message(error)} See: {help_command}\n")
        return BAD_INPUT
    except CageposeError as error:
        sys.stderr.write(f"{error}\n")
        return BAD_INPUT
    return int(code or 0)  # help returns None


def _install_completion(app: App, **options: Any) -> Path:
    """Write the script for a shell; cyclopts' own for bash breaks names at spaces, and stops after a folder's."""
    path = app.install_completion(**options)
    script = path.read_text(encoding="utf-8").replace("\ncomplete -F", "\ncomplete -o filenames -F")
    script = script.replace("COMPREPLY=( $(compgen -f", r"local IFS=$'\n'; COMPREPLY=( $(compgen -f")
    path.write_text(script, encoding="utf-8")
    return path


def _named_input(before: str, token: str) -> str:
    """A lone dash is the name of standard input, and no option, unless an option in front of it takes a value."""
    return STANDARD_INPUT if token == "-" and before not in ("--set", "--method", "--out") else token


def _is_scene_name(token: str) -> bool:
    from cagepose.files.read import SCENE_SUFFIXES

    return token.endswith(SCENE_SUFFIXES)


def _usage_message(error: CycloptsError) -> str:
    from cyclopts import UnusedCliTokensError

    if isinstance(error, UnusedCliTokensError):
        unused = error.unused_tokens or []
        if unused and _is_scene_name(unused[0]):
            return f"one scene at a time, and {' '.join(unused)} is left over; run the command once for each."
        return f"too many arguments: {' '.join(unused)}; each change needs its own --set."
    return " ".join(str(error).split())


def overview() -> str:
    """Return what ``cagepose --help`` prints."""
    width = max(len(name) for name in (*COMMANDS, "--version"))
    lines = [f"  {name:{width}}  {summary}" for name, (_, summary) in COMMANDS.items()]
    return "\n".join(
        (
            "Usage: cagepose COMMAND",
            "",
            PURPOSE,
            "",
            "Commands:",
            *lines,
            f"  {'--version':{width}}  Print the version.",
            f"  {'--help':{width}}  Print this, or the help of a command: cagepose run --help",
            "",
            "Begin with: cagepose init myscene, then cagepose run myscene.yaml",
            "Completion with the tab key in your shell: cagepose --install-completion",
            "",
        )
    )
