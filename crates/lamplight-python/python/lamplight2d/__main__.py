"""The command ``lamplight``, also as ``python -m lamplight2d``."""

import sys

from lamplight2d._core import run_command


def main() -> int:
    """Runs the command with the arguments of the program, and returns its exit code."""
    return run_command(["lamplight", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
