"""The rest of a contact mode, against exact statics in the plane: a peg on a compliance in its hole (Whitney 1982)."""

import math

import numpy as np
import pytest
from scipy.optimize import root

from cagepose import Box, Cage, Cylinder, Hole, Load, Object, Pose, Scene, Spring
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.boundary.geometry import empty_cage, place_object
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.driven.rest_of_mode import RestWorkspace, rest_of_mode
from cagepose.kernels.outcome.cases import start_of
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import empty_quasistatic_workspace
from cagepose.runs.cases import cases_of, part_of

MM = 1e-3
RADIUS, LENGTH, LG = 5.0, 60.0, 40.0
"""Of the peg, and how far above its tip the centre of the compliance is, mm."""
STIFFNESS, TURNING = 5.0, 2e4
"""Of the compliance: N/mm to the side and along, N mm/rad."""
HALF = math.sqrt(TURNING / STIFFNESS)
"""Its two springs are so far from its centre along the peg, mm."""


class Insertion:
    """A peg in a hole; its support is ``aside`` of it, turned by ``lean``, with its centre ``high`` above the mouth."""

    def __init__(self, hole_radius, aside, lean, friction, high):
        self.hole_radius, self.friction = hole_radius, friction
        self.center, self.along = np.array([aside, high]), np.array([math.sin(lean), math.cos(lean)])
        self.scene = self._scene()

    def anchors(self):
        return [self.center + sign * HALF * self.along for sign in (-1.0, 1.0)]

    def _scene(self):
        """The peg starts upright above the hole; the springs have no length of their own."""
        start = np.array([0.0, 2.0 + 0.5 * LENGTH])
        springs = []
        for sign, anchor in zip((-1.0, 1.0), self.anchors(), strict=True):
            at = np.array([0.0, LG - 0.5 * LENGTH + sign * HALF])
            pull = 0.5 * STIFFNESS * float(np.linalg.norm(anchor - start - at))
            ends = [np.array([x, 0.0, z]) * MM for x, z in (at, anchor)]
            springs.append(Spring(*ends, 0.5 * STIFFNESS / MM, pull))
        shapes, pose = [Cylinder(RADIUS * MM, LENGTH * MM, name="peg")], Pose(np.array([0.0, 0.0, start[1]]) * MM)
        peg = Object([], shapes=shapes, pose=pose)
        block = Box(np.array([60.0, 60.0, 50.0]) * MM, Pose((0.0, 0.0, -25.0 * MM)), "block")
        hole = Hole(self.hole_radius * MM, 45.0 * MM, in_=["block"], name="hole")
        load = Load("insert", springs=springs)
        return Scene(peg, Cage(shapes=[block, hole]), [load], friction_coefficient=self.friction)

    def exact(self, n_points, depth):
        """Return the tip (x, z), the lean and the forces of the points in balance, as it slides down: at the mouth, and
        at the tip. From a guess of the depth.
        """

        def frame(lean):
            return np.array([math.sin(lean), math.cos(lean)]), np.array([math.cos(lean), -math.sin(lean)])

        def missing(unknowns):
            x, z, lean, *normal = unknowns
            tip, (axis, side) = np.array([x, z]), frame(lean)
            force, moment, gaps = np.zeros(2), 0.0, []
            for sign, anchor in zip((-1.0, 1.0), self.anchors(), strict=True):
                at = tip + (LG + sign * HALF) * axis
                pull = 0.5 * STIFFNESS * (anchor - at)
                force, moment = force + pull, moment + at[0] * pull[1] - at[1] * pull[0]
            mouth = np.array([self.hole_radius, 0.0])
            gaps.append((mouth - tip) @ side - RADIUS)
            pushes = [(mouth, normal[0] * (-side + self.friction * axis))]
            if n_points == 2:  # the tip's edge on the wall across
                edge = tip - RADIUS * side
                gaps.append(edge[0] + self.hole_radius)
                pushes.append((edge, normal[1] * np.array([1.0, self.friction])))
            for place, push in pushes:
                force, moment = force + push, moment + place[0] * push[1] - place[1] * push[0]
            return [*force, moment, *gaps]

        guess = [self.hole_radius - RADIUS, -depth, 0.001, *[1.0] * n_points]
        for _ in range(3):
            guess = root(missing, guess, tol=1e-14).x
        return guess

    def rest(self, x, z, lean, nudge):
        """Return the tip, the lean and the forces where the kernels find the rest of the contacts that touch at a pose,
        from one beside it, (2,) and an angle.
        """
        axis = np.array([math.sin(lean), math.cos(lean)])
        middle = np.array([x, z]) + 0.5 * LENGTH * axis
        pose = Pose(np.array([middle[0], 0.0, middle[1]]) * MM, euler_zyx=(0.0, lean, 0.0))
        part, work = part_of(self.scene), empty_quasistatic_workspace(self.scene.geometry, 1)
        start = start_of(0, part, cases_of(self.scene, self.friction, pose), empty_cage(self.scene.geometry))
        start = start._replace(actions=start_of(0, part, cases_of(self.scene, self.friction), work.cage).actions)
        setting = Setting(
            start.geometry, part.body, start.actions[0], start.size_m, start.friction, 0.02, start.tolerances
        )
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
    insertion = Insertion(hole_radius, aside, math.radians(lean), friction, LG - depth)
    x, z, leaning, *normal = insertion.exact(n_points, depth)
    assert min(normal) > 0.0
    for nudge in ((0.0, 0.0, 0.0), (1e-3, -2e-3, 1e-5), (-2e-3, 5e-3, -2e-5)):
        tip, lean_found, forces = insertion.rest(x, z, leaning, nudge)
        np.testing.assert_allclose(tip, (x, z), atol=1e-9)
        assert lean_found == pytest.approx(leaning, abs=1e-11)
        np.testing.assert_allclose(forces, normal, rtol=1e-8)
