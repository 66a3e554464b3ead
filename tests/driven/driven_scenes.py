"""Scenes that drive bodies of the cage, which tests share."""

from __future__ import annotations

import math

from cagepose import Box, Cage, CageBody, Convex, Drive, Load, Object, Pose, Scene, Sphere, Spring

DOWN = (0.0, 0.0, -9.81)
RAMP = math.radians(20.0)


def wedge(*, friction: float = 0.2, wall_friction: float = 0.1, way_m: float = 0.02) -> Scene:
    """A ramp is driven under a block of one kilogram, which a wall holds back; it lifts it."""
    slope = math.tan(RAMP)

    def prism(corners: list[tuple[float, float]], width: float) -> list[tuple[float, float, float]]:
        return [(x, y, z) for x, z in corners for y in (-width / 2, width / 2)]

    foot = [(-0.02, 0.02 * slope), (0.02, -0.02 * slope), (0.02, 0.06), (-0.02, 0.06)]
    top = [(-0.08, 0.08 * slope), (0.08, -0.08 * slope), (0.08, -0.08), (-0.08, -0.08)]
    block = Object([], shapes=[Convex(prism(foot, 0.04), name="block")], mass_kg=1.0)
    ramp = CageBody("ramp", shapes=[Convex(prism(top, 0.1), name="top")])
    wall = Box((0.02, 0.1, 0.4), Pose((0.03, 0.0, 0.1)), "wall")
    load = Load("lift", gravity=DOWN, drive={"ramp": Drive((way_m, 0, 0))})
    cage = Cage(shapes=[wall], bodies=[ramp])
    return Scene(block, cage, [load], friction_coefficient=friction, friction_of={"wall": wall_friction}, name="wedge")


def jaws(*, angle_deg: float = 20.0, friction: float = 0.3, lift_m: float = 0.001) -> Scene:
    """Two jaws close on a block on a smooth shelf, which turns between them; then they rise beside it."""
    start = Pose((0.0, 0.0, 0.01), euler_zyx=(math.radians(angle_deg), 0.0, 0.0))
    block = Object([Box((0.02, 0.04, 0.02))], mass_kg=1.0, pose=start)
    shelf = Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "shelf")
    bodies = [
        CageBody(name, shapes=[Box((0.01, 0.1, 0.06), Pose((x, 0.0, 0.035)), f"{name} pad")])
        for name, x in (("left", -0.04), ("right", 0.04))
    ]
    close = Load("close", gravity=DOWN, drive={"left": Drive((0.03, 0, 0)), "right": Drive((-0.03, 0, 0))})
    lift = Load("lift", gravity=DOWN, drive={"left": Drive((0, 0, lift_m)), "right": Drive((0, 0, lift_m))})
    cage = Cage(shapes=[shelf], bodies=bodies)
    return Scene(block, cage, [close, lift], friction_coefficient=friction, friction_of={"shelf": 0.0}, name="jaws")


def truss() -> Scene:
    """A block in a straight guide between two springs is pushed through its middle, where it snaps."""
    block = Object([Box((0.02, 0.02, 0.02))], mass_kg=0.1, pose=Pose((0.0, 0.0, 0.03)))
    sides = ((0.02, 0.0, "x"), (-0.02, 0.0, "x"), (0.0, 0.02, "y"), (0.0, -0.02, "y"))
    sizes = {"x": (0.02, 0.04, 0.4), "y": (0.1, 0.02, 0.4)}
    guides = [Box(sizes[axis], Pose((x, y, 0.0)), f"guide {k}") for k, (x, y, axis) in enumerate(sides, start=1)]
    pusher = CageBody("pusher", shapes=[Sphere(0.002, Pose((0.0, 0.0, 0.043)), "tip")])
    springs = [Spring((0, 0, 0), (x, 0, 0), 2000.0, 0.0) for x in (-0.1, 0.1)]
    load = Load("push", springs=springs, drive={"pusher": Drive((0, 0, -0.05))})
    return Scene(block, Cage(shapes=guides, bodies=[pusher]), [load], friction_coefficient=0.0, name="truss")


def lever() -> Scene:
    """A lever turns by 30 deg against a block in a straight guide, which a spring pushes back, and then goes down."""
    block = Object([Box((0.02, 0.02, 0.02))], mass_kg=1.0, pose=Pose((0.05, 0.011, 0.01)))
    shelf = Box((1.0, 1.0, 0.02), Pose((0.0, 0.0, -0.01)), "shelf")
    guides = [Box((0.02, 0.4, 0.02), Pose((0.05 + x, 0.0, 0.01)), f"guide {x:+g}") for x in (-0.02, 0.02)]
    arm = CageBody("arm", shapes=[Sphere(0.004, Pose((0.05, -0.01, 0.01)), "knob")])
    legs = [Drive(about=(0, 0, 1), angle=math.radians(30.0)), Drive((0.0, 0.0, -0.001))]
    spring = Spring((0, 0, 0), (0.05, 0.2, 0.01), 500.0, 0.0)
    load = Load("turn", gravity=DOWN, springs=[spring], drive={"arm": legs})
    cage = Cage(shapes=[shelf, *guides], bodies=[arm])
    return Scene(block, cage, [load], friction_coefficient=0.0, name="lever")


def exact_wedge_force(friction: float, wall_friction: float) -> float:
    """Newtons that drive the ramp of `wedge`."""
    rise = math.tan(RAMP + math.atan(friction))
    return 9.81 * rise / (1.0 - wall_friction * rise)


ALL = {"wedge": wedge, "jaws": jaws, "truss": truss, "lever": lever}
"""By name, each as it stands."""
