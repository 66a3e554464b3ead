"""Every entry of the library, with arguments of the types that it is called with."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import PassiveSet, empty_system
from cagepose.kernels.algebra.linear_program import Program, program_rows, solve_program
from cagepose.kernels.algebra.pose import write_euler_zyx, write_quaternions
from cagepose.kernels.algebra.program_bound import extents
from cagepose.kernels.algebra.record import dtype_of, empty_record, empty_rows
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.boundary.features import NO_BOUNDARY, Bodies, empty_placing
from cagepose.kernels.boundary.gaps import empty_gap_work, find_gaps
from cagepose.kernels.boundary.geometry import Geometry, empty_cage, empty_placement, overlap_at, place_object
from cagepose.kernels.boundary.overlap import empty_overlap_work
from cagepose.kernels.collision.boxes import BoxesAndPoints, empty_placed_boxes, place_boxes_at
from cagepose.kernels.contact.loads import Action
from cagepose.kernels.contact.metric import Body
from cagepose.kernels.driven.jam_proof import search_jam
from cagepose.kernels.driven.run import repeat_quasistatic, run_quasistatic, run_quasistatic_cases
from cagepose.kernels.driven.workspace import empty_drive_workspace
from cagepose.kernels.outcome.at_pose import critical_friction, find_touching, is_balanced_at_start, judge_start
from cagepose.kernels.outcome.cases import Cases, Part
from cagepose.kernels.outcome.drives import Drives, Leg, Press
from cagepose.kernels.outcome.endings import empty_endings
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.kernels.play.certificate import certify, empty_certificate_workspace
from cagepose.kernels.play.clearances import LimitingGap, find_limiting_gaps
from cagepose.kernels.play.escape import Station, grow_tree
from cagepose.kernels.play.extreme import Extreme, find_linear_play
from cagepose.kernels.play.goal import Goal
from cagepose.kernels.play.polytope import empty_play_workspace, write_start
from cagepose.kernels.play.search import find_play, find_play_from
from cagepose.kernels.quasistatic.run import QuasistaticRules
from cagepose.kernels.stability.proof import empty_proof_workspace
from cagepose.kernels.stability.proof_search import balance_with_faces, search_with_faces
from cagepose.kernels.stability.reach import empty_cone_rays, reach
from cagepose.kernels.stepwise.run import (
    StepwiseRules,
    empty_stepwise_workspace,
    repeat_stepwise,
    run_stepwise,
    run_stepwise_cases,
)
from cagepose.kernels.stepwise.slip import SlipRules
from cagepose.kernels.stepwise.support import SupportRules
from cagepose.kernels.union.arcs import Arc
from cagepose.kernels.union.candidates import find_pairs
from cagepose.kernels.union.cones import find_cones
from cagepose.kernels.union.corners import find_corners
from cagepose.kernels.union.fans import find_arcs
from cagepose.kernels.union.flat_regions import find_flat_regions
from cagepose.kernels.union.lines import empty_fan_work
from cagepose.kernels.union.loops import Border, Loop, find_loops
from cagepose.kernels.union.pieces import Piece, PieceEdge, PieceFace, Pieces, Plane, find_planes
from cagepose.kernels.union.vertices import find_groups, merge_places, settle_vertices

ORIGIN = (0.0, 0.0, 0.0)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def entries() -> Iterator[tuple[Any, tuple[object, ...]]]:
    """Yield each entry and its arguments; only their types count."""
    vectors, quaternions, numbers = np.zeros((1, 3)), np.zeros((1, 4)), np.zeros(1)
    none = NO_BOUNDARY
    bodies = Bodies(none, np.array([0, len(none.nodes)]))
    geometry = Geometry(none, bodies, empty_placing(none), 0.0)
    boxes = BoxesAndPoints(vectors, vectors, np.zeros((1, 3, 3)), 1, vectors)
    tolerances = kernel_tolerances(1.0, 1e-9)

    yield write_quaternions, (vectors, quaternions)
    yield write_euler_zyx, (quaternions, vectors)
    yield place_object, (geometry, ORIGIN, UPRIGHT, empty_placement(geometry))
    yield find_gaps, (geometry, ORIGIN, UPRIGHT, 0.0, True, empty_placement(geometry), empty_gap_work(1))
    yield place_boxes_at, (boxes, ORIGIN, UPRIGHT, empty_placed_boxes(boxes))

    part = Part(none, vectors, vectors, np.zeros((1, 3, 3)), 1, empty_record(Body), ORIGIN)
    actions = np.zeros((1, 1, 1), dtype_of(Action))
    points = np.zeros((1, 1, 3))
    presses = np.zeros((1, 1), dtype_of(Press))
    drives = Drives(np.zeros((1, 1, 1), dtype_of(Leg)), np.zeros((1, 1), np.int64), numbers, presses)
    cases = Cases(
        vectors,
        quaternions,
        points,
        bodies,
        np.zeros((1, 7)),
        drives,
        vectors,
        quaternions,
        numbers,
        numbers,
        numbers,
        numbers,
        actions,
        tolerances,
    )
    cage = empty_cage(geometry)
    outcome, endings = empty_outcome(geometry, 1, 1, 1), empty_endings(1, 1, 1)
    proof = empty_proof_workspace(geometry)
    yield overlap_at, (geometry, ORIGIN, UPRIGHT, empty_placement(geometry), empty_overlap_work(none, none))
    yield judge_start, (0, part, cases, cage, proof, outcome)
    yield critical_friction, (0, part, cases, cage, proof)
    yield balance_with_faces, (0.0, proof)
    yield search_with_faces, (0.0, proof)
    yield find_touching, (0, part, cases, cage, proof)
    yield is_balanced_at_start, (0, part, cases, cage, proof)
    yield search_jam, (0.0, numbers, numbers, proof)

    rules, work = QuasistaticRules(0.0, 1), empty_drive_workspace(geometry, 1, 1, 1, 1)
    yield run_quasistatic, (part, cases, rules, work, outcome)
    yield repeat_quasistatic, (0, outcome.steps, outcome.order[0], 1, part, cases, rules, work, outcome)
    yield run_quasistatic_cases, (0, 0, part, cases, 0.0, rules, work, endings)

    paper = StepwiseRules(SupportRules(0.0, 0.0, 0.0, 0.0), SlipRules(0.0, 0.0, 0.0, 0.0), 1)
    paper_work = empty_stepwise_workspace(geometry, boxes, 1)
    yield run_stepwise, (part, cases, paper, paper_work, outcome)
    yield repeat_stepwise, (0, outcome.steps, outcome.order[0], 1, part, cases, paper, paper_work, outcome)
    yield run_stepwise_cases, (0, 0, part, cases, 0.0, paper, paper_work, endings)

    program, (rows, bounds) = empty_record(Program), program_rows(1)
    yield solve_program, (rows, bounds, program)
    yield reach, (program, empty_cone_rays(np.zeros((1, 3, 6)), numbers, 1), 0.0)
    yield shortest_inside, (rows, bounds, empty_system(1), empty_record(PassiveSet), np.zeros(6))
    yield extents, (rows, bounds, program, np.zeros(6), np.zeros(6))
    play_work, goals, extremes = empty_play_workspace(boxes, np.zeros(6)), empty_rows(Goal, 1), empty_rows(Extreme, 1)
    yield write_start, (boxes, play_work)
    yield find_play, (boxes, goals, extremes, play_work)
    yield find_play_from, (boxes, goals, extremes, vectors, quaternions, play_work)
    yield find_limiting_gaps, (boxes, goals[0], extremes[0], empty_rows(LimitingGap, 1), play_work)
    yield find_linear_play, (goals, rows, bounds, program, extremes)
    yield certify, (boxes, 0.0, goals, numbers, play_work, empty_certificate_workspace(1))
    yield grow_tree, (boxes, vectors, empty_rows(Station, 1), 1, empty_placed_boxes(boxes), tolerances)

    indices, is_true = np.zeros(1, np.int64), np.zeros(1, np.bool_)
    pieces = Pieces(empty_rows(Piece, 1), vectors, empty_rows(PieceEdge, 1), empty_rows(PieceFace, 1), indices)
    planes, borders = empty_rows(Plane, 1), empty_rows(Border, 1)
    yield find_groups, (indices, 0.0, pieces, indices)
    yield find_planes, (indices, 0.0, 0.0, pieces, planes)
    yield settle_vertices, (0.0, pieces, planes)
    yield find_pairs, (0.0, pieces, planes, 1, indices)
    fan, arcs = empty_fan_work(1, 1), empty_rows(Arc, 1)
    yield find_arcs, (indices, indices, 1, ORIGIN, 0.0, 0.0, pieces, planes, is_true, fan, arcs)
    yield merge_places, (indices, numbers, numbers, vectors, indices)
    yield find_corners, (indices, indices, 0.0, pieces, planes, indices, indices, vectors, vectors, is_true)
    yield find_loops, (vectors, borders, empty_rows(Loop, 1))
    triples = np.zeros((1, 3), np.int64)
    of_triangles = (np.zeros((1, 3, 3)), vectors, is_true, indices, vectors, numbers)
    yield find_flat_regions, (indices, triples, *of_triangles, 0.0, indices, indices, indices)
    yield find_cones, (indices, vectors, np.zeros((2, 1, 3)), triples, is_true)
