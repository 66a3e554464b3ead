"""The methods by name, and what holds where a scene leaves it open. What runs them is in `cagepose.runs.methods`."""

from __future__ import annotations

import math
from typing import Literal

METHODS = ("stepwise", "quasistatic")
DEFAULT_METHOD = "quasistatic"

Metric = Literal["release", "drag"]
DEFAULT_METRIC: Metric = "release"

NO_SLIP_ANGLE_DEFAULT_RAD = 0.1
"""The paper's threshold, from the friction of metal on metal."""
DEFAULT_FRICTION = {"stepwise": math.tan(NO_SLIP_ANGLE_DEFAULT_RAD), "quasistatic": 0.0}
"""Coefficient of friction, by method."""
