"""How far a rest is from giving way: `margin`, what its contacts balance beside the load and how they may share it."""

from __future__ import annotations

from dataclasses import dataclass

from cagepose.model.checks import FloatArray, expect
from cagepose.model.wording import counted
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.run import Run
from cagepose.studies.balances import balances_of

FORCES, MOMENTS = slice(0, 3), slice(3, 6)
"""Places of the forces and of the moments of a wrench."""


@dataclass(frozen=True, eq=False)
class ContactMargin:
    """What one contact may carry; newtons, or parts of the load, as in `Contact`.

    Attributes
    ----------
    point, box, place_world
        Names, and where they touch, as in `Contact`.
    least_n, greatest_n
        Of its normal force, over all forces that balance the load; the greatest is infinite where contacts can press
        against each other without end, as in a wedge.
    equally_stiff_n
        Its normal force if all contacts are equally stiff, along the normal and across.
    equally_stiff_tangential_n
        Force across the normal on the object then, (3,), in the world.
    """

    point: str
    box: str
    place_world: FloatArray | None
    least_n: float
    greatest_n: float
    equally_stiff_n: float
    equally_stiff_tangential_n: FloatArray

    def __repr__(self) -> str:
        normal = f"{self.equally_stiff_n:.4g} ({self.least_n:.4g} to {self.greatest_n:.4g})"
        return f"<ContactMargin of {self.point!r} with {self.box!r}: {normal}>"


@dataclass(frozen=True, eq=False)
class Margin:
    """What the contacts of a rest can balance beside the load. That they can does not say that they must: see `Proof`.

    Attributes
    ----------
    in_newtons
        Whether forces are newtons and moments newton metres; else they are parts of the load, and moments times metres.
    force_n, moment_nm
        Whichever way an extra force at the centre of gravity (an extra moment) of less than this points, forces inside
        the friction cones balance it beside the load: certain. Infinite: however large it is.
    force_below_n, moment_below_nm
        One of this much is not balanced (to 1e-5 of it). At most a thousandth above the certain value (5.23).
    force_direction_world, moment_direction_world
        Which one, unit vectors (3,); zero where there is none.
    contacts
        In the order of the phase's contacts, without flush faces that say the same.
    """

    in_newtons: bool
    force_n: float
    force_below_n: float
    force_direction_world: FloatArray
    moment_nm: float
    moment_below_nm: float
    moment_direction_world: FloatArray
    contacts: tuple[ContactMargin, ...]

    def __repr__(self) -> str:
        units = ("N", "N m") if self.in_newtons else ("of the load", "m times the load")
        extra = f"force {self.force_n:.4g} {units[0]}, moment {self.moment_nm:.4g} {units[1]}"
        return f"<Margin: {extra}, {counted((len(self.contacts), 'contact', 'contacts'))}>"


def margin(run: Run, phase: int = -1) -> Margin | None:
    """Say how large an extra force and moment a phase's end still balances, and what each contact may carry.

    Bodies of the cage stand where they were driven to. Returns None where the phase did not end in a balance, or in one
    without contacts or without a load on them, as on springs; where contacts without play carry its load to second
    order, by forces without bound; where bodies press, of which `press_limits` tells; and where points on edges have
    more than 729 choices of faces.

    Parameters
    ----------
    run
        Of either method.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    IndexError
        The run has no such phase.
    """
    expect(run, Run, "run")
    number = range(len(run.phases))[phase]
    found = balances_of(run, number)
    if found is None:
        return None
    force, moment = found.least_extra_load(FORCES), found.least_extra_load(MOMENTS)
    size_n = found.size_n
    arm = size_n * found.cones.length_m
    return Margin(
        scaled_load(run.scene, run.scene.loads[number]).in_newtons,
        size_n * force.certain,
        size_n * force.found,
        force.direction,
        arm * moment.certain,
        arm * moment.found,
        moment.direction,
        tuple(
            ContactMargin(
                contact.point,
                contact.box,
                contact.place_world,
                size_n * least,
                size_n * greatest,
                float(size_n * share[0]),
                tangential,
            )
            for contact, (least, greatest), share, tangential in zip(
                found.contacts, found.ranges(), found.shares, size_n * found.tangential(), strict=True
            )
        ),
    )
