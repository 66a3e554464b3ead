"""Round parts and holes that meet facets of their own body, of which no method knows what they cover."""

from __future__ import annotations

from functools import lru_cache

from cagepose.errors import MissingExtraError
from cagepose.model.box import Box
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Disc, Shape
from cagepose.model.surface import shape_mesh

CHORDS = 128
"""Of a full circle, where it is asked how far what is round is from facets."""
NEAR = 1e-5
"""Of the sizes of both: what is nearer to facets may touch them."""


@lru_cache(maxsize=1024)  # each run asks
def meets_facets(part: Shape, others: tuple[Shape, ...]) -> str | None:
    """Return the name of facets that a part or a hole touches or overlaps, and may not; None: of none.

    Polyhedra may, as they are joined with them, and holes may be cut out of facets alone.
    """
    if isinstance(part, Disc | Facets) or (isinstance(part, Hole) and not part.in_):
        return None
    if isinstance(part, Box) or (isinstance(part, Convex) and part.radius_m == 0.0):
        return None
    opened = part.in_ if isinstance(part, Hole) else ()
    for other in others:
        if isinstance(other, Facets) and other.name not in opened and _is_near(part, other):
            return str(other.name)
    return None


def _is_near(part: Shape, other: Facets) -> bool:
    (low, high), (other_low, other_high) = part.limits_m(), other.limits_m()
    slack = NEAR * float((high - low).max() + (other_high - other_low).max())
    if (low > other_high + slack).any() or (other_low > high + slack).any():
        return False
    try:
        import manifold3d  # as in `model.union`
    except ImportError as error:
        raise MissingExtraError(
            "a mesh of facets beside round parts needs manifold3d, which is not installed; install the shapes extra:"
            " pip install 'cagepose[shapes]', or make one mesh of what is one"
        ) from error
    bodies = []
    for shape in (part, other):
        mesh = shape_mesh(shape, CHORDS)
        bodies.append(manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices_m - low, mesh.triangles.astype("uint64"))))
    return bool(bodies[0].min_gap(bodies[1], 2.0 * slack) <= slack)
