"""2D global illumination over numpy arrays, and the path tracer that measures its error.

Row 0 is the top row. Lengths are in cells ("px"); the centre of cell (i, j) lies at (i + ½, j + ½). Light is linear RGB.
"""

from lamplight2d._core import Cells, Light, Map, Measures, Reference, Scene, Solver, compare, reference
from lamplight2d._world import World

__all__ = ["Cells", "Light", "Map", "Measures", "Reference", "Scene", "Solver", "World", "compare", "reference"]
