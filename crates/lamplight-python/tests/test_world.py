"""Worlds: every source has the same light, whatever is wrong comes out in words, and pickles carry the far field."""

import os
import pickle
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

import lamplight2d as ll

MAP = Path(__file__).parents[3] / "scenes/maps/tavern.tmx"
# Two parts, of which the second is narrow.
HEIGHT, WIDTH, TILE = 160, 1100, 256
SOLVER = ll.Solver(threads=1, bounces=1)
SETTINGS = {"solver": SOLVER, "halo": 16, "columns": 32}
SKY = [0.02, 0.03, 0.05]
LAMPS = [{"position": [90.5, 40.5]}, {"position": [1054.5, 100.5], "color": "#ff8844", "intensity": 40}]


def arrays():
    """Pillars of grey stone, and fog at the right."""
    opacity = np.zeros((HEIGHT, WIDTH), np.float32)
    opacity[:, 400:] = 0.01
    for top, left in np.random.default_rng(3).integers(0, [HEIGHT - 30, WIDTH - 30], (60, 2)):
        opacity[top : top + 20, left : left + 6] = 1
    return {"opacity": opacity, "albedo": np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)}


def whole():
    return ll.Cells((HEIGHT, WIDTH), **arrays(), lamps=LAMPS, sky=SKY)


def light(world):
    """The light of all tiles, put together."""
    found = np.empty((*world.shape, 3), np.float32)
    for y, x, height, width in world.tiles(TILE):
        found[y : y + height, x : x + width] = world.light(y, x, height, width).rgb
    return found


@pytest.fixture(scope="module")
def expected():
    return light(ll.World(whole(), **SETTINGS))


def sliced(fields):
    return {name: Sliced(array) for name, array in fields.items()}


class Sliced:
    """An array as those of files are: it has a shape and can be sliced, and that is all."""

    def __init__(self, array):
        self.shape, self._array = array.shape, array

    def __getitem__(self, window):
        rows, columns = window
        assert isinstance(rows, slice) and isinstance(columns, slice)
        # No part of the world is read as a whole, so that it may be larger than memory.
        assert rows.stop - rows.start < HEIGHT or columns.stop - columns.start < WIDTH
        return self._array[window]


def mapped(fields, folder):
    for name, array in fields.items():
        array.tofile(folder / name)
    return {name: np.memmap(folder / name, np.float32, "r", shape=array.shape) for name, array in fields.items()}


def test_tiles_have_nearly_the_light_of_the_whole():
    """The bound is that of the library's own test of an open world; tiles that are lit alone exceed twice of it."""
    truth = SOLVER.solve(whole())

    def error(found):
        return ll.compare(ll.Light(found), ll.Light(truth.rgb, solid=truth.solid)).relative_rmse

    world = ll.World(whole(), solver=SOLVER)
    bound = 0.015
    assert error(light(world)) < bound
    alone = np.empty((HEIGHT, WIDTH, 3), np.float32)
    for y, x, height, width in world.tiles(TILE):
        alone[y : y + height, x : x + width] = SOLVER.solve(whole().window(y, x, height, width)).rgb
    assert error(alone) > 2 * bound


def test_every_source_has_the_same_light(expected, tmp_path):
    options = {**SETTINGS, "lamps": LAMPS, "sky": SKY}
    for fields in [arrays(), sliced(arrays()), mapped(arrays(), tmp_path)]:
        np.testing.assert_array_equal(light(ll.World(fields, **options)), expected)
    cells = whole()
    world = ll.World(lambda *window: cells.window(*window), shape=cells.shape, sky=SKY, **SETTINGS)
    np.testing.assert_array_equal(light(world), expected)
    darker = {**arrays(), "albedo": np.zeros((HEIGHT, WIDTH, 3))}
    assert not np.array_equal(light(ll.World(darker, **options)), expected)


def test_an_array_of_zarr_has_the_same_light(expected, tmp_path):
    zarr = pytest.importorskip("zarr")
    group = zarr.open_group(tmp_path / "world.zarr", mode="w")
    for name, array in arrays().items():
        group.create_array(name, data=array, chunks=(128, 128, *array.shape[2:]))
    world = ll.World({name: group[name] for name in arrays()}, lamps=LAMPS, sky=SKY, **SETTINGS)
    np.testing.assert_array_equal(light(pickle.loads(pickle.dumps(world))), expected)


def test_a_scene_is_a_world(tmp_path):
    """Also one that is too large for a grid."""
    text = """
        size = [{}, 300]
        sky = [0.1, 0.1, 0.2]
        [light]
        bounces = 0
        [[shape]]
        rect = {{ min = [200, 100], max = [240, 200] }}
        opacity = 1
        [[lamp]]
        position = [150.5, 150.5]
    """
    (tmp_path / "small.toml").write_text(text.format(600))
    scene = ll.Scene.load(tmp_path / "small.toml")
    by_path, by_scene, by_cells = (
        ll.World(source, solver=solver, halo=16, columns=32)
        for source, solver in [
            (tmp_path / "small.toml", None),
            (scene, ll.Solver(bounces=0)),
            (scene.cells(), ll.Solver(bounces=0)),
        ]
    )
    np.testing.assert_array_equal(light(by_path), light(by_scene))
    np.testing.assert_array_equal(light(by_path), light(by_cells))
    (tmp_path / "large.toml").write_text(text.format(60000))
    scene = ll.Scene.load(tmp_path / "large.toml")
    assert scene.shape == (300, 60000) and scene.window(100, 199, 1, 2).opacity.tolist() == [[0, 1]]
    with pytest.raises(ValueError, match="60000"):
        scene.cells()
    with pytest.raises(ValueError, match="60000×300"):
        scene.window(0, 59990, 10, 20)


def test_a_window_of_cells_has_its_matter_and_the_lamps_that_reach_it():
    window = whole().window(0, 1040, 100, 60)
    np.testing.assert_array_equal(window.opacity, arrays()["opacity"][:100, 1040:])
    assert [lamp["position"] for lamp in window.lamps] == [[14.5, 100.5]]
    assert window.sky == whole().sky
    with pytest.raises(ValueError, match="window"):
        whole().window(0, 1040, 100, 61)


def test_tiles_pass_into_each_other(expected):
    world = ll.World(whole(), **SETTINGS)
    tiles = list(world.light_tiles(TILE))
    assert [window for window, _ in tiles] == world.tiles(TILE)
    found = np.empty_like(expected)
    for (y, x, height, width), tile in tiles:
        found[y : y + height, x : x + width] = tile.rgb
    # Half of the margin to both sides of a border, and nowhere else.
    rim = SETTINGS["halo"] // 2
    columns = np.arange(WIDTH)
    mixed = [(border - rim <= columns) & (columns < border + rim) for border in range(TILE, WIDTH, TILE)]
    others = ~np.any(mixed, axis=0)
    np.testing.assert_array_equal(found[:, others], expected[:, others])
    assert not np.array_equal(found, expected)
    # The jump at a border that light has without that.
    border = np.s_[:, TILE - 1 : TILE + 1]
    jump = [np.abs(np.diff(light[border], axis=1)).mean() for light in (expected, found)]
    assert jump[1] < jump[0]
    with pytest.raises(ValueError, match="side"):
        next(world.light_tiles(0))


def test_a_pickle_has_the_far_field(expected):
    asked = []

    def source(*window):
        asked.append(window)
        return whole().window(*window)

    global _read
    _read = source
    world = ll.World(read, shape=(HEIGHT, WIDTH), sky=SKY, **SETTINGS)
    # Two parts are read, and then lit for their bounce.
    assert len(asked) == 4
    again = pickle.loads(pickle.dumps(world))
    np.testing.assert_array_equal(light(again), expected)
    # The parts have not been read again.
    assert len(asked) == 4 + len(world.tiles(TILE))


def read(*window):
    return _read(*window)


class OwnError(Exception):
    pass


def test_errors_of_the_source_come_out():
    def fails(*window):
        raise OwnError(window)

    with pytest.raises(OwnError, match=r"\(0, 0, 160, 1025\)"):
        ll.World(fails, shape=(HEIGHT, WIDTH))
    with pytest.raises(TypeError, match="ndarray; expected Cells"):
        ll.World(lambda *window: np.zeros(3), shape=(HEIGHT, WIDTH))
    with pytest.raises(ValueError, match="1025×160"):
        ll.World(lambda *window: ll.Cells((5, 7)), shape=(HEIGHT, WIDTH))
    ready = False

    def fails_later(*window):
        if ready:
            raise OwnError
        return whole().window(*window)

    world = ll.World(fails_later, shape=(HEIGHT, WIDTH), **SETTINGS)
    ready = True
    with pytest.raises(OwnError):
        world.light(0, 0, 10, 10)


@pytest.mark.parametrize(("field", "value"), [("opacity", np.nan), ("albedo", 2), ("masks", 0)])
def test_a_bad_cell_has_its_place_in_the_world(field, value):
    """Also one in a part that is read from its own first cell on."""
    x, y = 1090, 150
    fields = {**arrays(), "masks": np.ones((HEIGHT, WIDTH), np.uint8)}
    fields[field][y, x] = value
    with pytest.raises(ValueError, match=rf"cell \({x}, {y}\): {field.rstrip('s')} "):
        ll.World(fields, **SETTINGS)


@pytest.mark.parametrize(
    ("source", "options", "text"),
    [
        ({}, {}, "no array"),
        ({"opaque": np.zeros((4, 6))}, {}, "opaque is not a field; expected some of emission"),
        ({"opacity": np.zeros((4, 6, 3))}, {}, r"opacity has the shape \(4, 6, 3\); expected \(H, W\)"),
        ({"emission": np.zeros((4, 6))}, {}, r"expected \(H, W, 3\)"),
        ({"opacity": np.zeros((4, 6)), "albedo": np.zeros((6, 4, 3))}, {}, r"expected \(4, 6\) cells, as opacity has"),
        ({"opacity": np.full((4, 6), 2)}, {}, "0 to 1"),
        ({"opacity": np.zeros((0, 6))}, {}, "size"),
        ({"opacity": np.broadcast_to(0, (65537, 2))}, {}, "65536"),
        ({"opacity": np.zeros((4, 6))}, {"halo": -1}, "halo"),
        ({"opacity": np.zeros((4, 6))}, {"columns": 0}, "columns.* 1 to 8192"),
        ({"opacity": np.zeros((4, 6))}, {"shape": (4, 6)}, "shape is given"),
        ({"opacity": np.zeros((4, 6))}, {"solver": ll.Solver(method="polar")}, "polar"),
        ({"opacity": np.zeros((4, 6))}, {"lamps": [{"position": [1, 1], "colour": [1, 1, 1]}]}, "colour"),
        ({"opacity": np.zeros((4, 6))}, {"lamps": [{"position": [1, 1], "direct": "exact"}]}, "shadow map"),
        (lambda *window: ll.Cells(window[2:]), {}, "shape is missing"),
        (lambda *window: ll.Cells(window[2:]), {"shape": (4, -6)}, r"`shape` is \(4, -6\), but must be two"),
        (lambda *window: ll.Cells(window[2:]), {"shape": (4, 6, 3)}, "but must be two whole numbers, rows and columns"),
        (lambda *window: ll.Cells(window[2:]), {"shape": 4}, "`shape` is 4, but must be two"),
        (lambda *window: ll.Cells(window[2:]), {"shape": (4, 6), "lamps": []}, "lamps is given"),
        (ll.Cells((4, 6)), {"sky": [1, 1, 1]}, "sky is given"),
        ("missing.toml", {}, "missing.toml"),
    ],
)
def test_bad_worlds_are_refused(source, options, text):
    with pytest.raises(ValueError, match=text):
        ll.World(source, **options)


def test_other_sources_are_refused():
    with pytest.raises(TypeError, match="int; expected a Scene"):
        ll.World(5)
    with pytest.raises(TypeError, match="list; expected an array"):
        ll.World({"opacity": [[0, 1]]})
    world = ll.World({"opacity": np.zeros((4, 6))})
    for window in [(0, 0, 5, 6), (0, 0, 0, 6), (-1, 0, 2, 2), (0, 0, 4, 2**40), (10**6, 0, 1, 1)]:
        with pytest.raises(ValueError, match="window|width|y"):
            world.light(*window)
    for side in (0, -1):
        with pytest.raises(ValueError, match=f"side.* {side}"):
            world.tiles(side)


def test_a_tile_that_is_no_grid_is_refused_before_its_cells_are_read():
    asked = []

    def source(y, x, height, width):
        asked.append((height, width))
        return ll.Cells((height, width))

    world = ll.World(source, shape=(4100, 4100), solver=ll.Solver(bounces=0), columns=8)
    asked.clear()
    for call in [lambda: world.light(0, 0, 4090, 4090), lambda: next(world.light_tiles(4099))]:
        with pytest.raises(ValueError, match="a tile of .* cells with its halo: a grid of 4100×4100 cells is refused"):
            call()
    assert asked == []
    # Bounces light the parts as tiles.
    for bounces in [1, "converged"]:
        with pytest.raises(ValueError, match="a tile of 1024×1024 cells with its halo: a grid of 4100×4100 cells"):
            ll.World(source, shape=(4100, 4100), solver=ll.Solver(bounces=bounces), halo=4000)
    assert asked == []


def test_progress_counts_the_parts_and_their_bounces():
    seen = []
    cells = ll.Cells((8, 1100), albedo=np.full((8, 1100, 3), 0.5), opacity=np.eye(8, 1100), sky=SKY)
    ll.World(cells, solver=ll.Solver(bounces=2), progress=lambda *numbers: seen.append(numbers))
    assert seen == [(done, 2, bounce) for bounce in range(3) for done in (1, 2)]


def test_a_map_is_a_world():
    level = ll.Map.load(MAP)
    assert ll.Map.reads(MAP) and not ll.Map.reads("cave.toml")
    assert (level.shape, level.origin) == ((192, 384), (0, 0))
    cells = level.cells()
    part = level.window(32, 100, 90, 200)
    for field in ("opacity", "emission", "albedo", "color"):
        np.testing.assert_array_equal(getattr(part, field), getattr(cells, field)[32:122, 100:300])
    world = ll.World(MAP, solver=SOLVER)
    errors = ll.compare(world.light(0, 0, *level.shape), SOLVER.solve(cells))
    assert errors.relative_rmse < 0.02
    again = pickle.loads(pickle.dumps(level))
    np.testing.assert_array_equal(again.window(0, 0, 50, 60).opacity, cells.opacity[:50, :60])


def test_other_files_are_no_maps(tmp_path):
    with pytest.raises(ValueError, match=r"\.tmx, \.world and \.ldtk"):
        ll.Map.load(tmp_path / "cave.toml")
    with pytest.raises(ValueError, match="cellar.tmx"):
        ll.World(tmp_path / "cellar.tmx")
    with pytest.raises(ValueError, match="window"):
        ll.Map.load(MAP).window(0, 0, 193, 384)


def test_ctrl_c_stops_the_reading():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        ll.World(lambda *window: ll.Cells(window[2:]), shape=(60000, 60000))
    timer.join()
    signal.signal(signal.SIGINT, before)


def test_other_threads_run_while_a_tile_is_lit(expected):
    world = ll.World(whole(), **SETTINGS)
    ended, count = threading.Event(), 0
    thread = threading.Thread(target=lambda: (light(world), ended.set()))
    thread.start()
    while not ended.wait(0.001):
        count += 1
    thread.join()
    assert count > 10


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_a_forked_child_lights_its_world(expected):
    world = ll.World(whole(), **{**SETTINGS, "solver": ll.Solver(bounces=1)})
    tile = world.tiles(TILE)[0]
    child = os.fork()
    if child == 0:
        found = world.light(*tile).rgb
        os._exit(0 if np.array_equal(found, expected[: tile[2], : tile[3]]) else 1)
    limit = threading.Timer(60, os.kill, [child, signal.SIGKILL])
    limit.start()
    _, status = os.waitpid(child, 0)
    limit.cancel()
    assert os.waitstatus_to_exitcode(status) == 0
