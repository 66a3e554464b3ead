"""What stands in the report of the paper's cases."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

import cagepose
from cagepose.paper import comparison_table
from cagepose.paper.blocks import Block, Bullets, Heading, Paragraph, Table, picture
from cagepose.paper.case_blocks import case_blocks
from cagepose.paper.planar_table import planar_table
from cagepose.paper.printed import Row
from cagepose.paper.range_figure import range_figure
from cagepose.paper.range_study import RangeStudy
from cagepose.paper.reproduction import TIMED_RUNS, Progress, Reproduction

TITLE = "The paper, reproduced"


def report_blocks(reproduction: Reproduction, progress: Progress) -> Iterator[Block]:
    """Yield what the report is made of; pictures are drawn on the way."""
    methods, rows = reproduction.methods, reproduction.rows
    yield Heading(TITLE, 1)
    yield Paragraph(
        "R. Yokomura, Y. Liu and R. Fukui, Estimation of the Caged Object's Posture under Forces Using Stepwise"
        f" Geometric Calculations, run anew by cagepose {cagepose.__version__}. Every number that the paper prints"
        " stands below beside what the program finds and what geometry alone says. Nothing was tuned to agree: where"
        " numbers differ, the difference stays and the last column says why."
    )
    yield Paragraph(_summary(rows))
    yield Heading("Number by number")
    yield Table(
        "What the paper prints, and what comes out",
        comparison_table.headings(methods),
        [comparison_table.cells(row) for row in rows],
        kinds=[row.status for row in rows],
        n_wide=1,
    )
    yield Paragraph(
        "The stepwise method follows the paper's rules, with 0.1 rad as the angle of friction; the quasistatic one"
        " follows the balance of forces, here without friction. A dash: the method has no such thing. The difference is"
        " that of the stepwise value from the paper's, or of the closed form where there is none. A row agrees if both"
        " are the paper's number to its last digit, or lie above it where the paper gives an upper limit. Times are"
        f" those of the compiled run on this machine ({platform.machine()}, {platform.system()}, Python"
        f" {platform.python_version()}), each the median of {TIMED_RUNS} runs; the paper's were measured on another."
    )
    yield Heading("How exact it is")
    yield Table(
        "Each method less the closed form",
        ["quantity", *methods],
        [
            comparison_table.error_cells(row)
            for row in rows
            if row.status != "not derivable" and any(row.error(method) is not None for method in methods)
        ],
    )
    yield Paragraph(
        "What is left is rounding, but for three rows. The pitch after the push and its change are given as ZYX Euler"
        " angles, on which the yaw has an effect of some 1e-6 deg; the closed form is the angle in the rollers' own"
        " plane. And the closed form of the yaw holds for a level rail, the run ends with a tilted one."
    )
    yield from case_blocks(reproduction, progress)
    yield Heading("The planar theory")
    yield Paragraph(
        "Section IV of the paper treats the rail as a lever in a plane. A plate between rollers turns by t with"
        " (g/2) cos t - (l/2) sin t = e/2, where g is the roller gap, l the roller distance and e the plate's"
        " thickness; for small angles that is play over distance. The weight W turns the rail by M_G = W x about the"
        " centre of rotation, a push F at a pin's tip by T = -F (H cos θ - L sin θ) in pitch and"
        " M_F = -F (y cos φ - L sin φ) in yaw. Moments are right-handed, about y and about z. (Rq.1) asks that the push"
        " can turn the rail the right way, (Rq.2) that the play is enough for the rail to lie at zero."
    )
    yield planar_table()
    yield from _range_blocks(reproduction, progress)
    yield Heading("Where the paper's text cannot be meant as printed")
    yield Bullets(SLIPS)


SLIPS = (
    "The play's angle is given as ε/L = 0.626 deg with ε = 1 mm and L = 183 mm. That quotient is 0.313 deg; 0.626 deg"
    " is the range from one side to the other. The bound of 0.313 deg that follows is right.",
    "In yaw, (60.1 - 43.2 - 15.84) mm / 183 mm is 0.332 deg and its double 0.664 deg, not 0.320 and 0.640 deg.",
    "T and M_F are printed without the minus sign that makes them negative, as the text says they are.",
    "0.392 deg is called the sum of 0.1 and 0.313 deg, and a change of 0.560 deg consistent with 0.626 deg.",
    "The stability test's small turn is 0.01 deg, π/1800 rad (0.1 deg) and π/10000 rad (0.018 deg).",
    "Under Slp-2 the text has the object travel orthogonally to both normals, Algorithm 3 along the push; that would"
    " run into one of the faces.",
    "Algorithm 1 turns the ray by the collider's rotation instead of its inverse; in Algorithm 2 a component of C and"
    " the point that is turned are others than can be meant.",
    "The sample turns by 55 deg about one axis, beyond the 45 deg that assumption (E) allows.",
)


def _summary(rows: Sequence[Row]) -> str:
    counts = Counter(row.status for row in rows)
    return (
        f"Of {len(rows)} printed numbers and names, {counts['agrees']} agree to the paper's last digit,"
        f" {counts['differs']} differ, {counts['not derivable']} cannot be derived from the paper's text, as its"
        f" drawing of the rail is lost, and {counts['measured']} are times measured on this machine."
    )


def _range_blocks(reproduction: Reproduction, progress: Progress) -> Iterator[Block]:
    yield Heading("Which misalignments the push corrects")
    yield Paragraph(
        "The same rail with its rollers out of line by -0.5 to 0.5 deg in one angle, pushed at either pin. The theory's"
        " range is that in which zero is within reach of the play. But the push does not stop the rail there: it goes"
        " on to where a contact holds it. So within the range the rail can pass through zero, where its mate may catch"
        " it; it does not come to rest there. In pitch the weight lifts the pins and the push lowers them, whatever the"
        " misalignment. In yaw each pin turns the rail its own way, and the one that touches first (the left one, at"
        " y = +20 mm, for a positive yaw) turns it back, by the paper's rules half as far. Roll is left as it is. By"
        " the mechanics, without friction, a rail out of line in roll slides sideways under its weight until the side"
        " rollers hold it, so that its yaw is at an end of the play before the push begins."
    )
    for method, studies in reproduction.ranges.items():
        progress(f"{method}: picture of the range of misalignments")
        yield picture(
            f"{method}-range", range_figure(studies),
            f"Final pitch, yaw and roll of the rail against the misalignment of its rollers, {method}. Shaded: the"
            " planar theory's permitted range, 0.313 deg in pitch and 0.332 deg in yaw; it has none for roll. In pitch"
            " both pins give the same curve.",
            f"Nine panels ({method}): the rail's pitch, yaw and roll, each against the misalignment in pitch, yaw and"
            " roll, after the weight and after the push at either pin.",
        )  # fmt: skip
        yield Bullets([_range_text(study) for study in studies])


def _range_text(study: RangeStudy) -> str:
    ends = ", ".join(f"{count} {verdict}" for verdict, count in Counter(study.verdicts).items())
    return (
        f"{study.method}, {study.misaligned}, pin at y = {study.pin_y_m * 1000.0:+.0f} mm: the push takes the rail"
        f" through zero {_where(study, study.passes_zero())}, and leaves it nearer to zero than the weight had"
        f" {_where(study, study.improved())}. Ends: {ends}."
    )


def _where(study: RangeStudy, chosen: np.ndarray) -> str:
    if not chosen.any():
        return "at no misalignment"
    angles = np.degrees(study.misalignments_rad[chosen])
    return f"at {chosen.sum()} of {len(chosen)} misalignments ({angles[0]:+.3f} to {angles[-1]:+.3f} deg)"
