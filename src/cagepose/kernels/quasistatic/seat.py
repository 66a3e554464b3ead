"""A rest by friction right beside a balance that needs none ends in that balance.

A run with friction stops where its forces just suffice: some digits short of the pose where no friction is needed, if
there is one. Nothing holds it back there but the last of these digits, and a proof would hang on them.
"""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.curvature import write_curvature
from cagepose.kernels.contact.equilibrium import AT_REST, HELD_WITHOUT_FRICTION, equilibrium
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.loads import write_load
from cagepose.kernels.contact.metric import frame_at, twist_of, way_between
from cagepose.kernels.contact.sharing import share_evenly
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import NO_HIT, Twist
from cagepose.kernels.quasistatic.implicit_step import LEAST_RHO, hold_carrying, keep_along_held, shared_step
from cagepose.kernels.quasistatic.path import Path, step_to
from cagepose.kernels.quasistatic.projection import DEPENDENT
from cagepose.kernels.quasistatic.pushing_out import allow_depths
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

HARDLY_NEEDED = 1e-4
"""In lengths of the load's terms: what a balance beside one that needs no friction leaves without it."""
NEWTON_STEPS = 4
MOST_MOVED = 100.0
"""In touch tolerances: a balance that is farther away is another one."""


@kernel
def seated(
    setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace
) -> tuple[Vector, Quaternion]:
    """Return the pose of the balance without friction right beside a rest, or of the rest itself if there is none. The
    placement is that of the pose; the contacts are to be found anew.
    """
    contacts, stiff, solver = work.contacts, work.scratch[0].stiff, work.scratch[0].solver
    end, turned = position, quaternion
    for _ in range(NEWTON_STEPS):
        frame = frame_at(setting.body, turned)
        if not find_contacts(setting.geometry, work.placement, setting.friction, end, frame, contacts):
            break
        solver.load_terms = write_load(setting.load, end, turned, frame, solver.load)
        code = equilibrium(contacts, frame, 0.0, AT_REST, solver)
        if code == HELD_WITHOUT_FRICTION:
            return end, turned
        if solver.residual > HARDLY_NEEDED:
            break
        for i in range(contacts.used[0]):
            contacts.states[i].is_sticking = contacts.states[i].stays_flat = False
        hold_carrying(contacts, solver.locked, DEPENDENT, stiff)
        if not share_evenly(contacts, stiff.held, solver.cone.passive.residual, solver.load_terms, stiff.sharing):
            break
        write_curvature(contacts, setting.load, end, turned, frame, False, stiff.curvature)
        least_rho = keep_along_held(stiff)
        if not shared_step(contacts, max(least_rho, LEAST_RHO), stiff, solver):
            break
        velocity, spin = twist_of(stiff.delta, frame)
        allow_depths(setting.geometry, work.placement, setting.tolerances, work.path)
        done, end, turned = step_to(setting, Path(end, turned, Twist(velocity, spin, 1.0)), 1.0, NO_HIT, work)
        moved = way_between(position, quaternion, end, turned, setting.body.reach_m)
        if not done or moved > MOST_MOVED * setting.tolerances.touch_m:
            break
    place_object(setting.geometry, position, quaternion, work.placement)
    return position, quaternion
