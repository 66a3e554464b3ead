"""Is an extra there? Asked before anything is run, so that nobody waits for what cannot be made."""

from __future__ import annotations

from importlib.util import find_spec

from cagepose.errors import MissingExtraError

STUDY_MODULES = {
    "scipy": "SciPy",
    "pyarrow": "pyarrow",
    "SALib": "SALib",
    "jinja2": "Jinja2",
    "matplotlib": "matplotlib",
}


def require_pillow() -> None:
    """Do nothing if Pillow is installed.

    Raises
    ------
    MissingExtraError
        It is not; the message says how to install it.
    """
    _require("PIL", "pictures need Pillow", "view")


def require_matplotlib() -> None:
    """Do nothing if matplotlib is installed.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    _require("matplotlib", "pictures need matplotlib", "plot")


def require_report() -> None:
    """Do nothing if all is installed that the paper's report needs.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require_matplotlib()
    _require("jinja2", "the report needs Jinja2", "plot")
    _require("markdown_it", "the report needs markdown-it-py", "plot")


def require_study() -> None:
    """Do nothing if all is installed that studies of many runs need.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    for module, name in STUDY_MODULES.items():
        _require(module, f"studies need {name}", "study")


def require_dask() -> None:
    """Do nothing if Dask is installed.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    _require("distributed", "many machines need Dask", "dask")


def _require(module: str, need: str, extra: str) -> None:
    if find_spec(module) is None:
        raise MissingExtraError(
            f"{need}, which is not installed; install the {extra} extra: pip install 'cagepose[{extra}]'"
        )
