"""The rest of a contact mode, against exact statics in the plane: a peg on a compliance in its hole (Whitney 1982)."""

import math

import numpy as np
import pytest

from cagepose import Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.boundary.geometry import empty_cage, place_object
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.driven.rest_of_mode import RestWorkspace, rest_of_mode
from cagepose.kernels.outcome.cases import start_of
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import empty_quasistatic_workspace
from cagepose.runs.cases import cases_of, part_of
from driven.insertions import LENGTH, LG, MM, Insertion


def rest_near(scene, exact, nudge):
    """Return the tip, the lean and the forces where the kernels find the rest of the contacts that touch at a pose,
    from one beside it, (2,) and an angle.
    """
    lean, axis = exact.lean, np.array([math.sin(exact.lean), math.cos(exact.lean)])
    middle = exact.tip_mm + 0.5 * LENGTH * axis
    pose = Pose(np.array([middle[0], 0.0, middle[1]]) * MM, euler_zyx=(0.0, lean, 0.0))
    part, work = part_of(scene), empty_quasistatic_workspace(scene.geometry, 1)
    start = start_of(0, part, cases_of(scene, exact.friction, pose), empty_cage(scene.geometry))
    start = start._replace(actions=start_of(0, part, cases_of(scene, exact.friction), work.cage).actions)
    setting = Setting(start.geometry, part.body, start.actions[0], start.size_m, start.friction, 0.02, start.tolerances)
    contacts, frame = work.contacts, frame_at(part.body, start.quaternion)
    place_object(start.geometry, start.position, start.quaternion, work.placement)
    assert find_contacts(start.geometry, work.placement, start.friction, start.position, frame, contacts)
    memory = empty_record(RestWorkspace)
    for i in range(contacts.used[0]):
        row, state = contacts.rows[i], contacts.states[i]
        state.counts, state.is_sticking, state.forces[:] = True, False, (1.0, 0.0, 0.0)
        memory.slips[i] = -MM * row.directions[1:, 2]  # it came down by 1 mm
    beside = Pose(np.array([nudge[0], 0.0, nudge[1]]) * MM, euler_zyx=(0.0, nudge[2], 0.0)).as_tuples()
    turned = Pose((0, 0, 0), start.quaternion) @ Pose((0, 0, 0), beside[1])
    at = tuple(np.array(start.position) + beside[0])
    found, position, quaternion = rest_of_mode(setting, work.placement, contacts, at, turned.as_tuples()[1], memory)
    assert found
    end = Pose(np.array(position) + start.origin_world, quaternion)
    axis = end.rotation[[0, 2], 2]
    tip = end.position_m[[0, 2]] / MM - 0.5 * LENGTH * axis
    rows = [contacts.rows[i] for i in range(contacts.used[0])]
    heights = [float(row.arm[2] + position[2]) for row in rows]
    order = np.argsort(heights)[::-1]
    return tip, math.atan2(*axis), [float(contacts.states[int(i)].forces[0]) for i in order]


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.4])
@pytest.mark.parametrize(("n_points", "hole_radius", "aside", "lean"), [(1, 5.05, 0.4, 0.0), (2, 5.01, 0.3, 0.5)])
@pytest.mark.parametrize("depth", [4.0, 10.0, 30.0])
def test_a_peg_on_its_compliance_rests_as_in_the_plane(n_points, hole_radius, aside, lean, depth, friction):
    insertion = Insertion(hole_radius, aside, math.radians(lean), friction)
    scene, exact = insertion.scene(depth, [LG - depth - 1.0]), insertion.exact(n_points, LG - depth)
    assert min(exact.forces_n) > 0.0
    for nudge in ((0.0, 0.0, 0.0), (1e-3, -2e-3, 1e-5), (-2e-3, 5e-3, -2e-5)):
        tip, lean_found, forces = rest_near(scene, exact, nudge)
        np.testing.assert_allclose(tip, exact.tip_mm, atol=1e-9)
        assert lean_found == pytest.approx(exact.lean, abs=1e-11)
        np.testing.assert_allclose(forces, exact.forces_n, rtol=1e-8)
