"""From which friction on a part that is pushed jams along its way: `push_jam_friction`.

A push that grows without bound is the load that grows in (8.9), while all contacts stand still: it jams where forces
in the cones can take up the push alone. A weight beside it, which does not grow, makes no difference to that.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact.loads import FIXED_FORCE, FOLLOWING_FORCE
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.runs.actions import acting_pushes
from cagepose.runs.cases import cases_of, contact_friction, greatest_friction
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judge_case
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import PhaseRun, Run
from cagepose.studies.balances import choices_of
from cagepose.studies.contact_cones import contact_cones
from cagepose.studies.could_jam import JamQuestion, gives_way, least_of_choices

CANCELLED = 1e-12
"""Of the sum of the forces' sizes: forces that come to less together cancel each other."""


def push_jam_friction(run: Run, phase: int) -> tuple[list[Pose], FloatArray, NDArray[np.bool_]]:
    """Return the poses along the way of a phase, the least coefficient of friction with which the push could be held
    there however great it is, (n,); 0: with next to none; inf: none up to 10; nan: faces take turns at edges in more
    ways than is asked, or the forces cancel each other; and whether it is held without friction, (n,).

    It is the greatest coefficient of all contacts; the others keep their proportion to it. Contacts are those that
    touch at each pose; bodies of the cage stand where the phase has left them.

    Parameters
    ----------
    run, phase
        A phase, counted from 0, with forces.
    """
    scene, displaced = run.scene, displaced_after(run, phase)
    friction = chosen_method(scene, run.method).friction(scene)
    greatest, poses = greatest_friction(scene, friction), _poses(run.phases[phase])
    found, is_stopped = [], np.zeros(len(poses), bool)
    for place, pose in enumerate(poses):
        _, touching = judge_case(scene, cases_of(scene, friction, pose, displaced), pose, phase)
        contacts, choices = choices_of(touching)
        if choices is None:
            found.append(math.nan)
            continue
        center = pose.transform(scene.object.center_of_gravity_m)
        normals = np.array([contact.normal_world for contact in contacts]).reshape(-1, 3)
        places = np.array([contact.place_world for contact in contacts]).reshape(-1, 3)
        coefficients = [contact_friction(scene, friction, contact.point, contact.box) for contact in contacts]
        cones = contact_cones(normals, places - center, np.array(coefficients))
        push = _push(run, phase, pose)
        growth = np.append(push[:3], push[3:] / cones.length_m)
        size = float(np.linalg.norm(growth))
        if size <= CANCELLED * sum(one.magnitude_n or 1.0 for one in run.scene.loads[phase].pushes):
            found.append(math.nan)
            continue
        growth /= size
        questions = [
            JamQuestion(cones.columns[chosen], np.zeros((len(chosen), 3)), cones.friction[chosen], growth, 1.0)
            for chosen in map(list, choices)
            if chosen
        ]
        found.append(least_of_choices(questions, greatest))
        is_stopped[place] = found[-1] == 0.0 and not all(gives_way(question, 0.0) for question in questions)
    return poses, np.array(found), is_stopped


def _poses(phase: PhaseRun) -> list[Pose]:
    """Return where a phase began, and where each of its motions led, with the poses on the way where it is curved."""
    ends = [pose for event in phase.events for pose in (event.path or (event.pose_world_object,))]
    return list({pose.key: pose for pose in (phase.start_pose, *ends)}.values())


def _push(run: Run, phase: int, pose: Pose) -> FloatArray:
    """Return all forces of a phase and their moment about the centre of gravity, but for its weight, (6,)."""
    load, found = run.scene.loads[phase], np.zeros(6)
    center = run.scene.object.center_of_gravity_m
    for push in acting_pushes(load, scaled_load(run.scene, load).forces):
        force = pose.rotation @ push.vector if push.kind == FOLLOWING_FORCE else push.vector
        at_object = pose.inverse_transform(push.at_m) if push.kind == FIXED_FORCE else push.at_m
        found += np.concatenate([force, np.cross(pose.rotation @ (at_object - center), force)])
    return found
