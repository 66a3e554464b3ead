"""Is an extra there? Asked before anything is run, so that nobody waits for what cannot be made."""

from __future__ import annotations

from cagepose.files.extra import require

STUDY_MODULES = {
    "scipy": "SciPy",
    "pyarrow": "pyarrow",
    "SALib": "SALib",
    "jinja2": "Jinja2",
    "matplotlib": "matplotlib",
    "PIL": "Pillow",
}


def require_pillow() -> None:
    """Do nothing if Pillow is installed.

    Raises
    ------
    MissingExtraError
        It is not; the message says how to install it.
    """
    require("PIL", "pictures need Pillow", "view")


def require_film() -> None:
    """Do nothing if all is installed that videos need.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require("PIL", "videos need Pillow", "film")
    require("av", "videos need PyAV", "film")


def require_matplotlib() -> None:
    """Do nothing if matplotlib is installed.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require("matplotlib", "pictures need matplotlib", "plot")


def require_report() -> None:
    """Do nothing if all is installed that the paper's report needs.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require_matplotlib()
    require("jinja2", "the report needs Jinja2", "plot")
    require("markdown_it", "the report needs markdown-it-py", "plot")


def require_import_page() -> None:
    """Do nothing if all is installed that a page about an import needs.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require_pillow()
    require("jinja2", "the page needs Jinja2", "plot")


def require_insertion_page() -> None:
    """Do nothing if all is installed that a page about an insertion needs.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require_matplotlib()
    require("jinja2", "the page needs Jinja2", "plot")
    require_pillow()


def require_study() -> None:
    """Do nothing if all is installed that studies of many runs need.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    for module, name in STUDY_MODULES.items():
        require(module, f"studies need {name}", "study")


def require_dask() -> None:
    """Do nothing if Dask is installed.

    Raises
    ------
    MissingExtraError
        As `require_pillow`.
    """
    require("distributed", "many machines need Dask", "dask")
