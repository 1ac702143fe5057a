"""`World`: worlds larger than a grid, read and lit window by window."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Union

import numpy as np

from lamplight2d._core import Cells, FarWorld, Lamps, Light, Map, Scene, Solver, Tiling, cells_within

Window = tuple[int, int, int, int]
"""Row and column of its first cell, its height and its width."""

WorldSource = Union[Scene, Map, Cells, str, "os.PathLike[str]", Mapping[str, Any], Callable[[int, int, int, int], Cells]]
"""What a `World` can be read from."""

Progress = Callable[[int, int, int], object]
"""Is told how many parts are done, of how many, and of which bounce."""

HALO, COLUMNS = 64, 512
"""The defaults of a `World`."""


class World:
    """A grid of matter of up to 65536 cells a side, lit tile by tile, each with the light of all.

    It is read in parts of 1024×1024 cells, and once more for every bounce, to find the light that these send each other.
    Then any window is lit from its own cells and from the light that enters it. Windows do not depend on each other, and
    have the same bytes in any order, on any machine.

    A pickle holds the far field, and the source as that is pickled: arrays in memory with all their values, those of
    ``zarr``, maps, and a scene that was loaded as their paths.

    Parameters
    ----------
    source : Scene, Map, str or path-like, Cells, dict or callable
        A scene, a map, or the path of the file of either. Or a dict of arrays, by the names of the fields of `Cells`, of the shapes
        (H, W) or (H, W, 3), that are sliced by ``[y0:y1, x0:x1]``: of numpy, ``zarr``, ``h5py``, a memory map. Or
        ``source(y, x, height, width)``, which returns the `Cells` of a window with the lamps that reach into it, with
        positions relative to the window.
    solver : Solver, optional
        Its settings and its threads. By default those of the scene, or ``Solver()``.
    halo : int, optional
        The margin of a tile in px, in which matter is known cell by cell. More is closer to one solve of the whole, and
        takes time. In half of it, up to 32 px, tiles pass into each other.
    columns : int, optional
        Directions of the light that enters a tile. More are sharper shadows of distant lights, and take time and memory.
    shape : tuple of int, optional
        Rows and columns. Only for a callable, which needs it.
    lamps : list of dict, optional
        As for `Cells`. Only for a dict of arrays.
    sky, suns : optional
        As for `Cells`. Only for a dict of arrays and a callable; suns are part of the sky.
    progress : callable, optional
        ``progress(done, parts, bounce)`` is called after each part that was read, for which ``bounce`` is 0, and then for
        each bounce after each part of which it was found.

    Raises
    ------
    ValueError
        If arrays do not match, the world is too large, the method does not read the light that enters a tile, a cell is
        invalid, or a lamp is lit by a shadow map. What a callable raises comes out as it is.
    """

    def __init__(
        self,
        source: WorldSource,
        *,
        solver: Solver | None = None,
        halo: int = HALO,
        columns: int = COLUMNS,
        shape: tuple[int, int] | None = None,
        lamps: list[dict[str, Any]] | None = None,
        sky: Any = None,
        suns: list[dict[str, Any]] | None = None,
        progress: Progress | None = None,
    ) -> None:
        reader, empty = prepare(source, solver, halo, columns, shape, lamps, sky, suns)
        self._reader, self._empty, self._halo = reader, empty, halo
        self._far = settled(reader, empty.finished(_read(reader, empty, progress)), progress)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns, (H, W)."""
        return self._far.shape

    def tiles(self, side: int) -> list[Window]:
        """Returns the windows of all tiles of this side, row by row.

        Parameters
        ----------
        side : int
            px. Tiles at the right and at the bottom may be smaller.

        Returns
        -------
        list of tuple of int
            (y, x, height, width) of each, as `light` takes them.
        """
        return Tiling(self.shape, side, self._halo).tiles()

    def light_tiles(self, side: int) -> Iterator[tuple[Window, Light]]:
        """Computes the light of all tiles of this side, one after the other, row by row.

        The light of each passes into that of the next, so that there are no seams. Two rows of tiles are in memory at a
        time.

        Parameters
        ----------
        side : int
            px. Tiles at the right and at the bottom may be smaller.

        Yields
        ------
        window : tuple of int
            (y, x, height, width) of the tile.
        light : Light

        Raises
        ------
        ValueError
            If ``side`` is below 1, or a tile is larger, with its halo, than a grid.
        """
        tiling = Tiling(self.shape, side, self._halo)
        known: dict[Window, Light] = {}
        for tile in tiling.tiles():
            around = [one for one, _ in tiling.around(tile)]
            # Later tiles need none before the first of these.
            known = {one: light for one, light in known.items() if one[:2] >= around[0][:2]}
            for one in around:
                if one not in known:
                    cells = self._reader(*self._far.around_tile(one))
                    known[one] = self._far.light(one, cells, tiling.with_rim(one))
            yield tile, tiling.mixed(tile, [(one, tiling.with_rim(one), known[one]) for one in around])

    def light(self, y: int, x: int, height: int, width: int) -> Light:
        """Computes the light of a window, without the GIL.

        Windows beside each other differ a little along their border: `light_tiles` has no seams.

        Parameters
        ----------
        y, x : int
            Row and column of its first cell.
        height, width : int

        Returns
        -------
        Light

        Raises
        ------
        ValueError
            If the window does not lie in the world, or is larger, with its halo, than a grid.
        """
        window = (y, x, height, width)
        return self._far.light(window, self._reader(*self._far.around_tile(window)))

    def __repr__(self) -> str:
        return f"<World of shape {self.shape}>"


def _read(reader: Reader, empty: FarWorld, progress: Progress | None) -> Iterator[bytes]:
    parts = empty.parts()
    for done, (part, window) in enumerate(parts, 1):
        yield empty.read(part, reader(*window))
        if progress is not None:
            progress(done, len(parts), 0)


def settled(reader: Reader, far: FarWorld, progress: Progress | None = None) -> FarWorld:
    """The far field with all of its bounces."""
    bounce = 0
    while far.goes_on:
        bounce += 1
        far = far.finished(_bounce(reader, far, bounce, progress))
    return far


def _bounce(reader: Reader, far: FarWorld, bounce: int, progress: Progress | None) -> Iterator[bytes]:
    parts = far.parts()
    for done, (part, _) in enumerate(parts, 1):
        yield far.bounce(part, reader(*far.around_tile(part)))
        if progress is not None:
            progress(done, len(parts), bounce)


Reader = Callable[[int, int, int, int], Cells]
"""Reads the cells of a window."""


def prepare(
    source: WorldSource,
    solver: Solver | None,
    halo: int,
    columns: int,
    shape: tuple[int, int] | None,
    lamps: list[dict[str, Any]] | None,
    sky: Any,
    suns: list[dict[str, Any]] | None,
) -> tuple[Reader, FarWorld]:
    """Checks what a world is made of, and returns its reader and its far field, of which nothing has been read."""
    if isinstance(source, (str, os.PathLike)):
        source = opened(source)
    given = {"shape": shape, "lamps": lamps, "sky": sky, "suns": suns}
    reader: Reader
    if isinstance(source, (Scene, Map, Cells)):
        _refuse(given, f"{type(source).__name__} has its own")
        if solver is None and isinstance(source, Scene):
            solver = Solver(**source.settings)
        reader, shape = source.window, source.shape
        around = source.window(0, 0, 1, 1)
    else:
        around = Cells((1, 1), sky=sky, suns=suns)
        if isinstance(source, Mapping):
            _refuse({"shape": shape}, "arrays have their own")
            reader = ArrayReader(source, lamps)
            shape = reader.shape
        elif callable(source):
            _refuse({"lamps": lamps}, "the cells that a callable returns have their own")
            if shape is None:
                raise ValueError("shape is missing; expected rows and columns, which a callable does not have")
            reader = CallableReader(source)
        else:
            expected = "a Scene, a Map, the path of one, Cells, a dict of arrays, or a callable"
            raise TypeError(f"source is a {type(source).__name__}; expected {expected}")
    solver = Solver() if solver is None else solver
    empty = FarWorld(shape, around, solver, halo, columns)
    if solver.settings["bounces"] != 0:
        # For bounces parts are lit as tiles. One that is too large with its halo is refused before all of them are read.
        for part, _ in empty.parts():
            empty.around_tile(part)
    return reader, empty


def opened(path: str | os.PathLike[str]) -> Scene | Map:
    """The scene or the map in a file."""
    return Map.load(path) if Map.reads(path) else Scene.load(path)


def _refuse(given: dict[str, Any], reason: str) -> None:
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{name} is given; {reason}")


class ArrayReader:
    """Cells from arrays, which are sliced window by window."""

    def __init__(self, arrays: Mapping[str, Any], lamps: list[dict[str, Any]] | None) -> None:
        self.arrays, self.lamps = dict(arrays), Lamps([] if lamps is None else lamps)
        if not self.arrays:
            raise ValueError(f"source has no array; expected some of {', '.join(Cells.FIELDS)}")
        first, *_ = self.arrays
        for name, array in self.arrays.items():
            if name not in Cells.FIELDS:
                raise ValueError(f"{name} is not a field; expected some of {', '.join(Cells.FIELDS)}")
            if not hasattr(array, "shape"):
                raise TypeError(f"{name} is a {type(array).__name__}; expected an array, as numpy.asarray makes one")
            form = ("H", "W") if name in ("opacity", "masks") else ("H", "W", 3)
            found = tuple(array.shape)
            if len(found) != len(form) or found[2:] != form[2:]:
                raise ValueError(f"{name} has the shape {found}; expected ({', '.join(map(str, form))})")
            if found[:2] != self.shape:
                raise ValueError(f"{name} has the shape {found}; expected {self.shape} cells, as {first} has")

    @property
    def shape(self) -> tuple[int, int]:
        height, width = next(iter(self.arrays.values())).shape[:2]
        return height, width

    def __call__(self, y: int, x: int, height: int, width: int) -> Cells:
        return cells_of(self.lamps, (y, x, height, width), self.slices(y, x, height, width))

    def slices(self, y: int, x: int, height: int, width: int) -> dict[str, Any]:
        """The fields of a window, as its arrays give them."""
        return {name: array[y : y + height, x : x + width] for name, array in self.arrays.items()}


def cells_of(lamps: Lamps, window: Window, fields: dict[str, Any]) -> Cells:
    """The cells of a window with these fields."""
    arrays: dict[str, Any] = {name: np.asarray(field) for name, field in fields.items()}
    return cells_within(window, **arrays, lamps=lamps.within(window))


class CallableReader:
    """Cells from a function of the caller."""

    def __init__(self, function: Reader) -> None:
        self.function = function

    def __call__(self, y: int, x: int, height: int, width: int) -> Cells:
        cells = self.function(y, x, height, width)
        if not isinstance(cells, Cells):
            raise TypeError(f"source returned a {type(cells).__name__}; expected Cells")
        return cells
