"""The command ``lamplight``: the same light as the package's, exit codes, and its end by a signal."""

import json
import pathlib
import signal
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import lamplight2d as ll

SCENES = pathlib.Path(__file__).parents[3] / "scenes"


def lamplight(*arguments, folder=None):
    """Runs the script beside the interpreter, as a shell does."""
    program = pathlib.Path(sys.executable).with_name("lamplight")
    return subprocess.run([program, *map(str, arguments)], cwd=folder, capture_output=True, text=True)


def test_version_and_module():
    module = subprocess.run([sys.executable, "-m", "lamplight2d", "--version"], capture_output=True, text=True)
    for done in [lamplight("--version"), module]:
        assert (done.returncode, done.stdout[:10], done.stderr) == (0, "lamplight ", "")


def test_a_picture_is_that_of_the_package(tmp_path):
    scene = ll.Scene.load(SCENES / "two_rooms.toml")
    cells = scene.cells()
    light = ll.Solver(**scene.settings).solve(cells)
    done = lamplight("render", SCENES / "two_rooms.toml", "-o", "a.png", folder=tmp_path)
    assert done.returncode == 0 and done.stdout.startswith("wrote a.png"), done
    picture = np.asarray(Image.open(tmp_path / "a.png"))
    np.testing.assert_array_equal(picture, light.compose(cells, **scene.display))
    assert (picture != light.compose(cells, exposure=1)).any()


def test_light_is_that_of_the_package():
    scene = ll.Scene.load(SCENES / "two_rooms.toml")
    light = ll.Solver(**scene.settings).solve(scene.cells())
    done = lamplight("probe", SCENES / "two_rooms.toml", "40.5,30.25", "--json")
    [point] = json.loads(done.stdout)["points"]
    np.testing.assert_array_equal(np.float32(point["light"]), light.sample([[40.5, 30.25]])[0])


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        ([], 2, "Usage: lamplight"),
        (["render"], 2, "Usage: lamplight render"),
        (["render", "missing.toml"], 2, "missing.toml"),
        (["render", SCENES / "cave.toml", "--quality", "fine"], 2, "fine"),
        (["render", SCENES / "cave.toml", "--backend", "gpu", "-o", "a.png"], 1, "no GPU support"),
    ],
)
def test_errors(arguments, code, text, tmp_path):
    done = lamplight(*arguments, folder=tmp_path)
    assert done.returncode == code and text in done.stderr and "Traceback" not in done.stderr
    assert done.stdout == "" and [path.name for path in tmp_path.iterdir()] == ["scenes"]


@pytest.mark.skipif(sys.platform == "win32", reason="signals as on Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it(number, tmp_path):
    program = pathlib.Path(sys.executable).with_name("lamplight")
    flags = ["--method", "reference", "--samples", "1000000", "-o", "a.png"]
    # Warnings come before the work: a flag without effect makes one.
    command = [program, "render", SCENES / "cave.toml", *flags, "--quality", "fast"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as running:
        assert "--quality" in running.stderr.readline()
        running.send_signal(number)
        assert running.wait(10) == 128 + number
        assert running.stderr.read() == ""
    assert [path.name for path in tmp_path.iterdir()] == ["scenes"]


@pytest.mark.skipif(sys.platform == "win32", reason="pipes as on Unix")
def test_a_reader_may_leave():
    program = pathlib.Path(sys.executable).with_name("lamplight")
    with subprocess.Popen([program, "man"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.close()
        assert running.stderr.read() == b"" and running.wait(10) == 0
