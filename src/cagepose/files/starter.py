"""A first scene to change: what ``cagepose init`` writes."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from cagepose.files.yaml_source import scalar_value


def starter_text(name: str, *, holes: bool = False) -> str:
    """Return the text of a commented scene named ``name``: of boxes and points, or of a pin in a round hole."""
    quoted = name if isinstance(scalar_value(name), str) else f'"{name}"'  # "null" and "true" are words of YAML
    template = (
        files("cagepose.files").joinpath("starter_holes.yaml" if holes else "starter.yaml").read_text(encoding="utf-8")
    )
    return template.replace("name: starter\n", f"name: {quoted}\n", 1).replace("starter.yaml", f"{name}.yaml")


def write_starter(name: str, folder: Path = Path(), *, holes: bool = False) -> Path:
    """Write ``NAME.yaml`` into ``folder`` and return its path; see `starter_text`. An existing file is left alone.

    Raises
    ------
    ValueError
        A name that is no plain file name.
    OSError
        The file exists already or cannot be written.
    """
    name = name.removesuffix(".yaml")
    if not name[:1].isalpha() or not all(char.isalnum() or char in "-_" for char in name) or len(name) > 100:
        raise ValueError(f"{name!r} is not a name; start with a letter and use letters, digits, - and _ only")
    path = folder / f"{name}.yaml"
    with path.open("x", encoding="utf-8") as stream:
        stream.write(starter_text(name, holes=holes))
    return path
