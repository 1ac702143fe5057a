"""The same bytes on any scheduler and any number of workers, also if one is lost."""

import os
import pathlib
import signal
import threading
import time

import dask
import dask.array as da
import numpy as np
import pytest
from distributed import Client, LocalCluster

import lamplight2d as ll
import lamplight2d.dask

SCENES = pathlib.Path(__file__).parents[3] / "scenes"


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        yield cluster


@pytest.fixture
def client(cluster):
    with Client(cluster) as client:
        yield client


def scale(cluster, client, count):
    cluster.scale(count)
    wait_for(client, count)


def wait_for(client, count):
    """Waits for the number of workers, also if they are too many."""
    limit = time.monotonic() + 60
    while len(client.nthreads()) != count:
        assert time.monotonic() < limit, client.nthreads()
        time.sleep(0.05)


def frame(turn):
    """A lamp that goes round a pillar."""
    opacity = np.zeros((30, 40))
    opacity[12:18, 18:22] = 1
    lamp = {"position": [20 + 14 * np.cos(turn), 15 + 10 * np.sin(turn)], "intensity": 8}
    return ll.Cells((30, 40), opacity=opacity, albedo=np.full((30, 40, 3), 0.5), lamps=[lamp])


def frame_or_death(turn, mark):
    """A frame, in place of which the first worker that is asked for it dies."""
    try:
        mark.touch(exist_ok=False)
    except FileExistsError:
        return frame(turn)
    os.kill(os.getpid(), signal.SIGKILL)


TURNS = np.linspace(0, 6, 12)
# With a history, which no frame may inherit from another.
SOLVER = ll.Solver(threads=1, method="raymarch", raymarch={"rays": 8}, temporal={"history_length": 8})


def loop():
    """The frames without Dask."""
    frames = []
    for turn in TURNS:
        SOLVER.reset()
        frames.append(SOLVER.solve(frame(turn)).rgb)
    return np.stack(frames)


def test_frames_have_the_same_bytes_everywhere(cluster, client):
    expected = loop()
    frames = ll.dask.render_frames(map(frame, TURNS), SOLVER)
    assert (frames.shape, frames.dtype, frames.numblocks[0]) == (expected.shape, np.float32, len(TURNS))
    for count in [1, 2, 4]:
        scale(cluster, client, count)
        np.testing.assert_array_equal(frames.compute(), expected)
    for scheduler in ["sync", "threads"]:
        np.testing.assert_array_equal(frames.compute(scheduler=scheduler), expected)
    assert not np.array_equal(frames[::-1].compute(), expected)


@pytest.mark.skipif(os.name == "nt", reason="SIGKILL")
def test_a_lost_worker_changes_no_frame(cluster, client, tmp_path):
    scale(cluster, client, 2)
    lazy = [dask.delayed(frame)(turn) for turn in TURNS]
    lazy[7] = dask.delayed(frame_or_death)(TURNS[7], tmp_path / "mark")
    before = set(client.run(os.getpid).values())
    frames = ll.dask.render_frames(lazy, SOLVER, shape=(30, 40)).compute()
    assert (tmp_path / "mark").exists()
    np.testing.assert_array_equal(frames, loop())
    wait_for(client, 2)
    assert set(client.run(os.getpid).values()) != before


def test_the_reference_has_the_bytes_of_one_machine(cluster, client):
    settings = {"bounces": 2, "wall_depth": 3}
    cells = frame(0)
    expected = ll.reference(cells, 64, **settings)
    for count, parts in [(1, 1), (2, 7), (4, 64)]:
        scale(cluster, client, count)
        found = ll.dask.reference(cells, 64, parts=parts, **settings).compute()
        same(found, expected)
    same(ll.dask.reference(dask.delayed(cells), 64, **settings).compute(scheduler="threads"), expected)
    other = ll.dask.reference(cells, 64, seed=1, **settings).compute()
    assert other.light.rgb.tobytes() != expected.light.rgb.tobytes()


def same(found, expected):
    for field in ["rgb", "moment", "solid"]:
        assert getattr(found.light, field).tobytes() == getattr(expected.light, field).tobytes(), field
    assert found.standard_error.tobytes() == expected.standard_error.tobytes()


@pytest.mark.skipif(os.name == "nt", reason="SIGKILL")
def test_a_lost_worker_changes_no_reference(cluster, client):
    scale(cluster, client, 2)
    scene = ll.Scene.load(SCENES / "grove.toml")
    [*_, victim] = client.run(os.getpid).values()
    timer = threading.Timer(0.5, os.kill, [victim, signal.SIGKILL])
    timer.start()
    # Enough samples that workers are still busy when one is killed.
    found = ll.dask.reference(scene, 400, bounces=1).compute()
    assert not timer.is_alive()
    same(found, ll.reference(scene.cells(), 400, bounces=1))


WORLD = {"solver": ll.Solver(threads=1, bounces=1), "halo": 16, "columns": 32}
LAMPS = [{"position": [90.5, 40.5]}, {"position": [1054.5, 100.5], "intensity": 40}]


SHAPE = (160, 1100)
"""That of a world of two parts."""


def world_arrays():
    opacity = np.zeros(SHAPE, np.float32)
    opacity[20:140, 120:130] = opacity[110:120, 300:500] = opacity[40:160, 1000:1010] = 1
    return {"opacity": opacity, "albedo": np.full((*SHAPE, 3), 0.5, np.float32)}


def world_window(*window):
    """A window of the world, as a function that workers import."""
    return ll.Cells(SHAPE, **world_arrays(), lamps=LAMPS).window(*window)


def slow_world_window(*window):
    time.sleep(0.3)
    return world_window(*window)


def all_light(world):
    """The light of all tiles of 128 px, put together."""
    light = np.empty((*world.shape, 3), np.float32)
    for (y, x, height, width), tile in world.light_tiles(128):
        light[y : y + height, x : x + width] = tile.rgb
    return light


@pytest.fixture(scope="module")
def world():
    """The light of the world without Dask."""
    return all_light(ll.World(world_arrays(), lamps=LAMPS, **WORLD))


def test_a_world_has_the_same_bytes_everywhere(cluster, client, world):
    lit = ll.dask.light_world(world_window, tile=128, shape=SHAPE, **WORLD)
    assert (lit.shape, lit.dtype, lit.numblocks) == (world.shape, np.float32, (2, 9, 1))
    for count in [1, 2, 4]:
        scale(cluster, client, count)
        np.testing.assert_array_equal(lit.compute(), world)
    for scheduler in ["sync", "threads"]:
        np.testing.assert_array_equal(lit.compute(scheduler=scheduler), world)
    np.testing.assert_array_equal(lit[100:140, 50:60].compute(), world[100:140, 50:60])
    known = ll.dask.light_world(ll.World(world_arrays(), lamps=LAMPS, **WORLD), tile=128)
    np.testing.assert_array_equal(known.compute(), world)
    dark = ll.dask.light_world(world_arrays(), tile=128, **WORLD)
    assert not np.array_equal(dark.compute(), world)


def test_ray_gives_the_same_bytes(world):
    ray = pytest.importorskip("ray", reason="not installed")
    pytest.importorskip("ray.util.dask", reason="needs pandas", exc_type=ImportError)
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        frames = ll.dask.render_frames(map(frame, TURNS), SOLVER)
        lit = ll.dask.light_world(world_arrays(), tile=128, lamps=LAMPS, **WORLD)
        for lazy, expected in [(frames, loop()), (lit, world)]:
            np.testing.assert_array_equal(lazy.compute(scheduler=ray.util.dask.ray_dask_get), expected)
    finally:
        ray.shutdown()


@pytest.mark.parametrize("bounces", [0, 2, "converged"])
def test_bounces_of_workers_have_the_bytes_of_one_machine(cluster, client, world, bounces):
    """A fixed number is found by all workers, part by part, and an open one by one of them."""
    scale(cluster, client, 2)
    options = {**WORLD, "solver": ll.Solver(threads=1, bounces=bounces)}
    expected = all_light(ll.World(world_window, shape=SHAPE, **options))
    for source, shape in [(world_window, SHAPE), (world_window(0, 0, *SHAPE), None)]:
        lit = ll.dask.light_world(source, tile=128, shape=shape, **options)
        np.testing.assert_array_equal(lit.compute(), expected)
    # Another number of bounces is other light.
    assert not np.array_equal(expected, world)


@pytest.mark.skipif(os.name == "nt", reason="SIGKILL")
def test_a_lost_worker_changes_no_tile(cluster, client, world):
    scale(cluster, client, 2)
    [*_, victim] = client.run(os.getpid).values()
    timer = threading.Timer(1.5, os.kill, [victim, signal.SIGKILL])
    timer.start()
    lit = ll.dask.light_world(slow_world_window, tile=128, shape=SHAPE, **WORLD).compute()
    assert not timer.is_alive()
    np.testing.assert_array_equal(lit, world)


def test_a_world_goes_from_zarr_to_zarr(client, world, tmp_path):
    zarr = pytest.importorskip("zarr")
    group = zarr.open_group(tmp_path / "world.zarr", mode="w")
    for name, array in world_arrays().items():
        group.create_array(name, data=array, chunks=(100, 100, *array.shape[2:]))
    arrays = {name: group[name] for name in world_arrays()}
    lazy = {name: da.from_zarr(array) for name, array in arrays.items()}
    for number, source in enumerate([arrays, lazy, {**arrays, "albedo": lazy["albedo"]}]):
        lit = ll.dask.light_world(source, tile=128, lamps=LAMPS, **WORLD)
        path = tmp_path / f"light{number}.zarr"
        lit.to_zarr(path)
        found = zarr.open_array(path, mode="r")
        assert found.chunks == (128, 128, 3)
        np.testing.assert_array_equal(found[:], world)


def test_a_scene_file_is_a_world(client):
    path = SCENES / "two_rooms.toml"
    lit = ll.dask.light_world(path, tile=128, halo=16, columns=32).compute()
    world = ll.World(path, halo=16, columns=32)
    np.testing.assert_array_equal(lit, all_light(world))


def test_pictures_of_scenes_are_those_of_their_files(client):
    scenes = [ll.Scene.load(SCENES / f"{name}.toml") for name in ["two_rooms", "fog"]]
    pictures = ll.dask.render_frames(scenes, display={"exposure": 1}).compute()
    for picture, scene in zip(pictures, scenes):
        cells = scene.cells()
        light = ll.Solver(**scene.settings).solve(cells)
        np.testing.assert_array_equal(picture, light.compose(cells, **{**scene.display, "exposure": 1}))


def test_a_sweep_is_a_table(client):
    settings = [{"method": "holographic", "bounces": 1}, {"method": "raymarch", "raymarch": {"rays": 4}, "bounces": 0}]
    scenes = {"left": frame(3), "right": dask.delayed(frame)(0)}
    table = ll.dask.sweep(scenes, settings, samples=64).compute()
    assert [row["scene"] for row in table] == ["left", "left", "right", "right"]
    for row, case in zip(table, settings * 2):
        cells = frame(3 if row["scene"] == "left" else 0)
        truth = ll.reference(cells, 64, bounces=case["bounces"]).light
        expected = ll.compare(ll.Solver(**case).solve(cells), truth)
        assert row["relative_rmse"] == expected.relative_rmse and row["seconds"] > 0
        assert row["method"] == case["method"]


@pytest.mark.parametrize(
    ("case", "frames"),
    [
        ({"method": "flood"}, 32),
        ({"bounces": "feedback"}, 16),
        ({"method": "raymarch", "raymarch": {"rays": 4}, "temporal": {"history_length": 5}, "bounces": 0}, 5),
    ],
)
def test_a_sweep_measures_light_that_goes_on_after_some_frames(case, frames):
    [row] = ll.dask.sweep([frame(3)], [case], samples=16).compute(scheduler="sync")
    cells, solver = frame(3), ll.Solver(**case)
    lights = [solver.solve(cells) for _ in range(frames)]
    truth = ll.reference(cells, 16, bounces=solver.settings["bounces"]).light
    found = [ll.compare(light, truth).relative_rmse for light in (lights[0], lights[-1])]
    assert row["relative_rmse"] == found[1] != found[0]


def test_what_changes_after_the_call_has_no_part_in_it():
    table = {"rays": 4}
    case = {"method": "raymarch", "raymarch": table, "bounces": 0}

    def errors(lazy):
        # On one thread, whose solver could remember the settings of the sweep before.
        return [row["relative_rmse"] for row in lazy.compute(scheduler="sync")]

    few = ll.dask.sweep([frame(0)], [case], samples=16)
    before = errors(few)
    table["rays"] = 64
    assert errors(few) == before
    assert errors(ll.dask.sweep([frame(0)], [case], samples=16)) != before

    display = {"exposure": 1}
    pictures = ll.dask.render_frames([frame(0)], display=display)
    before = pictures.compute(scheduler="sync")
    display["exposure"] = -3
    np.testing.assert_array_equal(pictures.compute(scheduler="sync"), before)
    other = ll.dask.render_frames([frame(0)], display=display).compute(scheduler="sync")
    assert not np.array_equal(other, before)


def test_bad_input_is_refused_at_once():
    with pytest.raises(ValueError, match="empty"):
        ll.dask.render_frames([])
    with pytest.raises(ValueError, match="shape"):
        ll.dask.render_frames([dask.delayed(frame)(0)])
    with pytest.raises(ValueError, match=r"frame 1 .*\(2, 2\); expected \(30, 40\)"):
        ll.dask.render_frames([frame(0), ll.Cells((2, 2))])
    with pytest.raises(TypeError, match="frame 0 is a str"):
        ll.dask.render_frames("frames")
    with pytest.raises(TypeError, match="scene 0 is a str"):
        ll.dask.sweep("scenes", [{}])
    with pytest.raises(ValueError, match="tonmap"):
        ll.dask.render_frames([frame(0)], display={"tonmap": "aces"})
    with pytest.raises(ValueError, match="bounce"):
        ll.dask.reference(frame(0), 16, bounce=1)
    with pytest.raises(ValueError, match="samples"):
        ll.dask.reference(frame(0), 0)
    with pytest.raises(ValueError, match="parts"):
        ll.dask.reference(frame(0), 16, parts=0)
    with pytest.raises(ValueError, match="magic"):
        ll.dask.sweep([frame(0)], [{"method": "magic"}])
    with pytest.raises(ValueError, match=r"\(9, 9\)"):
        ll.dask.render_frames([dask.delayed(frame)(0)], shape=(9, 9)).compute(scheduler="sync")
    with pytest.raises(TypeError, match="a frame is a NoneType"):
        ll.dask.render_frames([dask.delayed(print)()], shape=(9, 9)).compute(scheduler="sync")
    for one in [dask.delayed(frame)(0), frame(0), ll.Scene.from_toml("size = [8, 6]")]:
        with pytest.raises(TypeError, match=f"frames is one {type(one).__name__}; expected an iterable"):
            ll.dask.render_frames(one, shape=(30, 40))
        with pytest.raises(TypeError, match=f"scenes is one {type(one).__name__}; expected an iterable"):
            ll.dask.sweep(one, [{}])
    with pytest.raises(TypeError, match="settings is one dict; expected an iterable"):
        ll.dask.sweep([frame(0)], {"bounces": 1})
    with pytest.raises(TypeError, match="settings 1 is a str; expected a dict"):
        ll.dask.sweep([frame(0)], [{}, "bounces"])
    with pytest.raises(ValueError, match="settings 0 has threads; expected none"):
        ll.dask.sweep([frame(0)], [{"threads": 2}])
    for shape in [(30, 40, 3), 30, (30.0, 40.0), (-30, 40), (0, 40)]:
        with pytest.raises(ValueError, match="shape is .*; expected two whole numbers, rows and columns"):
            ll.dask.render_frames([dask.delayed(frame)(0)], shape=shape)
    assert ll.dask.render_frames([frame(0)], shape=np.array([30, 40])).shape == (1, 30, 40, 3)
    with pytest.raises(TypeError, match=r"solver is a dict; expected a Solver"):
        ll.dask.render_frames([frame(0)], {"bounces": 1})


def test_bad_worlds_are_refused_at_once():
    fields = world_arrays()
    for options, text in [
        ({"tile": 0}, "tile is 0; expected 1 or more"),
        ({"tile": -5}, "tile is -5"),
        ({"halo": -1}, "`halo` is -1, but must be 0 or more"),
        ({"columns": 10_000}, "1 to 8192"),
        ({"solver": ll.Solver(method="flood")}, "flood"),
        ({"shape": SHAPE}, "shape is given; arrays have their own"),
    ]:
        with pytest.raises(ValueError, match=text):
            ll.dask.light_world(fields, **options)
    with pytest.raises(ValueError, match="a tile of 20000×4 cells with its halo: a grid of .* is refused"):
        ll.dask.light_world({"opacity": da.zeros((4, 20000))}, tile=20000)
    with pytest.raises(ValueError, match=r"albedo has the shape \(4, 560, 3\); expected \(160, 1100\) cells"):
        ll.dask.light_world({**fields, "albedo": da.zeros((4, 560, 3))})
    with pytest.raises(ValueError, match="opaque is not a field"):
        ll.dask.light_world({"opaque": da.zeros((4, 560))})
    with pytest.raises(ValueError, match="shape is missing"):
        ll.dask.light_world(world_window)
    with pytest.raises(ValueError, match=r"arrays of Dask, .* set the number, as in Solver\(bounces=2\)"):
        ll.dask.light_world({"opacity": da.zeros((4, 6))}, solver=ll.Solver(bounces="converged"))
    with pytest.raises(ValueError, match="source is a World"):
        ll.dask.light_world(ll.World(ll.Cells((4, 6))), halo=5)
    with pytest.raises(TypeError, match="int; expected a Scene"):
        ll.dask.light_world(5)
    with pytest.raises(TypeError, match="source is a Delayed; expected a callable"):
        ll.dask.light_world(dask.delayed(frame)(0))
    with pytest.raises(TypeError, match="solver is a dict; expected a Solver"):
        ll.dask.light_world(fields, solver={"bounces": 1})
    for tile in ["64", 2.5, (64, 64), None]:
        with pytest.raises(TypeError, match="expected a whole number of px"):
            ll.dask.light_world(fields, tile=tile)
    assert ll.dask.light_world(fields, tile=np.int64(64)).chunksize[:2] == (64, 64)


def test_damaged_blocks_are_refused():
    world = ll.World(ll.Cells((64, 64), opacity=np.eye(64)))
    blocks = world._far.blocks((0, 0, 64, 64))
    with pytest.raises(ValueError, match="blocks is damaged"):
        world._empty.with_blocks(blocks[: len(blocks) // 2])
    assert world._empty.with_blocks(blocks)
    with pytest.raises(ValueError, match="0 to 1"):
        ll.dask.light_world({"opacity": da.full((4, 6), 2)}).compute(scheduler="sync")
