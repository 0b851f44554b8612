"""Shapes, dtypes, orders and strides of arrays that come in."""

import numpy as np
import pytest

import quatrack as q


def test_one_craft_and_many_have_the_shapes_that_they_were_given():
    assert q.State([0.0, 0.0, 1.0]).position.shape == (3,)
    many = q.State(np.zeros((5, 3)), velocity=[1.0, 2.0, 3.0])
    assert many.crafts == 5 and many.position.shape == (5, 3)
    # One row serves all.
    assert np.array_equal(many.velocity, np.tile([1.0, 2.0, 3.0], (5, 1)))
    assert np.array_equal(many.attitude, np.tile([1.0, 0.0, 0.0, 0.0], (5, 1)))
    assert q.Reference(np.zeros((5, 3)), heading=np.arange(5.0)).heading.shape == (5,)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(
    "order",
    [
        np.ascontiguousarray,
        np.asfortranarray,
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: np.flip(np.flip(a, axis=1).copy(), axis=1),
        lambda a: np.broadcast_to(a, a.shape),
    ],
)
def test_any_memory_order_reads_as_the_same_numbers(order, dtype):
    numbers = np.arange(12.0, dtype=dtype).reshape(4, 3)
    assert np.array_equal(q.State(order(numbers)).position, numbers)


@pytest.mark.parametrize("dtype", [int, np.int32, bool, complex, np.float16, object, ">f8"])
def test_other_dtypes_are_refused_by_name(dtype):
    with pytest.raises(TypeError, match=r"^position: dtype .*; give float64 or float32"):
        q.State(np.zeros(3).astype(dtype))


def test_lists_are_taken_and_words_are_not():
    assert np.array_equal(q.State([0, 0, 1]).position, [0.0, 0.0, 1.0])
    with pytest.raises(TypeError, match=r"^position: no array of numbers"):
        q.State("here")


@pytest.mark.parametrize("shape", [(), (4,), (2, 4), (1, 2, 3)])
def test_other_shapes_are_refused(shape):
    with pytest.raises(ValueError, match=r"^position: shape .*; give \(3,\) or \(N, 3\)"):
        q.State(np.zeros(shape))


def test_rows_that_do_not_match_are_refused():
    with pytest.raises(ValueError, match=r"^velocity: 3 rows, but position has 2"):
        q.State(np.zeros((2, 3)), velocity=np.zeros((3, 3)))


def test_returned_arrays_are_copies():
    state = q.State([0.0, 0.0, 1.0])
    state.position[2] = 5.0
    assert state.position[2] == 1.0
