"""The poses of a run as a table: `poses_csv`."""

from __future__ import annotations

import csv
import io

from cagepose.files.write import MADE_BY
from cagepose.model.pose import Pose
from cagepose.runs.run import Run

COLUMNS = ("phase", "verdict", "x_m", "y_m", "z_m", "quat_w", "quat_x", "quat_y", "quat_z")


def poses_csv(run: Run) -> str:
    """Return the object's pose in the world at the start and at the end of each phase: a row each, after a comment."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    stream.write(f"# {run.scene.name}: poses of the object's origin, metres and quaternions, {MADE_BY}\n")
    writer.writerow(COLUMNS)
    rows: list[tuple[str, str, Pose]] = [("", "start", run.phases[0].start_pose)]
    rows += [(phase.name, phase.verdict, phase.pose) for phase in run.phases]
    for name, verdict, pose in rows:
        numbers = [*pose.position_m.tolist(), *pose.quaternion_wxyz.tolist()]
        writer.writerow([name, verdict, *(repr(number) for number in numbers)])
    return stream.getvalue()
