"""What tests and the examples of pages share."""

import pathlib

import pytest

ROOT = pathlib.Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def a_folder_with_the_scenes(tmp_path, monkeypatch):
    """Examples name scenes as in a clone, and may leave files."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
