"""How pages and reports fill in their templates."""

from __future__ import annotations

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined


def environment(package: str, folder: str = "templates") -> Environment:
    """Return what fills in the templates in a folder of a package, which may include those of `cagepose.views`: escaped
    for HTML; a name that is not given is an error.
    """
    return Environment(
        loader=ChoiceLoader([PackageLoader(package, folder), PackageLoader("cagepose.views", "pages")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
