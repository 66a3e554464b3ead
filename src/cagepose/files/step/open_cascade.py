"""What is asked of shapes of Open CASCADE: `each`, `moments_of`, `xyz`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any


def each(kind: str, shape: Any) -> Iterator[Any]:
    """Yield the parts of a shape that are of a kind: "Solid", "Face" or "Edge"."""
    from OCP import TopAbs
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    explorer = TopExp_Explorer(shape, getattr(TopAbs, f"TopAbs_{kind.upper()}"))
    while explorer.More():
        yield getattr(TopoDS, kind)(explorer.Current())
        explorer.Next()


def moments_of(shape: Any, *, of_surface: bool = False) -> Any:
    """Return what Open CASCADE says of a solid's volume, or of a surface's area, and of its middle and inertia."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    (BRepGProp.SurfaceProperties_s if of_surface else BRepGProp.VolumeProperties_s)(shape, found)
    return found


def xyz(point: Any) -> tuple[float, float, float]:
    """Return the coordinates of a point, a vector or a direction."""
    return point.X(), point.Y(), point.Z()
