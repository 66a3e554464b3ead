"""The one registry of methods: what each of them brings to a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from cagepose.errors import Problem, SceneError
from cagepose.kernels.driven import run as quasistatic_kernels
from cagepose.kernels.native.kernel import Entry
from cagepose.kernels.quasistatic.step import RULE_NAMES
from cagepose.kernels.stepwise import run as stepwise_kernels
from cagepose.model.checks import expect, expect_choice
from cagepose.model.load import Load
from cagepose.model.methods import DEFAULT_FRICTION, DEFAULT_METHOD, METHODS
from cagepose.model.scene import Scene
from cagepose.model.scope import other_shapes, unknown_shapes
from cagepose.runs.actions import is_one_force
from cagepose.runs.quasistatic import quasistatic_rules, quasistatic_warnings, quasistatic_workspace
from cagepose.runs.run import PhaseRun
from cagepose.runs.stepwise import stepwise_rules, stepwise_warnings, stepwise_workspace


@dataclass(frozen=True)
class Method:
    """What a method brings.

    Attributes
    ----------
    name
        As users write it.
    rule_names
        Of its rules, by code.
    joins_steps
        Whether steps of one kind are one event, with a path.
    takes_one_of_each
        Whether it runs only loads of a weight, or of what one force with a fixed direction is equal to, and one
        coefficient of friction.
    run, run_cases, repeat
        Kernels that run a scene once, many cases of it, and some steps of a run again.
    rules
        The method's numbers for a scene, of size 1.
    workspace
        What one run at a time writes to, for a scene and a greatest number of steps in a phase.
    warnings
        What a careful reader should know of a run: from the scene, the phases and the coefficient of friction.
    """

    name: str
    rule_names: tuple[str, ...]
    joins_steps: bool
    takes_one_of_each: bool
    run: Entry[None]
    run_cases: Entry[None]
    repeat: Entry[None]
    rules: Callable[[Scene], Any]
    workspace: Callable[[Scene, int], Any]
    warnings: Callable[[Scene, Sequence[PhaseRun], float], Iterator[str]]

    def __reduce__(self) -> tuple[Any, ...]:
        """A method is saved by its name, so that runs can go from process to process."""
        return _named, (self.name,)

    def friction(self, scene: Scene) -> float:
        """Return the coefficient of friction of a scene, or the method's default."""
        given = scene.friction_coefficient
        return DEFAULT_FRICTION[self.name] if given is None else given


REGISTRY = {
    "stepwise": Method(
        "stepwise",
        stepwise_kernels.RULE_NAMES,
        False,
        True,
        stepwise_kernels.run_stepwise,
        stepwise_kernels.run_stepwise_cases,
        stepwise_kernels.repeat_stepwise,
        stepwise_rules,
        stepwise_workspace,
        stepwise_warnings,
    ),
    "quasistatic": Method(
        "quasistatic",
        RULE_NAMES,
        True,
        False,
        quasistatic_kernels.run_quasistatic,
        quasistatic_kernels.run_quasistatic_cases,
        quasistatic_kernels.repeat_quasistatic,
        quasistatic_rules,
        quasistatic_workspace,
        quasistatic_warnings,
    ),
}
"""By name; the names themselves, and their defaults, are in `cagepose.model.methods`."""


def _named(name: str) -> Method:
    return REGISTRY[name]


def chosen_method(scene: Scene, method: str | None = None) -> Method:
    """Return the method that `cagepose.run` uses.

    Raises
    ------
    SceneError
        An unknown method, or one that does not run what acts in the scene, its friction or its shapes.
    """
    expect(scene, Scene, "scene")
    name = scene.method or DEFAULT_METHOD
    if method is not None:
        expect_choice(method, METHODS, "method")
        name = method
    chosen = REGISTRY[name]
    if scene.has_other_shapes:
        unknown = unknown_shapes(scene)
        if not unknown and chosen.takes_one_of_each:
            needs = f"the {name} method runs boxes held by points alone; use {DEFAULT_METHOD}"
            unknown = other_shapes(scene, needs)
        if unknown:
            raise SceneError(unknown)
    if chosen.takes_one_of_each:
        problems = [
            Problem(
                ("loads", index),
                f"{load.name!r} has {_beyond_one_force(load)}, which the {name} method does not run; use"
                f" {DEFAULT_METHOD}",
            )
            for index, load in enumerate(scene.loads)
            if not (load.drive or load.press) and not is_one_force(scene, load)
        ]
        problems += [
            Problem(
                ("loads", index, key),
                f"{load.name!r} {verb} a body, which only the {DEFAULT_METHOD} method does; use {DEFAULT_METHOD}",
            )
            for index, load in enumerate(scene.loads)
            for key, verb in (("drive", "drives"), ("press", "presses"))
            if getattr(load, key)
        ]
        if scene.planar is not None:
            message = f"the {name} method has all six freedoms; leave planar out, or use {DEFAULT_METHOD}"
            problems.append(Problem(("planar",), message))
        if scene.friction_of:
            message = f"the {name} method has one friction for all; use {DEFAULT_METHOD}"
            problems.append(Problem(("friction", "of"), message))
        if problems:
            raise SceneError(problems)
    return chosen


def _beyond_one_force(load: Load) -> str:
    """Say what of a load no force at one point stands for."""
    if load.springs:
        return "springs"
    if load.moments:
        return "moments"
    if any(push.follows for push in load.pushes):
        return "a force that follows the object"
    if not all(push.has_potential for push in load.pushes):
        return "a force at a point of the world"
    return "forces that do not come to one force at one point of the object"
