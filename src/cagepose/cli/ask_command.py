"""``cagepose ask``: one question about a scene, one answer with its certainty; each question is a command below it."""

from __future__ import annotations

from cyclopts import App

QUESTIONS = {
    "friction": (
        "cagepose.cli.ask_friction:ask_friction",
        "From which coefficient of friction on a part can stay, and from which no motion can begin.",
    ),
    "tipping": (
        "cagepose.cli.ask_tipping:ask_tipping",
        "How large a force at a place may become until the part tips, slides or lifts off.",
    ),
    "jam": (
        "cagepose.cli.ask_jam:ask_jam",
        "From which friction on a guided part jams, however hard it is driven or pushed.",
    ),
    "resting": (
        "cagepose.cli.ask_resting:ask_resting",
        "In which poses a part comes to rest, how firmly, and how often it ends in each.",
    ),
    "escape": (
        "cagepose.cli.ask_escape:ask_escape",
        "At most how much work against its load gets a part out of its cage, and by which way.",
    ),
    "gap": (
        "cagepose.cli.ask_gap:ask_gap",
        "Up to which value of a number of the scene the cage holds the part, and from which it gets out.",
    ),
}
"""Where the command of each question is, and what it asks."""

ask = App(name="ask", help_format="plaintext")
for _name, (_home, _summary) in QUESTIONS.items():
    ask.command(_home, name=_name, help=_summary)
