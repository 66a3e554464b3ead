"""Several bodies in one memory, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.boundary.features import Bodies, Boundary


def joined(bodies: Sequence[Boundary], numbers: Sequence[NDArray[np.int64]]) -> Bodies:
    """Return bodies in one memory: indices of parts, features, bounds and covers are those of all of them.

    ``numbers`` has those of the parts of each body, (n_parts,), from 0 to one below how many there are in all: parts
    are in their order, all else body by body.
    """
    if len(bodies) == 1:
        return Bodies(bodies[0], np.array([0, len(bodies[0].nodes)]))
    rows: Any = [Boundary(*[np.array(rows) for rows in body]) for body in bodies]
    n_features, n_bounds, n_covers, n_listed = (
        np.cumsum([0, *(len(getattr(body, name)) for body in bodies)])
        for name in ("features", "bounds", "covers", "cover_list")
    )
    for number, body in enumerate(rows):
        body.parts["body"] = number
        body.parts["point"][body.parts["point"] >= 0] += n_features[number]
        body.features["part"] = numbers[number][body.features["part"]]
        for ends in ("first_bound", "last_bound"):
            body.features[ends] += n_bounds[number]
            body.covers[ends] += n_bounds[number]
        for ends in ("first_cover", "last_cover"):
            body.features[ends] += n_listed[number]
        for ends in ("first_opening", "last_opening"):
            body.covers[ends] += n_listed[number]
        body.cover_list[:] += n_covers[number]
        for ends in ("first", "last"):
            body.nodes[ends] += n_features[number]
    own: Any = Boundary(*[np.concatenate(every, axis=-1) for every in zip(*rows, strict=True)])
    own = own._replace(parts=np.asarray(own.parts)[np.argsort(np.concatenate(numbers))])
    records = (array.view(np.asarray(one).dtype) for array, one in zip(own, bodies[0], strict=True))
    return Bodies(Boundary(*records), np.cumsum([0, *(len(body.nodes) for body in bodies)]))
