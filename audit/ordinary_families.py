"""Ordinary scenes as people draw them: round numbers, symmetry, exact fits, weight and a push along an axis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from audit.case import FloatArray
from audit.draws import MM, Rng
from cagepose import Box, Cage, Capsule, Cylinder, Force, Hole, Load, Object, Pose, Scene, Sphere
from cagepose.model.shapes import Shape

FRICTIONS = (0.0, 0.1, 0.3)
PLAYS = (0.0, 0.0, 0.05, 0.1, 0.5, 1.0)
ALONG_X, ALONG_Y = Pose(euler_zyx=(0, np.pi / 2, 0)), Pose(euler_zyx=(0, 0, np.pi / 2))


def ordinary(rng: Rng) -> Scene:
    """One of the kinds below."""
    kind = KINDS[int(rng.integers(len(KINDS)))]
    held, cage, reach = kind(rng)
    loads = [Load("weight", gravity=(0, 0, -9.81))]
    for name in ("push", "then")[: int(rng.integers(0, 3))]:
        loads.append(Load(name, gravity=(0, 0, -9.81), force=_push(rng, reach)))
    mu = float(rng.choice(FRICTIONS))
    return Scene(held, cage, loads, friction_coefficient=mu)


def _block_in_tray(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A block in a tray of one to four walls, dropped or laid."""
    size, play = _size(rng), float(rng.choice(PLAYS))
    low = size[:2] / 2 + play
    walls: list[Shape] = [_box((200, 200, 10), (0, 0, -5), "floor")]
    walls += [_box((10, 200, 30), (s * (low[0] + 5), 0, 15), f"wall x{s:+d}") for s in (-1, 1)]
    walls += [_box((200, 10, 30), (0, s * (low[1] + 5), 15), f"wall y{s:+d}") for s in (-1, 1)]
    held = Object([Box(size * MM, _at(0, 0, size[2] / 2), "block")], pose=_at(0, 0, rng.choice([0.0, 0.0, 1.0, 20.0])))
    return held, Cage(shapes=walls[: int(rng.integers(2, 6))]), size / 2


def _block_on_pins(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A block on three or four points, with points beside and above."""
    size, play = _size(rng), float(rng.choice(PLAYS))
    x, y = 0.4 * size[:2]
    below = [(-x, -y), (x, -y), (x, y), (-x, y)] if rng.random() < 0.5 else [(-x, -y), (x, -y), (0, y)]
    points = [(*at, -play) for at in below]
    points += [(s * (size[0] / 2 + play), t * y, size[2] / 2) for s in (-1, 1) for t in (-1, 1)]
    points += [(t * x, s * (size[1] / 2 + play), size[2] / 2) for s in (-1, 1) for t in (-1, 1)]
    if rng.random() < 0.5:
        points += [(*at, size[2] + play) for at in below]
    held = Object([Box(size * MM, _at(0, 0, size[2] / 2), "block")])
    return held, Cage(np.array(points) * MM), size / 2


def _shaft_in_bores(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A shaft through the bores of two plates, with a collar on one side."""
    radius, play = float(rng.choice([3.0, 5.0, 10.0])), float(rng.choice([0.01, 0.05, 0.1, 0.5]))
    length, at = 100.0, 30.0
    plates = [Box(np.array([10, 60, 60]) * MM, _at(x, 0, 0), name) for x, name in ((-at, "left"), (at, "right"))]
    bores = [
        Hole((radius + play) * MM, 10 * MM, None, (name,), Pose(np.array([x + 5, 0, 0]) * MM, ALONG_X.quaternion_wxyz))
        for x, name in ((-at, "left"), (at, "right"))
    ]
    shaft: list[Shape] = [Cylinder(radius * MM, length * MM, ALONG_X, "shaft")]
    if rng.random() < 0.7:
        collar = Pose(np.array([at + 5 + 2 + rng.choice([0.0, 1.0]), 0, 0]) * MM, ALONG_X.quaternion_wxyz)
        shaft.append(Cylinder((radius + 5) * MM, 4 * MM, collar, "collar"))
    return Object(shapes=shaft), Cage(shapes=plates, holes=bores), np.array([length / 2, radius, radius])


def _bar_in_vees(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A bar with flat or round ends in two V blocks, or in a V groove, with a stop."""
    radius = float(rng.choice([5.0, 8.0, 10.0]))
    cheeks: list[Shape] = []
    for x, long in [(-30.0, 10.0), (30.0, 10.0)] if rng.random() < 0.5 else [(0.0, 100.0)]:
        for side in (-1, 1):
            turned = Pose(euler_zyx=(0, 0, side * np.pi / 4))
            cheeks.append(
                Box(np.array([long, 40, 10]) * MM, _at(x, 0, 0) @ turned @ _at(0, side * 20, -5), f"v {side}{x}")
            )
    cheeks.append(_box((10, 60, 60), (50 + rng.choice([5.0, 6.0]), 0, 0), "stop"))
    part: Shape = Cylinder(radius * MM, 100 * MM, ALONG_X, "bar")
    if rng.random() < 0.3:
        part = Capsule(radius * MM, 90 * MM, ALONG_X, "bar")
    height = radius * np.sqrt(2) + rng.choice([0.0, 0.5, 2.0])
    return Object(shapes=[part], pose=_at(0, 0, height)), Cage(shapes=cheeks), np.array([50, radius, radius])


def _bracket(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """An L bracket on an edge: it sits on a block, or hangs over it."""
    long, thick = float(rng.choice([40.0, 60.0])), float(rng.choice([4.0, 10.0]))
    play = float(rng.choice(PLAYS))
    boxes = [
        Box(np.array([long, 30, thick]) * MM, _at(-long / 2, 0, thick / 2), "top"),
        Box(np.array([thick + play, 30, long]) * MM, _at((thick + play) / 2, 0, thick - long / 2), "side"),
    ]
    block: list[Shape] = [_box((80, 80, 80), (-40 - play, 0, -40), "block")]
    if rng.random() < 0.5:
        block.append(_box((20, 10, 40), (-20, 20 + play, 0), "cheek"))
        block.append(_box((20, 10, 40), (-20, -20 - play, 0), "other cheek"))
    held = Object(boxes, pose=_at(0, 0, rng.choice([0.0, 0.0, 1.0])))
    return held, Cage(shapes=block), np.array([long / 2, 15, long / 2])


def _stool(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A table with three or four legs, round or square, on a floor with blocks beside it."""
    half, tall = float(rng.choice([20.0, 30.0, 50.0])), float(rng.choice([20.0, 40.0]))
    spots = [(-1, -1), (1, -1), (1, 1), (-1, 1)] if rng.random() < 0.6 else [(-1, -1), (1, -1), (0, 1)]
    legs: list[Shape] = [Box(np.array([2 * half, 2 * half, 5]) * MM, _at(0, 0, tall + 2.5), "top")]
    is_round = rng.random() < 0.5
    for x, y in spots:
        at = _at(0.8 * half * x, 0.8 * half * y, tall / 2)
        name = f"leg {x} {y}"
        legs.append(Cylinder(3 * MM, tall * MM, at, name) if is_round else Box(np.array([5, 5, tall]) * MM, at, name))
    floor: list[Shape] = [_box((300, 300, 10), (0, 0, -5), "floor")]
    for number in range(int(rng.integers(0, 3))):
        floor.append(
            _box((20, 20, 20), (half + 10 + rng.choice([0.0, 5.0]), (number - 0.5) * 40, 10), f"stop {number}")
        )
    return Object(shapes=legs, pose=_at(0, 0, rng.choice([0.0, 2.0]))), Cage(shapes=floor), np.array([half, half, tall])


def _plug(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A plug of two round pins in a socket plate."""
    radius, play = float(rng.choice([2.0, 4.0])), float(rng.choice([0.02, 0.1, 0.3]))
    apart = float(rng.choice([10.0, 19.0]))
    pins: list[Shape] = [Box(np.array([40, 20, 10]) * MM, _at(0, 0, 5), "body")]
    pins += [Cylinder(radius * MM, 20 * MM, _at(s * apart / 2, 0, -10), f"pin {s}") for s in (-1, 1)]
    plate = Box(np.array([80, 80, 30]) * MM, _at(0, 0, -15), "plate")
    holes = [
        Hole((radius + play) * MM, 25 * MM, None, ("plate",), _at(s * apart / 2, 0, 0), f"hole {s}") for s in (-1, 1)
    ]
    held = Object(shapes=pins, pose=_at(0, 0, rng.choice([0.0, 1.0, 5.0])))
    return held, Cage(shapes=[plate], holes=holes), np.array([20, 10, 10])


def _gripped(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A part of any simple shape between two jaws over a ledge."""
    half, play = float(rng.choice([10.0, 15.0])), float(rng.choice(PLAYS))
    kind = int(rng.integers(3))
    part: Shape = Box(np.array([2 * half, 30, 20]) * MM, name="part")
    if kind == 1:
        part = Cylinder(half * MM, 40 * MM, ALONG_Y, "part")
    elif kind == 2:
        part = Sphere(half * MM, name="part")
    low = 10.0 if kind == 0 else half
    jaws: list[Shape] = [_box((10, 50, 40), (s * (half + 5 + play), 0, 0), f"jaw {s}") for s in (-1, 1)]
    jaws.append(_box((100, 20, 10), (0, 0, -low - 5 - rng.choice([0.0, 1.0])), "ledge"))
    jaws += [_box((40, 10, 40), (0, s * 30, 0), f"end {s}") for s in (-1, 1)][: int(rng.integers(0, 3))]
    return Object(shapes=[part]), Cage(shapes=jaws), np.array([half, 15, 10])


def _tongue(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A T slide in a T slot, with a stop."""
    play = float(rng.choice(PLAYS))
    boxes = [
        Box(np.array([40, 30, 6]) * MM, _at(0, 0, -3), "foot"),
        Box(np.array([40, 12, 20]) * MM, _at(0, 0, 10), "web"),
    ]
    slot: list[Shape] = [_box((120, 80, 10), (0, 0, -11 - play), "base")]
    for side in (-1, 1):
        slot.append(_box((120, 20, 6 + 2 * play), (0, side * (25 + play), -3), f"cheek {side}"))
        slot.append(_box((120, 28, 10), (0, side * (20 + play), 5 + play), f"lip {side}"))
    slot.append(_box((10, 60, 40), (25 + rng.choice([0.0, 5.0]), 0, 5), "stop"))
    return Object(boxes, mass_kg=0.5), Cage(shapes=slot[: int(rng.integers(5, 7))]), np.array([20, 15, 15])


def _on_slope(rng: Rng) -> tuple[Object, Cage, FloatArray]:
    """A block or a roller on a slope of round degrees, with a stop at its foot."""
    steep = np.radians(rng.choice([5.0, 10.0, 15.0, 20.0, 30.0, 45.0]))
    tilted = Pose(euler_zyx=(0, steep, 0))
    radius = float(rng.choice([5.0, 10.0]))
    part: Shape = (
        Box(np.array([30, 20, 20]) * MM, name="block") if rng.random() < 0.6 else Cylinder(10 * MM, 30 * MM, ALONG_Y)
    )
    ground: list[Shape] = [
        Box(np.array([200, 60, 10]) * MM, tilted @ _at(0, 0, -5), "slope"),
        Box(np.array([10, 60, 30]) * MM, tilted @ _at(40, 0, 15), "stop"),
    ]
    if rng.random() < 0.4:
        ground.append(Cylinder(radius * MM, 60 * MM, tilted @ _at(30, 0, radius) @ ALONG_Y, "bar"))
    held = Object(shapes=[part], pose=tilted @ _at(-20, 0, 10 + rng.choice([0.0, 0.0, 1.0])))
    return held, Cage(shapes=ground), np.array([15, 10, 10])


KINDS: tuple[Callable[[Rng], tuple[Object, Cage, FloatArray]], ...] = (
    _block_in_tray,
    _block_on_pins,
    _shaft_in_bores,
    _bar_in_vees,
    _bracket,
    _stool,
    _plug,
    _gripped,
    _tongue,
    _on_slope,
)


def _size(rng: Rng) -> FloatArray:
    return np.asarray(rng.choice([20.0, 30.0, 40.0, 60.0], 3), dtype=np.float64)


def _push(rng: Rng, reach_mm: FloatArray) -> Force:
    """Along an axis, a face's diagonal or at random, at a corner, a middle of an edge or a face."""
    along = rng.choice([-1.0, 0.0, 0.0, 1.0], 3)
    if not along.any():
        along[int(rng.integers(2))] = 1.0
    at = rng.choice([-1.0, 0.0, 0.5, 1.0], 3) * reach_mm
    return Force(along, at * MM, float(rng.choice([1.0, 5.0, 20.0])))


def _box(size: tuple[float, float, float], at: tuple[float, float, float], name: str) -> Box:
    return Box(np.array(size) * MM, _at(*at), name)


def _at(x: float, y: float, z: float) -> Pose:
    return Pose(np.array([x, y, z]) * MM)
