"""The notebook's code runs, and its plots show something."""

import json
import pathlib

import matplotlib.pyplot as plt
import numpy as np

NOTEBOOK = pathlib.Path(__file__).parents[1] / "notebooks/light.ipynb"


def test_the_notebook_runs():
    plt.switch_backend("Agg")
    names = {}
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [], "outputs are not kept"
            exec("".join(cell["source"]), names)
    figures = [plt.figure(number) for number in plt.get_fignums()]
    for figure in figures:
        figure.canvas.draw()
        assert np.asarray(figure.canvas.buffer_rgba()).std() > 10
    plt.close("all")
    assert len(figures) == 7
    # What the plots are to show.
    assert abs(np.nanmean(names["error"](names["light"]))) < 0.03
    assert names["noise"][0] > 1.9 * names["noise"][1] > 3.6 * names["noise"][2]
