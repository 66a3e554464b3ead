"""Whatever stands in the place of an argument is refused where it is given, by the argument's name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pytest

import cagepose
from cagepose import (
    Box,
    Cage,
    CageBody,
    Capsule,
    Cone,
    Convex,
    Cylinder,
    Disc,
    Drive,
    Force,
    Hole,
    Load,
    Moment,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
    Spring,
    Tolerances,
)

BOX = Box((1, 1, 1))
HELD = Object([BOX], pose=Pose((0, 0, 2)))
CAGE = Cage([(0.3, 0.3, 0), (-0.3, 0.3, 0), (0, -0.3, 0)])
LOAD = Load("weight", gravity=(0, 0, -1))
SCENE = Scene(HELD, CAGE, [LOAD])
RUN = cagepose.run(SCENE)
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
NOWHERE = "/nowhere/at/all"
ANYTHING = ("file.yaml", 5, (1, 0), True, np.array([0.0, 0.0, 1.0]), {"a": 1}, float("nan"), object(), [["a"]], SCENE)
"""Each argument takes a few of these at most."""

Call = tuple[Callable[..., object], Mapping[str, object]]
CALLS: dict[str, Call] = {
    "Box": (Box, {"size_m": (1, 1, 1), "pose_object_box": None, "name": None}),
    "Sphere": (Sphere, {"radius_m": 1.0, "pose_body_shape": None, "name": None}),
    "Capsule": (Capsule, {"radius_m": 1.0, "length_m": 1.0}),
    "Cylinder": (Cylinder, {"radius_m": 1.0, "length_m": 1.0}),
    "Cone": (Cone, {"radius_bottom_m": 1.0, "radius_top_m": 0.5, "length_m": 1.0}),
    "Convex": (Convex, {"vertices_m": TETRAHEDRON, "radius_m": 0.0}),
    "Disc": (Disc, {"radius_m": 1.0}),
    "Hole": (Hole, {"radius_m": 1.0, "depth_m": 1.0, "chamfer": None, "in_": ()}),
    "Pose": (Pose, {"position_m": (0, 0, 0), "euler_zyx": (0, 0, 0)}),
    "Object": (Object, {"boxes": [BOX], "shapes": (), "holes": (), "pose": None, "mass_kg": None}),
    "Cage": (Cage, {"points": [(0, 0, 0)], "names": None, "pose": None, "shapes": (), "holes": (), "bodies": ()}),
    "CageBody": (
        CageBody,
        {"name": "x", "points": [(0, 0, 0)], "names": None, "pose": None, "shapes": (), "holes": ()},
    ),
    "Drive": (Drive, {"travel": (0, 0, 1), "about": (0, 0, 1), "through": (0, 0, 0), "angle": 1.0}),
    "Force": (Force, {"direction": (1, 0, 0), "at_m": (0, 0, 0), "magnitude_n": None}),
    "Moment": (Moment, {"direction": (1, 0, 0), "magnitude_nm": 1.0}),
    "Spring": (Spring, {"at_m": (1, 0, 0), "to_m": (0, 0, 0), "stiffness_n_per_m": 1.0, "preload_n": 0.0, "of": None}),
    "Load, driven": (partial(Load, "x"), {"drive": {"mate": Drive((1, 0, 0))}, "stop_at": 1.0}),
    "Load": (Load, {"name": "x", "gravity": (0, 0, -1), "force": None, "forces": (), "moments": (), "springs": ()}),
    "Scene": (
        Scene,
        {
            "object": HELD,
            "cage": CAGE,
            "loads": [LOAD],
            "name": "x",
            "friction_coefficient": None,
            "friction_of": None,
            "method": None,
            "metric": None,
            "tolerances": None,
            "adjustable": (),
        },
    ),
    "Tolerances": (Tolerances, {"touch": 1e-9, "grazing_band_rad": 0.01}),
    "run": (cagepose.run, {"scene": SCENE, "method": None}),
    "run_many": (cagepose.run_many, {"scenes": SCENE, "variation": None, "method": None, "threads": 1}),
    "play": (cagepose.play, {"scene": SCENE}),
    "compare": (cagepose.compare, {"scene": SCENE}),
    "margin": (cagepose.margin, {"run": RUN}),
    "certificate": (cagepose.certificate, {"run": RUN}),
    "check_certificate": (cagepose.check_certificate, {"certificate": cagepose.certificate(RUN), "run": RUN}),
    "with_critical_friction": (cagepose.with_critical_friction, {"run": RUN}),
    "save_run": (partial(cagepose.save_run, path=NOWHERE), {"run": RUN, "length_unit": "mm"}),
    "save_scene": (partial(cagepose.save_scene, path=NOWHERE), {"scene": SCENE, "length_unit": "mm"}),
}
TAKEN = {(call, "name"): ("file.yaml",) for call in ("Box", "Sphere", "Load", "Scene", "CageBody")} | {
    ("Hole", "in_"): ("file.yaml", ANYTHING[5]),  # a name; the keys of a mapping are names
    ("Cage", "names"): (ANYTHING[5],),
    ("CageBody", "names"): (ANYTHING[5],),
    ("Spring", "of"): ("file.yaml",),
    ("run_many", "scenes"): (SCENE,),
    **{(call, "scene"): (SCENE,) for call in ("run", "play", "compare", "save_scene")},
}
KEYS = {"grazing_band_rad": "grazing_band_deg"}
"""Keys of files, where they are called otherwise."""
THREE = ("size_m", "position_m", "euler_zyx", "direction", "at_m", "to_m", "gravity", "travel", "about", "through")
POSITIVE = ("radius_m", "length_m", "depth_m", "radius_bottom_m", "radius_top_m", "mass_kg", "magnitude_n")


def takes(call: str, argument: str, value: object) -> bool:
    if isinstance(value, np.ndarray):
        return argument in THREE and call != "Box"  # an edge length of 0
    if value == 5 and type(value) is int:
        numbers = (
            "magnitude_nm",
            "stiffness_n_per_m",
            "preload_n",
            "friction_coefficient",
            "angle",
            "stop_at",
            *POSITIVE,
        )
        return argument in numbers or (call, argument) == ("run_many", "threads")
    return any(value is taken for taken in TAKEN.get((call, argument), ()))


@pytest.mark.parametrize(("call", "argument"), [(call, name) for call, (_, given) in CALLS.items() for name in given])
def test_a_wrong_argument_is_a_scene_error_that_names_it(call: str, argument: str) -> None:
    function, given = CALLS[call]
    if not isinstance(function, partial):  # of which the file cannot be written
        function(**given)
    for value in ANYTHING:
        if takes(call, argument, value):
            continue
        with pytest.raises(SceneError) as caught:
            function(**{**given, argument: value})
        told = {str(key) for problem in caught.value.problems for key in problem.path}
        keys = {argument, argument.split("_")[0], argument.removesuffix("_m"), KEYS.get(argument, argument)}
        assert told & keys, (value, str(caught.value))


PUSH = (1, 0, 0)
MEANT = {
    "a place for a pose": (
        lambda: Box((1, 1, 1), (0, 0, 1)),
        "pose: is (0, 0, 1); give a cagepose.Pose: cagepose.Pose((0, 0, 1))",
    ),
    "an array for a pose": (
        lambda: Box((1, 1, 1), np.array([0, 0, 1])),
        "pose: is (0, 0, 1); give a cagepose.Pose: cagepose.Pose((0, 0, 1))",
    ),
    "a name for a pose": (
        lambda: Box((1, 1, 1), "lid"),
        "pose: is 'lid'; give a cagepose.Pose: name='lid' gives a name",
    ),
    "a direction for a force": (
        lambda: Load("push", force=PUSH),
        "force: is (1, 0, 0); give a cagepose.Force: cagepose.Force((1, 0, 0), at_m=(0, 0, 0))",
    ),
    "a direction for a name": (lambda: Load(PUSH), "name: is (1, 0, 0); give text, such as 'weight'"),
    "a file for a scene": (
        lambda: cagepose.run("file.yaml"),
        "scene: is 'file.yaml'; give a cagepose.Scene: cagepose.load_scene('file.yaml') reads one",
    ),
    "a scene for a run": (
        lambda: cagepose.margin(SCENE),
        "run: is of type Scene; give a cagepose.Run: cagepose.run(scene) makes one",
    ),
    "an axis for gravity": (lambda: Load("w", gravity="-z"), "gravity: is not made of numbers: '-z'; give 3 numbers"),
    "an unknown metric": (
        lambda: Scene(HELD, CAGE, [LOAD], metric="fast"),
        "metric: is 'fast'; use one of: release, drag",
    ),
}


@pytest.mark.parametrize(("call", "message"), MEANT.values(), ids=MEANT)
def test_the_message_says_what_was_meant(call: Callable[[], object], message: str) -> None:
    with pytest.raises(SceneError) as caught:
        call()
    assert str(caught.value) == message
