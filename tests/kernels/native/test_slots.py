"""What Python hands to machine code: the kinds of arguments, and what is refused."""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
import pytest

from cagepose.kernels.algebra.linear_program import Program
from cagepose.kernels.algebra.pose import write_quaternions
from cagepose.kernels.algebra.record import dtype_of, empty_record, empty_rows
from cagepose.kernels.native.kernel import Entry, entry
from cagepose.kernels.native.library import kernel_library
from cagepose.kernels.native.slots import Slots

needs_machine_code = pytest.mark.skipif(kernel_library() is None, reason="plain Python takes what Python takes")


class Pair(NamedTuple):
    left: float
    right: object


ARRAY = np.zeros((2, 3))


@pytest.mark.parametrize(
    ("value", "kinds"),
    [
        (1.5, "d"),
        (np.float64(1.5), "d"),
        (7, "q"),
        (np.int32(7), "q"),
        (True, "?"),
        (np.bool_(False), "?"),
        (ARRAY, "[<f8,2]"),
        (ARRAY.astype(">f8"), "[>f8,2]"),
        (np.zeros(4, np.int64), "[<i8,1]"),
        (np.zeros((0, 3)), "[<f8,2]"),
        ((), ""),
        ((1.0, (2, Pair(3.0, ARRAY))), "dqd[<f8,2]"),
    ],
    ids=str,
)
def test_kinds_name_what_stands_in_the_slots(value, kinds):
    assert Slots(value).kinds == kinds


def test_a_record_is_its_address_and_counts_by_its_size():
    work, rows = empty_record(Program), empty_rows(Program, 3)
    size = dtype_of(Program).itemsize
    assert Slots(work).kinds == f"{{|V{size}}}"
    assert Slots(rows).kinds == f"[|V{size},1]"
    first, second = (struct.unpack("=q", Slots(rows[index]).packed)[0] for index in (0, 1))
    assert (first, second) == (rows.ctypes.data, rows.ctypes.data + size)


def test_an_array_is_its_address_and_shape():
    assert struct.unpack("=3q", Slots(ARRAY).packed) == (ARRAY.ctypes.data, 2, 3)


def test_numbers_stand_as_they_are():
    assert struct.unpack("=dqqd", Slots((1.5, -7, True, float("inf"))).packed) == (1.5, -7, 1, float("inf"))


@pytest.mark.parametrize(
    "in_pieces",
    [ARRAY.T, np.zeros((4, 3))[::2], np.zeros((3, 4))[:, :2], np.asfortranarray(np.ones((3, 3))), np.zeros(6)[::-1]],
    ids=["turned", "every second row", "some columns", "columns first", "backwards"],
)
@pytest.mark.parametrize(
    "wrapped", [lambda array: array, lambda array: (1.0, Pair(2.0, array))], ids=["alone", "within"]
)
def test_an_array_in_pieces_is_refused(in_pieces, wrapped):
    with pytest.raises(TypeError, match="a kernel takes arrays in one piece, rows first; copy this one"):
        Slots(wrapped(in_pieces))


@pytest.mark.parametrize(
    "foreign",
    [None, "text", b"bytes", [1.0], {"a": 1}, 1j, np.float32(1.0), np.complex128(1j), object, {1.0}],
    ids=repr,
)
def test_a_foreign_object_is_refused_by_its_type(foreign):
    with pytest.raises(TypeError, match=f"and no {type(foreign).__name__}$"):
        Slots((1.0, foreign))


ANGLES, QUATERNIONS = np.array([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]]), np.zeros((2, 4))


@needs_machine_code
@pytest.mark.parametrize(
    "wrong",
    [
        (),
        (ANGLES,),
        (ANGLES, QUATERNIONS, 1.0),
        (ANGLES, 1.0),
        (1.0, QUATERNIONS),
        (ANGLES.astype(np.float32), QUATERNIONS),
        (ANGLES.astype(">f8"), QUATERNIONS),
        (ANGLES.astype(np.int64), QUATERNIONS),
        (ANGLES[0], QUATERNIONS),
        (ANGLES[None], QUATERNIONS),
        ((ANGLES, 0), QUATERNIONS),
        (None, QUATERNIONS),
        (ANGLES.tolist(), QUATERNIONS),
        (ANGLES, QUATERNIONS.T),
    ],
    ids=range(14),
)
def test_an_entry_refuses_what_it_was_not_compiled_for(wrong):
    """Machine code would read and write wherever the slots say."""
    with pytest.raises(TypeError, match="kernel"):
        write_quaternions(*wrong)
    assert not QUATERNIONS.any()


@needs_machine_code
def test_a_refusal_names_the_kernel_and_both_kinds():
    with pytest.raises(
        TypeError, match=r"the kernel write_quaternions takes \[<f8,2\]\[<f8,2\], and was given d\[<f8,2\]"
    ):
        write_quaternions(1.0, QUATERNIONS)


def test_arguments_may_be_taken_apart_beforehand():
    prepared, made = np.zeros((2, 4)), np.zeros((2, 4))
    write_quaternions(ANGLES, made)
    write_quaternions(Slots(ANGLES), Slots(prepared))
    assert made.any()
    assert np.array_equal(prepared, made)


def test_prepared_slots_see_what_their_arrays_hold_later():
    angles, found, expected = ANGLES.copy(), np.zeros((2, 4)), np.zeros((2, 4))
    slots = Slots(angles), Slots(found)
    write_quaternions(*slots)
    angles[:] = ANGLES[::-1]
    write_quaternions(*slots)
    write_quaternions(ANGLES[::-1].copy(), expected)
    assert np.array_equal(found, expected)


def test_an_entry_without_a_library_is_plain_python():
    """As all are with ``CAGEPOSE_KERNELS=python``: it takes slots as well, and any Python object."""
    double = entry(lambda value: 2 * value)
    assert isinstance(double, Entry)
    double.library = None
    assert double(Slots(1.5)) == 3.0
    assert double("ab") == "abab"
