"""How large a force beside the load may become before a rest gives way, and how it gives way: `tipping`.

The extra forces that contacts balance are convex, so there is a greatest one, (5.24), certain from below. Just above it
the kernel proves that no forces balance the load, (5.6), and says which motion begins. The contacts that open, slip and
stick are those of this motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cagepose.model.checks import FloatArray, expect
from cagepose.model.load import Force
from cagepose.questions.ends import not_in_contact, phase_asked
from cagepose.questions.no_motion import NoMotion, Tried
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.actions import Wrench, wrench_at
from cagepose.runs.cases import cases_of, with_wrench
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judge_case
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.methods import chosen_method
from cagepose.runs.proof import FreeMotion, Proof
from cagepose.runs.run import Contact, Run
from cagepose.studies.balances import Balances, balances_of

REFUTED_BY = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""By these parts of itself, one after the other, the greatest force is passed until a balance is ruled out."""
MOTION_ABOVE = 1e-4
"""By this part of itself the greatest force is passed where it is asked which motion begins. Nearer to it, rounding
turns the motion."""
STEPS = 16
"""So many forces up to the greatest one are tried at first, and as many that halve the rest."""
UNLIMITED_TRIED = 100.0
"""In loads. Up to this forces are tried where the contacts balance any."""
STEPS_OF_SHARES = 32
"""At so many forces, up to the greatest, it is looked whether a contact has lost its force."""
NEARLY_ALL = 1.0 - 1e-4
"""Of the greatest force. What loses its force later opens there."""
SHARE_WITHIN = 1e-6
"""To this part of the greatest force it is found when a contact loses its force."""
LEAST_FORCE = 1e-2
"""In loads. A lesser greatest force, as of what slides by itself, is passed as if it were as much."""
NO_SHARE = 1e-7
"""In loads. A contact with less carries nothing."""
SPEED_OF_NONE = 1e-6
"""In the greatest speed of a contact. One that opens or slips more slowly does not."""


@dataclass(frozen=True, eq=False)
class Loss:
    """How a rest gives way.

    Attributes
    ----------
    kind
        "lifts off": all contacts open; "tips": some; "slides": none, and some slip; "rolls": all stick.
    motion
        That begins just above the greatest force.
    opens, slips, sticks
        What the contacts do in it.
    """

    kind: Literal["lifts off", "tips", "slides", "rolls"]
    motion: FreeMotion
    opens: tuple[Contact, ...]
    slips: tuple[Contact, ...]
    sticks: tuple[Contact, ...]


@dataclass(frozen=True, eq=False)
class LiftOff:
    """A contact that loses its force, if all are equally stiff.

    Attributes
    ----------
    contact
        Which one.
    force_n
        The extra force from which on it carries nothing; as `Tipping.force_n`.
    """

    contact: Contact
    force_n: float


@dataclass(frozen=True, eq=False)
class Tipping:
    """How large an extra force may become.

    Attributes
    ----------
    phase
        Name of the phase at whose end it acts, beside the load.
    in_newtons
        Whether forces are newtons; else they are parts of the load.
    force_n
        Up to this one the contacts can balance it: certain. Infinite: however large it is.
    not_at_n
        A greater one at which it is ruled out that they can; infinite: none.
    loss
        How the rest gives way there; None: it does not.
    no_motion
        Ranges of the force in which no motion can begin, the lowest first.
    n_tried, up_to_n
        How many forces were tried for these, and the greatest.
    lifts_off
        The contacts that lose their force before that, the first one first, if all are equally stiff. They need not
        open: others may carry the load.
    """

    phase: str
    in_newtons: bool
    force_n: float
    not_at_n: float
    loss: Loss | None
    no_motion: tuple[NoMotion, ...]
    n_tried: int
    up_to_n: float
    lifts_off: tuple[LiftOff, ...]


def tipping(run: Run, force: Force, phase: str | None = None) -> Tipping | Unanswered:
    """Say how large a force may become that acts beside the load of a phase, where it has left the object.

    Parameters
    ----------
    run
        Of either method.
    force
        Its place and direction; its magnitude does not count.
    phase
        Name of the phase; None: the last.

    Raises
    ------
    SceneError
        The run has no such phase.
    """
    number = phase_asked(run, phase)
    expect(force, Force, "force")
    if reason := not_in_contact(run, number):
        return reason
    if run.scene.loads[number].press:
        return Unanswered("bodies press there, and it is asked for contacts that stand still alone")
    balances = balances_of(run, number)
    if balances is None:
        return Unanswered("no load lies on the contacts, or they carry it by forces of unlimited size alone")
    end = _End(run, number, force, balances)
    greatest = balances.size_n * balances.greatest_extra(end.extra)
    not_at, loss = end.loss_above(greatest)
    tried = Tried(end.prove, _first_tried(greatest, balances.size_n))
    return Tipping(
        run.phases[number].name,
        scaled_load(run.scene, run.scene.loads[number]).in_newtons,
        greatest,
        not_at,
        loss,
        tried.ranges(),
        len(tried.proofs),
        max(tried.proofs),
        tuple(end.lifts_off(greatest)),
    )


def _first_tried(greatest: float, load_n: float) -> set[float]:
    if math.isinf(greatest):
        return {0.0, *(UNLIMITED_TRIED * load_n * 0.5**halving for halving in range(STEPS))}
    steps = np.arange(1, STEPS + 1)
    return {0.0, *(greatest * steps / STEPS).tolist(), *(greatest * (1.0 - 0.5**steps)).tolist()}


class _End:
    """The end of a phase with an extra force, newtons or parts of the load."""

    def __init__(self, run: Run, phase: int, force: Force, balances: Balances) -> None:
        self._scene, self._phase, self._balances = run.scene, phase, balances
        self._pose, displaced = run.phases[phase].pose, displaced_after(run, phase)
        friction = chosen_method(run.scene, run.method).friction(run.scene)
        self._case = cases_of(run.scene, friction, self._pose, displaced)
        load = wrench_at(run.scene, phase, self._pose, displaced)
        direction = self._pose.rotation @ force.direction if force.follows else force.direction
        at_object = force.at_object(self._pose) - run.scene.object.center_of_gravity_m
        self._load = np.concatenate([load.force, load.moment])
        self._extra = np.concatenate([direction, np.cross(self._pose.rotation @ at_object, direction)])

    @property
    def extra(self) -> FloatArray:
        """The extra force of one, as the cones have it, (6,)."""
        return np.append(self._extra[:3], self._extra[3:] / self._balances.all_cones.length_m)

    def prove(self, force_n: float) -> Proof:
        """Return what the mechanics says of the pose with the extra force."""
        wrench = self._load + force_n * self._extra
        case = with_wrench(self._case, self._phase, Wrench(wrench[:3], wrench[3:]))
        return judge_case(self._scene, case, self._pose, self._phase)[0]

    def loss_above(self, greatest_n: float) -> tuple[float, Loss | None]:
        """Return a force at which no balance is left, and how the rest gives way there."""
        if math.isinf(greatest_n):
            return math.inf, None
        loss = self.prove(self._above(greatest_n, MOTION_ABOVE)).motion
        for part in REFUTED_BY:
            above = self._above(greatest_n, part)
            if self.prove(above).verdict == "moves":
                return above, None if loss is None else self._loss(loss)
        return math.inf, None

    def _above(self, greatest_n: float, part: float) -> float:
        return greatest_n + part * max(greatest_n, LEAST_FORCE * self._balances.size_n)

    def _loss(self, motion: FreeMotion) -> Loss:
        speeds = np.array([self._speed(motion, contact) for contact in self._balances.contacts])
        normals = np.array([contact.normal_world for contact in self._balances.contacts])
        opening = -np.einsum("ij,ij->i", speeds, normals)
        slip = np.linalg.norm(speeds + opening[:, None] * normals, axis=1)
        least = SPEED_OF_NONE * float(np.linalg.norm(speeds, axis=1).max())
        opens, slips = opening > least, slip > least
        stays = ~opens
        contacts = self._balances.contacts
        ways = [
            tuple(contacts[place] for place in np.flatnonzero(which))
            for which in (opens, stays & slips, stays & ~slips)
        ]
        if opens.any():
            return Loss("tips" if stays.any() else "lifts off", motion, *ways)
        return Loss("slides" if slips.any() else "rolls", motion, *ways)

    def _speed(self, motion: FreeMotion, contact: Contact) -> FloatArray:
        """Return how fast the object's material moves at a contact, (3,), at some speed of the motion."""
        if motion.direction_world is not None:
            return motion.direction_world
        assert motion.axis_world is not None
        assert motion.through_world is not None
        assert contact.place_world is not None
        arm = contact.place_world - motion.through_world
        return np.asarray(motion.pitch_m * motion.axis_world + np.cross(motion.axis_world, arm))

    def lifts_off(self, greatest_n: float) -> list[LiftOff]:
        """Return when contacts lose their force, if all are equally stiff."""
        if math.isinf(greatest_n) or greatest_n == 0.0:
            return []
        forces = (greatest_n * np.minimum(np.arange(STEPS_OF_SHARES + 1) / STEPS_OF_SHARES, NEARLY_ALL)).tolist()
        shares = [self._shares(force_n) for force_n in forces]
        found = []
        for place, contact in enumerate(self._balances.contacts):
            lost = next((step for step, share in enumerate(shares) if share[place] <= NO_SHARE), 0)
            if lost == 0:
                continue
            low, high = forces[lost - 1], forces[lost]
            while high - low > SHARE_WITHIN * greatest_n:
                middle = 0.5 * (low + high)
                if self._shares(middle)[place] <= NO_SHARE:
                    high = middle
                else:
                    low = middle
            found.append(LiftOff(contact, high))
        return sorted(found, key=lambda one: one.force_n)

    def _shares(self, force_n: float) -> FloatArray:
        return self._balances.shares_beside(force_n / self._balances.size_n * self.extra)
