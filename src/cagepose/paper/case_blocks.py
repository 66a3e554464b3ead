"""The paper's cases in the report: what each method makes of the sample and of the rail."""

from __future__ import annotations

from collections.abc import Iterator

from cagepose.paper.blocks import Block, Heading, Paragraph, picture
from cagepose.paper.ends_table import ends_table
from cagepose.paper.paper_rows import CaseRuns
from cagepose.paper.reproduction import Progress, Reproduction
from cagepose.views.event_figure import event_figure
from cagepose.views.pose_figure import pose_figure

SAMPLE_TEXTS = {
    "stepwise": "By the paper's rules a contact stays where it is on the cage while the cube turns about it. The two"
    " turns are acos(7/8) and acos(5/8), and the cube stops where no turn about two contacts is free.",
    "quasistatic": "Without friction no contact holds the cube in place: it slides on C1 while it tips, and on C1 and"
    " C4 from where it meets C4. It ends at a pitch of -45 deg, the centre of gravity straight above the line through"
    " both. That is a balance of forces, but an unstable one: the least disturbance tips the cube over to one side.",
}
RAIL_TEXTS = {
    "stepwise": "By the paper's rules the rail slides on one face (Slp-1), then along two (Slp-2) to the stop, and"
    " turns about two contacts, until nothing is free. Bands in the pictures: Slp-1 and Slp-2.",
    "quasistatic": "By the mechanics, without friction, all contacts slide, and several of the paper's motions happen"
    " at once: most events of the push are screws, which tilt and yaw the rail together.",
}


def case_blocks(reproduction: Reproduction, progress: Progress) -> Iterator[Block]:
    """Yield text, table and pictures of the sample and of the rail; pictures are drawn on the way."""
    yield Heading("The sample")
    yield Paragraph("A cube of 10 mm over four points, under its weight.")
    for method, runs in reproduction.runs.items():
        yield from _sample_blocks(method, runs, progress)
    yield Heading("The rail")
    yield Paragraph(
        "The rail of a modular scaffold hangs by two guide plates between rollers, with 1 mm of play. It settles under"
        " its weight, then its mate pushes a pin's tip along x. The rollers are 0.1 deg out of line in one angle. The"
        " paper's drawing is lost to us: what it prints as numbers is kept, other dimensions are a reconstruction."
    )
    for method, runs in reproduction.runs.items():
        yield from _rail_blocks(method, runs, progress)
    yield Heading("Both methods side by side")
    yield ends_table(reproduction.runs)
    yield Paragraph(
        "Both methods swing the rail through the whole of its play in pitch. They part in yaw. The paper's rules end"
        " where the rail meets a first side roller, since no turn about two contacts is free there. The mechanics"
        " contradicts that rest: no contact forces balance the push at that pose, even with the friction that the"
        " paper assumes, and the rail yaws on to a second roller. Of the sample's pose it says the same, as a balance"
        " there needs more friction than 0.1."
    )


def _sample_blocks(method: str, runs: CaseRuns, progress: Progress) -> Iterator[Block]:
    yield Heading(f"The sample, {method}", 3)
    yield Paragraph(SAMPLE_TEXTS[method])
    progress(f"{method}: pictures of the sample")
    yield picture(
        f"{method}-sample-events", event_figure(runs.sample),
        f"The sample, event by event, {method} (the paper's Figs. 6 and 7). Last panel: from above, with the polygon of"
        " the contacts and the centre of gravity.",
        f"A cube and four points ({method}): a panel for the start, one after each motion, and one from above, which"
        " shows the polygon of the contacts and the centre of gravity.",
    )  # fmt: skip
    yield picture(
        f"{method}-sample-pose", pose_figure(runs.sample),
        f"The sample's pose against the step, ten steps to a turn, {method}.",
        f"Curves ({method}) of yaw, pitch and roll, of the way of the centre of gravity, and a chart of the contacts.",
    )  # fmt: skip


def _rail_blocks(method: str, runs: CaseRuns, progress: Progress) -> Iterator[Block]:
    yield Heading(f"The rail, {method}", 3)
    yield Paragraph(RAIL_TEXTS[method])
    progress(f"{method}: pictures of the rail's events")
    yield picture(
        f"{method}-rail-events", event_figure(runs.pitch),
        f"The rail, event by event, {method}, rollers out of line in pitch. The motions are too small to see at this"
        " scale, so look at the contacts. Last panel: under its weight the rail hangs over its rollers at x = 91.5 and"
        " is held down by those at the other end, so the centre of gravity lies outside the polygon.",
        f"A rail with two guides between rollers ({method}): a panel for the start, one after each motion, and one from"
        " above.",
    )  # fmt: skip
    for angle, figure, run in (("pitch", "Fig. 11", runs.pitch), ("yaw", "Fig. 13", runs.yaw), ("roll", "", runs.roll)):
        progress(f"{method}: picture of the rail out of line in {angle}")
        place = f"the paper's {figure}" if figure else "not shown in the paper"
        yield picture(
            f"{method}-rail-{angle}", pose_figure(run),
            f"The rail's pose against the step, {method}, rollers 0.1 deg out of line in {angle} ({place}). Dashed: the"
            " weight has done its work, the push begins.",
            f"Curves ({method}) of the rail's yaw, pitch and roll for a misalignment in {angle}, and a chart of the"
            " contacts.",
        )  # fmt: skip
