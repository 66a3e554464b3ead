"""Which peers there are, where they live, and what to say where one is not installed."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

TIME_STEPPERS = {
    "mujoco": ("bench.engine_mujoco", "MujocoStepper", "MujocoSettings"),
    "drake": ("bench.engine_drake", "DrakeStepper", "DrakeSettings"),
    "pybullet": ("bench.engine_pybullet", "PybulletStepper", "PybulletSettings"),
}
"""Engine: (module, stepper, settings)."""


def load_time_stepper(engine: str) -> tuple[Callable[..., Any], Any]:
    """Return (the class that makes a `bench.settle.TimeStepper`, its tuned settings).

    Raises
    ------
    ImportError
        The engine is not installed, or does not load here.
    """
    module, stepper, settings = TIME_STEPPERS[engine]
    loaded = import_module(module)
    return getattr(loaded, stepper), getattr(loaded, settings)()
