"""Light against closed forms, the reference, and another run of itself."""

import copy
import math
import os
import pathlib
import pickle
import signal
import threading

import numpy as np
import pytest
from PIL import Image

import lamplight2d as ll

SCENES = pathlib.Path(__file__).parents[3] / "scenes"


def room():
    opacity = np.zeros((40, 50))
    opacity[:, 20:23] = 1
    albedo = np.full((40, 50, 3), 0.5)
    lamp = {"position": [10.5, 20.5], "color": "#ff8800", "intensity": 8}
    return ll.Cells((40, 50), opacity=opacity, albedo=albedo, lamps=[lamp], sky=[0.01, 0.02, 0.03])


def test_an_empty_grid_has_the_light_of_its_sky():
    cells = ll.Cells((16, 24), sky=[0.5, 1.0, 2.0])
    for light in [ll.Solver().solve(cells), ll.reference(cells, 16).light]:
        np.testing.assert_allclose(light.rgb, np.broadcast_to([0.5, 1, 2], (16, 24, 3)), rtol=1e-4)


def test_a_glowing_wall_has_its_closed_form():
    """A wall of radiance L that is seen under an angle α gives a mean radiance of L·α/2π."""
    opacity = np.zeros((48, 64))
    opacity[16:33, 8:10] = 1
    emission = opacity[..., None] * [1.0, 2.0, 3.0]
    cells = ll.Cells((48, 64), opacity=opacity, emission=emission)
    expected = 2 * math.atan(8.5 / 40.5) / math.tau * np.array([1, 2, 3])
    for light in [ll.Solver(bounces=0).solve(cells), ll.reference(cells, 4096, bounces=0).light]:
        np.testing.assert_allclose(light.sample([[50.5, 24.5]])[0], expected, rtol=0.01)


def test_the_comparison_sees_a_perturbation():
    truth = ll.reference(room(), 64)
    assert truth.standard_error.shape == truth.light.rgb.shape
    same = ll.compare(truth.light, truth.light)
    assert (same.relative_rmse, same.bias, same.p99) == (0, 0, 0)
    brighter = ll.Light(truth.light.rgb * 1.1, solid=truth.light.solid)
    assert ll.compare(brighter, truth.light).bias == pytest.approx(0.1, rel=1e-3)
    with pytest.raises(ValueError, match="shape"):
        ll.compare(ll.Light(np.zeros((2, 2, 3))), truth.light)
    solid = ll.Light(truth.light.rgb, solid=np.ones_like(truth.light.solid))
    with pytest.raises(ValueError, match="truth: all cells are solid"):
        ll.compare(brighter, solid)


def test_the_same_bytes_on_any_number_of_threads():
    one, two = (ll.Solver(threads=n).solve(room()).rgb.tobytes() for n in (1, 2))
    assert one == two
    one, two = (ll.reference(room(), 16, threads=n).light.rgb.tobytes() for n in (1, 2))
    assert one == two


def test_threads_of_python_share_a_solver():
    solver, cells = ll.Solver(), room()
    expected, found = solver.solve(cells).rgb, []
    threads = [threading.Thread(target=lambda: found.append(solver.solve(cells).rgb)) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(found) == 4 and all(np.array_equal(light, expected) for light in found)


def test_other_threads_run_during_a_solve():
    ended, count = threading.Event(), 0
    thread = threading.Thread(target=lambda: (ll.reference(room(), 512), ended.set()))
    thread.start()
    while not ended.wait(0.001):
        count += 1
    thread.join()
    assert count > 10


def test_pickles():
    cells = pickle.loads(pickle.dumps(room()))
    assert cells.lamps == room().lamps and cells.sky == room().sky
    solver = ll.Solver(threads=1, method="raymarch", raymarch={"rays": 8})
    again = pickle.loads(pickle.dumps(solver))
    assert again.settings == solver.settings and again.threads == 1
    light = solver.solve(room())
    assert again.solve(cells).rgb.tobytes() == light.rgb.tobytes()
    light = pickle.loads(pickle.dumps(light))
    assert light.solid.sum() == 40 * 3
    truth = ll.reference(room(), 16)
    again = pickle.loads(pickle.dumps(truth))
    for field in ["rgb", "moment", "solid"]:
        assert getattr(again.light, field).tobytes() == getattr(truth.light, field).tobytes()
    assert again.standard_error.tobytes() == truth.standard_error.tobytes()
    measures = ll.compare(light, truth.light)
    assert repr(pickle.loads(pickle.dumps(measures))) == repr(measures)
    for scene in [ll.Scene.load(SCENES / "grove.toml"), ll.Scene.from_toml("size = [8, 6]")]:
        assert pickle.loads(pickle.dumps(scene)).to_toml() == scene.to_toml()


def test_a_pickle_has_the_cookies_of_lamps(tmp_path):
    """Their pictures too, in full, so that no file is needed where it is read."""
    picture = np.random.default_rng(5).integers(0, 256, (9, 17, 3), np.uint8)
    Image.fromarray(picture).save(tmp_path / "leaves.png")
    cookie = {"picture": str(tmp_path / "leaves.png"), "size": 30, "turn": "20deg"}
    cells = ll.Cells((40, 50), lamps=[{"position": [20.5, 20.5], "cookie": cookie}])
    (tmp_path / "leaves.png").unlink()
    expected = ll.Solver().solve(cells).rgb
    for again in [pickle.loads(pickle.dumps(cells)), copy.copy(cells), copy.deepcopy(cells)]:
        np.testing.assert_array_equal(ll.Solver().solve(again).rgb, expected)
    bare = ll.Cells((40, 50), lamps=[{**cells.lamps[0], "cookie": {**cells.lamps[0]["cookie"], "turn": 0}}])
    assert not np.array_equal(ll.Solver().solve(bare).rgb, expected)


@pytest.mark.parametrize("elevation", [math.nan, math.inf, 0, -1, 1.6])
def test_light_has_the_elevations_of_solvers(elevation):
    fields = {"rgb": np.ones((4, 6, 3)), "moment": np.zeros((4, 6, 2, 3))}
    with pytest.raises(ValueError, match="`elevation` is .*, but must be from 0.05 to 1.5"):
        ll.Light(**fields, elevation=elevation)
    assert ll.Light(**fields, elevation=1.5).elevation == 1.5


def test_settings_are_checked():
    with pytest.raises(ValueError, match="holographic"):
        ll.Solver(method="magic")
    with pytest.raises(ValueError, match="bounces"):
        ll.Solver(bounces=-1)
    with pytest.raises(ValueError, match="samples"):
        ll.reference(room(), 0)
    with pytest.raises(ValueError, match="1 to 1024"):
        ll.Solver(threads=0)


def test_a_scene_is_lit_and_shown():
    scene = ll.Scene.load(SCENES / "two_rooms.toml")
    cells = scene.cells()
    light = ll.Solver(**scene.settings).solve(cells)
    picture = light.compose(cells, **scene.display)
    assert picture.shape == (*cells.shape, 3) and picture.dtype == np.uint8
    assert picture.std() > 10
    with pytest.raises(ValueError, match="missing.toml"):
        ll.Scene.load("missing.toml")
    with pytest.raises(ValueError, match="`display.tonemapp` is not a known key; did you mean `tonemap`"):
        light.compose(cells, tonemapp="aces")
    with pytest.raises(ValueError, match="exposure"):
        light.compose(cells, exposure=1e9)


def test_ctrl_c_stops_the_reference():
    # What a shell starts in the background ignores Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        ll.reference(room(), 1_000_000)
    timer.join()
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_a_forked_child_has_threads_of_its_own():
    solvers = [ll.Solver(), ll.Solver(threads=2)]
    expected = [solver.solve(room()).rgb.tobytes() for solver in solvers]
    child = os.fork()
    if child == 0:
        found = [solver.solve(room()).rgb.tobytes() for solver in solvers]
        os._exit(0 if found == expected else 1)
    limit = threading.Timer(30, os.kill, [child, signal.SIGKILL])
    limit.start()
    _, status = os.waitpid(child, 0)
    limit.cancel()
    assert os.waitstatus_to_exitcode(status) == 0


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "raymarch"},
        {"method": "raymarch", "temporal": {"history_length": 8}},
        {"method": "flood"},
        {"bounces": "feedback"},
    ],
)
def test_history_is_forgotten(settings):
    solver, cells = ll.Solver(**settings), room()
    first, second = (solver.solve(cells).rgb.copy() for _ in range(2))
    assert not np.array_equal(first, second)
    solver.reset()
    np.testing.assert_array_equal(solver.solve(cells).rgb, first)


def test_images_of_a_scene_are_found_from_another_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(SCENES.parent)
    scene = ll.Scene.load("scenes/cellar.toml")
    expected = scene.cells()
    monkeypatch.chdir(tmp_path)
    np.testing.assert_array_equal(scene.cells().albedo, expected.albedo)
