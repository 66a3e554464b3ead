"""The poses that reach the ends of the play, one panel for each end of each freedom."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.studies.play_result import Play, PlayEnd
from cagepose.views.scene_drawing import SceneDrawing
from cagepose.views.solids import outer_points
from cagepose.views.style import PAGE_WIDTH_IN, styled

COLUMNS, PANEL_IN, FLAT_PANEL_IN, TITLE_IN = 3, 2.3, 1.75, 0.55
SHOWN_MOTION = 0.12
"""Of the picture: motions that are smaller are drawn larger, up to about this."""


def extreme_figure(play: Play, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the object at both ends of each freedom, dotted where it starts, with the points that limit it marked.

    Small motions are drawn larger than they are; the picture says how many times.
    """
    ends = [
        (f"{word} {name}", name, end)
        for name, ends in play.freedoms.items()
        for word, end in (("least", ends.low), ("greatest", ends.high))
    ]
    times = _times(play.scene, [end for _, _, end in ends])
    poses = [_enlarged(play.scene, end.pose_world_object, times) for _, _, end in ends]
    start = play.scene.object.pose_world_object
    with styled():
        drawing = SceneDrawing(play.scene, [start, *(pose for pose in poses if pose is not None)], length_unit)
        rows = math.ceil(len(ends) / COLUMNS)
        height = rows * (FLAT_PANEL_IN if drawing.is_flat else PANEL_IN) + TITLE_IN
        figure = Figure(figsize=(PAGE_WIDTH_IN, height))
        top = 1.0 - TITLE_IN / height
        for place, ((title, name, end), pose) in enumerate(zip(ends, poses, strict=True)):
            row, column = divmod(place, COLUMNS)
            cell = (column / COLUMNS, top * (1.0 - (row + 1) / rows), 0.94 / COLUMNS, 0.86 * top / rows)
            panel = cast(Axes3D, figure.add_axes(cell, projection="3d"))
            touching = tuple(clearance.point for clearance in end.clearances)
            drawing.draw_pose(panel, pose or start, touching, f"{title}: {_amount(end, name, length_unit)}")
        notes = f"motions drawn {times:g} times as large" if times > 1.0 else "to scale"
        if scales := drawing.scales():
            notes += f"; not to one scale: {scales}"
        figure.text(
            0.5, 1.0 - 0.08 / height, f"{play.scene.name}: ends of the play", ha="center", va="top", fontsize=11
        )
        figure.text(0.5, 1.0 - 0.32 / height, notes, ha="center", va="top", fontsize=8.5)
    return figure


def _amount(end: PlayEnd, name: str, length_unit: LengthUnit) -> str:
    if end.reached is None:
        return "no end"
    word = "past " if end.exact is None else ""
    if name in ("x", "y", "z"):
        return f"{word}{float(from_metres(end.reached, length_unit)):.4g} {length_unit}"
    return f"{word}{math.degrees(end.reached):.4g} deg"


def _times(scene: Scene, ends: list[PlayEnd]) -> float:
    """Return 1, 2, 5, 10, ...: how many times larger the motions are drawn."""
    corners, start = outer_points(scene.object), scene.object.pose_world_object
    moves = [
        end.pose_world_object.transform(corners) - start.transform(corners) for end in ends if end.pose_world_object
    ]
    largest = max((float(np.linalg.norm(move, axis=1).max()) for move in moves), default=0.0)
    wanted = SHOWN_MOTION * scene.size_m / largest if largest > 0.0 else 1.0
    if wanted < 2.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= wanted)


def _enlarged(scene: Scene, pose: Pose | None, times: float) -> Pose | None:
    """Return the pose after a motion ``times`` as large: the travel of the start's centre, and the turn about it."""
    if pose is None or times == 1.0:
        return pose
    start = scene.object.pose_world_object
    turn = pose @ start.inverse()
    w, *xyz = turn.quaternion_wxyz.tolist()
    sine = math.hypot(*xyz)
    half = min(times * math.atan2(sine, w), 0.5 * math.pi)
    part = math.sin(half) / sine if sine > 0.0 else 0.0
    larger = Pose(quaternion_wxyz=[math.cos(half), *(part * np.array(xyz))]) @ Pose(
        quaternion_wxyz=start.quaternion_wxyz
    )
    center = scene.object.center_of_gravity_m
    place = start.transform(center) + times * (pose.transform(center) - start.transform(center))
    return Pose(place - larger.transform(center), larger.quaternion_wxyz)
