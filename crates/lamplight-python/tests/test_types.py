"""The stubs say what the module has."""

import subprocess
import sys


def test_stubs():
    check = [sys.executable, "-m", "mypy.stubtest", "lamplight2d"]
    done = subprocess.run(check, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
