"""`Jam` as lines."""

from __future__ import annotations

import math

from cagepose.files.words import LengthWords
from cagepose.model.wording import number_of, short
from cagepose.questions.jam import Jam
from cagepose.studies.tolerances import LEAST_JAM_FRICTION


def lines(answer: Jam, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    what = "driven" if answer.is_driven else "pushed"
    told = [("phase", f"{answer.phase}: {answer.verdict}")]
    where = " where it could be asked" if answer.n_open else ""
    if math.isinf(answer.friction):
        told.append(("jam", f"at no friction up to 10{where}, however hard it is {what}"))
    else:
        least = f"from {answer.friction:.5g} on" if answer.friction > 0.0 else "with any friction"
        if answer.has_several and answer.present > 0.0 and answer.friction > 0.0:
            least += f" (the greatest coefficient; {answer.friction / answer.present:.5g} times each)"
        below = f"; below it cannot{where}" if answer.friction > 0.0 else ""
        told.append(("jam", f"{least} it can jam, however hard it is {what}{below}"))
    if answer.pose_world_object is not None:
        share = "" if answer.share is None else f", after {short(100.0 * answer.share, 4, 1e-10)} % of the drive"
        told.append(("", f"first with the object at ({words.lengths(answer.pose_world_object.position_m)}){share}"))
    can = "can jam" if answer.present >= max(answer.friction, LEAST_JAM_FRICTION) else f"cannot jam{where}"
    told.append(("here", f"with {short(answer.present, 6, 1e-12)} it {can}"))
    asked = f"at {number_of(answer.n_asked, 'place')} of the way"
    stopped = f"; at {answer.n_stopped} of them contacts stop it without friction" if answer.n_stopped else ""
    is_open = f"; at {answer.n_open} of them it could not be asked" if answer.n_open else ""
    return [*told, ("asked", f"{asked}{stopped}{is_open}")]
