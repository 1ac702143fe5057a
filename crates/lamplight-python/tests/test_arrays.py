"""Arrays in and out: casts, views, shapes, values out of range."""

import threading
from pathlib import PurePosixPath

import numpy as np
import pytest

import lamplight2d as ll


def test_views_share_memory_and_are_read_only():
    light = ll.Solver(bounces=0).solve(ll.Cells((5, 7), sky=[1, 1, 1]))
    assert light.rgb.shape == (5, 7, 3) and light.rgb.dtype == np.float32
    assert np.shares_memory(light.rgb, light.rgb)
    with pytest.raises(ValueError):
        light.rgb[0, 0, 0] = 2
    with pytest.raises(ValueError):
        light.rgb.setflags(write=True)
    view = light.rgb
    del light
    assert np.isfinite(view).all()


def misaligned(array):
    """An array at an odd address, as over bytes that came from elsewhere."""
    array = np.frombuffer(b"." + array.tobytes(), array.dtype, offset=1).reshape(array.shape)
    assert not array.flags.aligned
    return array


@pytest.mark.parametrize(
    "cast",
    [
        np.float64,
        np.asfortranarray,
        lambda a: np.repeat(a, 2, 1)[:, ::2],
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.astype(">f4"),
        misaligned,
    ],
)
def test_other_types_and_layouts_are_cast(cast):
    opacity = np.random.default_rng(1).random((6, 4), np.float32)
    cells = ll.Cells((6, 4), opacity=cast(opacity))
    np.testing.assert_array_equal(cells.opacity, opacity)


def test_row_0_is_the_top_row():
    opacity = np.zeros((20, 10))
    opacity[0] = True
    sky = {"zenith": [1, 1, 1], "horizon": [0, 0, 0], "ground": [0, 0, 0]}
    shut = ll.Solver(bounces=0).solve(ll.Cells((20, 10), opacity=opacity, sky=sky))
    open_ = ll.Solver(bounces=0).solve(ll.Cells((20, 10), opacity=opacity[::-1], sky=sky))
    assert shut.rgb[1:-1].mean() < 0.5 * open_.rgb[1:-1].mean()


@pytest.mark.parametrize(
    ("shape", "fields", "text"),
    [
        ((4, 6), {"emission": np.zeros((6, 4, 3))}, r"expected \[4, 6, 3\]"),
        ((4, 6), {"opacity": np.full((4, 6), np.nan)}, "opacity"),
        ((4, 6), {"opacity": np.full((4, 6), 2)}, "0 to 1"),
        ((4, 6), {"color": np.full((4, 6, 3), np.nan)}, "color is NaN"),
        ((4, 6), {"opacity": np.zeros((4, 6), complex)}, "opacity"),
        ((4, 6), {"sky": [float("nan")] * 3}, "NaN"),
        ((4, 6), {"emission": np.full((4, 6, 3), -1)}, "0 to 1e12"),
        ((4, 6), {"emission": np.full((4, 6, 3), np.inf)}, "0 to 1e12"),
        ((4, 6), {"masks": np.full((4, 6), 256, np.uint16)}, "masks"),
        ((4, 6), {"opacity": "opaque"}, "opacity"),
        ((4, 6), {"opacity": [[1], [1, 0]]}, "opacity"),
        ((4, 6, 3), {}, r"`shape` is \(4, 6, 3\), but must be two whole numbers, rows and columns"),
        ((4, 6.0), {}, r"`shape` is \(4, 6.0\), but must be two"),
        ("4x6", {}, "`shape` is '4x6', but must be two"),
        (4, {}, "`shape` is 4, but must be two"),
        (None, {}, "`shape` is None, but must be two"),
        ((4, 2**200), {}, "`shape` is .*, but must be two"),
        ((4, 6), {"lamps": [{"position": [1, 1], "colour": [1, 1, 1]}]}, "colour"),
        ((0, 6), {}, "0"),
        ((-1, 6), {}, "-1"),
        ((100_000, 100_000), {}, "100000"),
    ],
)
def test_bad_cells_are_refused(shape, fields, text):
    with pytest.raises(ValueError, match=text):
        ll.Cells(shape, **fields)


def test_a_number_that_is_not_finite_has_its_key():
    lamps = [{"position": [1, 1]}, {"position": np.array([1, np.inf])}]
    cells = ll.Cells((4, 6))
    for call, text in [
        (lambda: ll.Cells((4, 6), lamps=lamps), r"`lamp\[1\].position\[1\]` is inf, but must be finite"),
        (lambda: ll.Cells((4, 6), sky={"zenith": [0, np.nan, 0]}), r"`sky.zenith\[1\]` is NaN, but must be finite"),
        (lambda: ll.Solver(raymarch={"noise": "blue", "hit": -np.inf}), "`raymarch.hit` is -inf, but must be finite"),
        (lambda: ll.Solver().solve(cells).compose(cells, exposure=np.nan), "`display.exposure` is NaN"),
    ]:
        with pytest.raises(ValueError, match=text):
            call()
    lamps[1]["color"] = lamps
    lamps[1]["position"] = [1, 1]
    with pytest.raises(ValueError, match="[Cc]ircular"):
        ll.Cells((4, 6), lamps=lamps)


def test_numbers_of_other_kinds_are_refused():
    lamps = [{"position": [1, 1]}]
    for call, kind in [
        (lambda: ll.Cells((4, 6), lamps=[{"position": {1, 2}}]), "set"),
        (lambda: ll.Cells((4, 6), lamps=(lamp for lamp in lamps)), "generator"),
        (lambda: ll.Cells((4, 6), sky={"picture": PurePosixPath("stars.png")}), "PurePosixPath"),
    ]:
        with pytest.raises(TypeError, match=f"a {kind} is given; expected a number, text, a list, a dict or an array"):
            call()
    for call in [
        lambda: ll.Solver(threads=-1),
        lambda: ll.reference(ll.Cells((4, 6)), -1),
        lambda: ll.reference(ll.Cells((4, 6)), 2**40),
        lambda: ll.reference(ll.Cells((4, 6)), threads=0),
    ]:
        with pytest.raises(ValueError, match="must be 1 to"):
            call()


class Fails:
    """An array in a file, whose reading ends with an error."""

    shape = (4, 6, 3)

    def __init__(self, error):
        self.error = error

    def __array__(self, dtype=None, copy=None):
        raise self.error


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError("the disk is gone")])
def test_what_is_not_about_values_comes_out_as_it_is(error):
    kind = error if isinstance(error, type) else type(error)
    for call in [lambda: ll.Cells((4, 6), albedo=Fails(error)), lambda: ll.Light(Fails(error))]:
        with pytest.raises(kind):
            call()
    with pytest.raises(ValueError, match="albedo: of mud") as caught:
        ll.Cells((4, 6), albedo=Fails(TypeError("of mud")))
    assert isinstance(caught.value.__cause__, TypeError)


def test_arrays_of_no_shape_are_named():
    for name, call in [("rgb", ll.Light), ("points", ll.Light(np.zeros((1, 1, 3))).sample)]:
        with pytest.raises(ValueError, match=f"{name}: .*inhomogeneous"):
            call([[1], [1, 2]])


def test_an_unknown_field_is_refused():
    with pytest.raises(TypeError, match="opaque"):
        ll.Cells((4, 6), opaque=np.zeros((4, 6)))


def test_out_receives_the_light():
    cells = ll.Cells((9, 8), lamps=[{"position": [4, 4]}])
    solver = ll.Solver()
    expected = solver.solve(cells).rgb.copy()
    out = np.empty((9, 8, 3), np.float32)
    assert solver.solve(cells, out=out) is out
    np.testing.assert_array_equal(out, expected)


def test_an_out_that_is_written_is_refused_with_the_reason():
    # Large enough that the thread is still at work when it is asked.
    cells = ll.Cells((300, 300), albedo=np.full((300, 300, 3), 0.5), opacity=np.full((300, 300), 0.1), sky=[1, 1, 1])
    solver, out = ll.Solver(bounces=2, threads=1), np.zeros((300, 300, 3), np.float32)
    thread = threading.Thread(target=solver.solve, args=(cells,), kwargs={"out": out})
    thread.start()
    reason = "another thread solves into this array; wait for it, or use an array per thread"
    with pytest.raises(ValueError, match=f"glow: {reason}"):
        while thread.is_alive():
            ll.Cells((300, 300), glow=out)
    with pytest.raises(ValueError, match=f"out: {reason}"):
        solver.solve(cells, out=out)
    thread.join()
    assert ll.Cells((300, 300), glow=out)


@pytest.mark.parametrize(
    "out",
    [
        np.empty((8, 9, 3), np.float32),
        np.empty((9, 8, 3)),
        np.empty((9, 8, 3), np.float32, order="F"),
        np.broadcast_to(np.float32(0), (9, 8, 3)),
        np.empty((18, 8, 3), np.float32)[::2],
        np.frombuffer(bytearray(9 * 8 * 3 * 4 + 1), np.float32, offset=1).reshape(9, 8, 3),
        ll.Solver().solve(ll.Cells((9, 8))).rgb,
        "out",
    ],
)
def test_an_unsuitable_out_is_refused(out):
    with pytest.raises(ValueError, match="out"):
        ll.Solver().solve(ll.Cells((9, 8)), out=out)
