"""Frames, worlds, sweeps and references on many cores or machines, by Dask (``pip install "lamplight2d[dask]"``).

Everything is lazy: ``compute()`` runs it, on any scheduler of Dask. The result has the same bytes on all of them, on any
number of workers, and if workers are lost on the way; processors with other vector units may round differently.

A task takes one core, so give workers as many threads as they have cores. What is to be lit is a `Scene`, `Cells`, or a
``dask.delayed`` that makes either on its worker. A scene that was loaded travels as the path of its file, which workers
must be able to read; cells travel with all of their arrays.
"""

from __future__ import annotations

import copy
import ctypes
import operator
import os
import platform
import statistics
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Union

import dask
import dask.array as da
import numpy as np
from dask.delayed import Delayed

from lamplight2d._core import Cells, FarWorld, Light, Reference, Scene, Solver, Tiling, compare, join_parts, trace_part
from lamplight2d._world import COLUMNS, HALO, ArrayReader, Window, World, WorldSource, cells_of, opened, prepare, settled

__all__ = ["Source", "light_world", "reference", "render_frames", "sweep"]

Source = Union[Scene, Cells, Delayed]
"""What can be lit."""


def render_frames(
    frames: Iterable[Source],
    solver: Solver | None = None,
    *,
    shape: tuple[int, int] | None = None,
    display: Mapping[str, Any] | None = None,
) -> da.Array:
    """Lights frames, each for itself: none has a history.

    Parameters
    ----------
    frames : iterable of Scene, Cells or Delayed
    solver : Solver, optional
        Its settings and threads are used, the latter by every task: ``Solver(threads=1, ...)``. By default each scene
        is lit by its own settings, cells by those of ``Solver()``, and both on one thread.
    shape : tuple of int, optional
        Rows and columns of every frame. Only needed if the first frame is a Delayed.
    display : dict, optional
        Makes pictures, as `Light.compose` does, with these keys over those of the scene: ``{}`` for the scene's.

    Returns
    -------
    dask.array.Array of shape (frames, H, W, 3)
        A chunk per frame: linear light, float32, or pictures, uint8.
    """
    if isinstance(frames, (Scene, Cells, Delayed)):
        raise TypeError(f"frames is one {type(frames).__name__}; expected an iterable of them")
    _check_solver(solver)
    frames = list(frames)
    if not frames:
        raise ValueError("frames is empty; expected at least one")
    if shape is None:
        if isinstance(frames[0], Delayed):
            raise ValueError("shape is missing: that of a Delayed is not known before it is computed")
        _check_source("frame 0", frames[0])
        shape = frames[0].shape
    height, width = shape = _rows_and_columns(shape)
    for index, frame in enumerate(frames):
        _check_source(f"frame {index}", frame)
        if not isinstance(frame, Delayed):
            _check_shape(f"frame {index}", frame.shape, shape)
    if display is not None:
        # Of its own: what the caller changes later has no part in frames that are computed then.
        display = copy.deepcopy(dict(display))
        # Refuses bad keys here instead of on a worker.
        Light([[[0, 0, 0]]]).compose(Cells((1, 1)), **display)
    settings = None if solver is None else solver.settings
    threads = 1 if solver is None else solver.threads
    dtype = np.float32 if display is None else np.uint8
    task = dask.delayed(_frame, pure=False)
    arguments = (shape, settings, threads, display)
    chunks = (da.from_delayed(task(frame, *arguments), (1, height, width, 3), dtype) for frame in frames)
    return da.concatenate(list(chunks))


def light_world(
    source: World | WorldSource | Mapping[str, da.Array],
    *,
    tile: int = 1024,
    solver: Solver | None = None,
    halo: int | None = None,
    columns: int | None = None,
    shape: tuple[int, int] | None = None,
    lamps: list[dict[str, Any]] | None = None,
    sky: Any = None,
    suns: list[dict[str, Any]] | None = None,
) -> da.Array:
    """Lights a world tile by tile, each with the light of all.

    Workers read its parts and, bounce by bounce, what their surfaces send on; one of them makes the far field of that, and
    each tile receives what it needs of it, and of the light of the tiles beside it. With an open number of bounces
    (``"converged"``) one worker finds them all.

    Parameters
    ----------
    source : World, Scene, Map, path, Cells, dict of arrays or callable
        As for `World`; arrays of Dask are read as tasks of their own. Workers open scenes and arrays of ``zarr`` by
        their paths. Arrays in memory travel to all of them, and so do `Cells`: better is a callable that reads a file.
        Of a `World`, the far field is known.
    tile : int, optional
        Side of a tile, px. Larger ones take less time in all, and more memory.
    solver, halo, columns, shape, lamps, sky, suns : optional
        As for `World`; none with one. By default a tile is lit on one thread.

    Returns
    -------
    dask.array.Array of shape (H, W, 3)
        Linear light, float32, a chunk per tile, with the bytes of `World.light_tiles`.

    Raises
    ------
    ValueError
        As `World`, and if ``tile`` is below 1. What is wrong with a cell is found when that is read.
    """
    _check_solver(solver)
    if isinstance(source, World):
        if any(value is not None for value in (solver, halo, columns, shape, lamps, sky, suns)):
            raise ValueError("source is a World, which has its own solver, halo, columns, shape, lamps, sky and suns")
        reader, empty, far = source._reader, source._empty, source._far
    else:
        # It can be called too, but makes another Delayed.
        if isinstance(source, Delayed):
            raise TypeError("source is a Delayed; expected a callable, which workers ask for the Cells of a window")
        if isinstance(source, (str, os.PathLike)):
            source = opened(source)
        if solver is None:
            settings = source.settings if isinstance(source, Scene) else {}
            solver = Solver(threads=1, **settings)
        halo, columns = HALO if halo is None else halo, COLUMNS if columns is None else columns
        reader, empty = prepare(source, solver, halo, columns, shape, lamps, sky, suns)
        far = None
    try:
        tile = operator.index(tile)
    except TypeError:
        raise TypeError(f"tile is {tile!r}; expected a whole number of px") from None
    if tile < 1:
        raise ValueError(f"tile is {tile}; expected 1 or more px")
    world_shape, surrounding, solver, halo, columns, _ = empty.__getnewargs__()
    tiling = Tiling(world_shape, tile, halo)
    windows = tiling.tiles()
    plan = (world_shape, surrounding, solver.settings, solver.threads, halo, columns)
    # A task of its own, so that a worker receives it once.
    shared = dask.delayed(reader, traverse=False, pure=False)

    of_dask = None
    if isinstance(reader, ArrayReader) and any(map(dask.is_dask_collection, reader.arrays.values())):
        of_dask = reader
    cut = dask.delayed(FarWorld.blocks, pure=False)

    def cells(window: Window) -> tuple[Any, ...]:
        """What a task calls for the cells of a window."""
        if of_dask is not None:
            # Sliced here, so that a task depends only on the chunks that it needs.
            return cells_of, of_dask.lamps, window, of_dask.slices(*window)
        return shared, *window

    if far is None:
        read = dask.delayed(_read, pure=False)
        parts = [read(plan, part, *cells(window)) for part, window in empty.parts()]
        far = dask.delayed(_finish, pure=False)(plan, parts)
        bounces = solver.settings["bounces"]
        if isinstance(bounces, int):
            bounce, finish = dask.delayed(_bounce, pure=False), dask.delayed(FarWorld.finished, pure=False)
            for _ in range(bounces):
                parts = [
                    bounce(plan, cut(far, part), part, *cells(empty.around_tile(part))) for part, _ in empty.parts()
                ]
                far = finish(far, parts)
        else:
            if of_dask is not None:
                raise ValueError(
                    "source has arrays of Dask, and the number of bounces is open; "
                    'set the number, as in Solver(bounces=2), or use arrays of "zarr"'
                )
            far = dask.delayed(settled, pure=False)(shared, far)
    else:
        far = dask.delayed(far, traverse=False, pure=False)
    lit, ring, mixed = (dask.delayed(task, pure=False) for task in (_tile, _ring, _mixed))
    rims = {one: tiling.with_rim(one) for one in windows}
    light = {
        one: lit(plan, cut(far, one), one, rims[one], *cells(empty.around_tile(one))) for one in windows
    }
    # Of the tiles around it, no more than their rims go to its worker. One task for each would cost more than the bytes.
    rings = {one: ring(light[one], rims[one], one) for one in windows}
    chunks = []
    for window in windows:
        around = [light[one] if one == window else rings[one] for one, _ in tiling.around(window)]
        chunks.append(da.from_delayed(mixed(tiling, window, around), (*window[2:], 3), np.float32))
    count = -(-empty.shape[1] // tile)
    return da.block([[[chunk] for chunk in chunks[i : i + count]] for i in range(0, len(chunks), count)])


def reference(source: Source, samples: int = 256, *, parts: int = 64, **settings: Any) -> Delayed:
    """Computes the reference of one scene, by cells.

    Parameters
    ----------
    source : Scene, Cells or Delayed
    samples : int, optional
        Paths per cell, rounded up to a multiple of 16.
    parts : int, optional
        The number of tasks. The result has the same bytes for any.
    **settings
        As for `lamplight2d.reference`: ``**scene.settings`` for those of the scene.

    Returns
    -------
    Delayed of Reference
        With the bytes of `lamplight2d.reference`.
    """
    if parts < 1:
        raise ValueError(f"parts is {parts}; expected 1 or more")
    _check_source("source", source)
    settings = copy.deepcopy(settings)
    # Refuses bad settings here instead of on a worker.
    trace_part(Cells((1, 1)), 0, 0, samples, **settings)
    # Cells are a task of their own, so that a worker receives them once.
    shared = source if isinstance(source, Scene) else dask.delayed(source, traverse=False, pure=False)
    trace = dask.delayed(_trace, pure=False)
    traced = [trace(shared, part, parts, samples, settings) for part in range(parts)]
    return dask.delayed(_join, pure=False)(shared, traced, samples, settings)


def sweep(
    scenes: Mapping[str, Source] | Iterable[Source],
    settings: Iterable[Mapping[str, Any]],
    *,
    samples: int = 256,
    parts: int = 16,
) -> Delayed:
    """Measures the error and the time of every scene with all of some settings.

    Parameters
    ----------
    scenes : dict or iterable of Scene, Cells or Delayed
        With their names; without, they are numbered.
    settings : iterable of dict
        Keywords of `Solver`, without ``threads``.
    samples : int, optional
        Paths per cell of the reference, of which there is one per scene and number of bounces.
    parts : int, optional
        The number of tasks of each reference.

    Returns
    -------
    Delayed of list of dict
        A row per scene and settings: ``scene``, the keywords, the errors of `Measures`, and ``seconds``, the time of one
        frame on one thread. Where frames go on from those before, the errors are those of the 32nd frame of ``flood``, of
        the 16th under feedback, and after the frames of ``temporal.history_length``. ``pandas.DataFrame`` takes it as it is.
    """
    if isinstance(scenes, (Scene, Cells, Delayed)):
        raise TypeError(f"scenes is one {type(scenes).__name__}; expected an iterable of them")
    if isinstance(settings, Mapping):
        raise TypeError("settings is one dict; expected an iterable of them")
    named = scenes.items() if isinstance(scenes, Mapping) else enumerate(scenes)
    # Of their own: a caller who changes a table for the next sweep does not change this one.
    own = [_own_case(index, case) for index, case in enumerate(settings)]
    # Settings are checked here, and the bounces of defaults and presets are known.
    cases = [(case, Solver(**case).settings["bounces"]) for case in own]
    measure = dask.delayed(_measure, pure=False)
    rows = []
    for name, source in named:
        _check_source(f"scene {name}", source)
        bounces = {count for _, count in cases}
        truths = {count: reference(source, samples, parts=parts, bounces=count) for count in bounces}
        rows += [measure(name, source, case, truths[count]) for case, count in cases]
    return dask.delayed(list)(rows)


_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
"""Options of glibc's ``mallopt``, from its ``malloc.h``."""


def _keep_memory() -> None:
    """Keeps freed memory in a worker process of Dask's, for the arrays of the next task.

    Dask starts workers with a threshold by which glibc gives every freed array back to the system, and fetches its pages
    anew, one fault each, for the next: a fifth of the time of a frame. Other values of a user's own are left alone.
    """
    if os.environ.get("MALLOC_TRIM_THRESHOLD_") == "65536" and platform.libc_ver()[0] == "glibc":
        glibc = ctypes.CDLL(None)
        glibc.mallopt(_M_TRIM_THRESHOLD, 256 << 20)
        glibc.mallopt(_M_MMAP_THRESHOLD, 32 << 20)


# Workers import this module with their first task.
_keep_memory()

_kept = threading.local()


def _solver(settings: dict[str, Any], threads: int | None) -> Solver:
    """The solver of this thread of a worker, which keeps its buffers from task to task."""
    key = (settings, threads)
    if getattr(_kept, "key", None) != key:
        _kept.key, _kept.solver = key, Solver(threads=threads, **settings)
    # What a frame looks like must not depend on which were here before.
    _kept.solver.reset()
    return _kept.solver


def _cells(source: Scene | Cells) -> Cells:
    return source.cells() if isinstance(source, Scene) else source


def _check_source(name: str, source: Source) -> None:
    if not isinstance(source, (Scene, Cells, Delayed)):
        raise TypeError(f"{name} is a {type(source).__name__}; expected a Scene, Cells or a Delayed")


def _check_solver(solver: Solver | None) -> None:
    if not isinstance(solver, (Solver, type(None))):
        raise TypeError(f"solver is a {type(solver).__name__}; expected a Solver, as Solver(bounces=1) is")


def _own_case(index: int, case: Mapping[str, Any]) -> dict[str, Any]:
    if not isinstance(case, Mapping):
        raise TypeError(f"settings {index} is a {type(case).__name__}; expected a dict, as {{'bounces': 1}} is")
    if "threads" in case:
        raise ValueError(f"settings {index} has threads; expected none, because every frame is timed on one thread")
    return copy.deepcopy(dict(case))


def _rows_and_columns(shape: Any) -> tuple[int, int]:
    try:
        height, width = map(operator.index, shape)
    except (TypeError, ValueError):
        # No sequence, of another length, or not of whole numbers.
        height = width = 0
    if height < 1 or width < 1:
        raise ValueError(f"shape is {shape!r}; expected two whole numbers, rows and columns")
    return height, width


def _check_shape(name: str, found: tuple[int, int], expected: tuple[int, int]) -> None:
    if tuple(found) != tuple(expected):
        raise ValueError(f"{name} has the shape {tuple(found)}; expected {tuple(expected)}")


def _frame(
    source: Scene | Cells,
    shape: tuple[int, int],
    settings: dict[str, Any] | None,
    threads: int | None,
    display: Mapping[str, Any] | None,
) -> np.ndarray:
    _check_source("a frame", source)
    cells = _cells(source)
    _check_shape("a frame", cells.shape, shape)
    own_settings, own_display = (source.settings, source.display) if isinstance(source, Scene) else ({}, {})
    solver = _solver(own_settings if settings is None else settings, threads)
    if display is None:
        return solver.solve(cells, out=np.empty((*shape, 3), np.float32))[None]
    return solver.solve(cells).compose(cells, **{**own_display, **display})[None]


_Plan = tuple[tuple[int, int], Cells, dict[str, Any], Union[int, None], int, int]
"""The shape of a world, cells with its sky and suns, and its settings: the solver's, its threads, halo and columns."""


def _far_world(plan: _Plan) -> FarWorld:
    # Dask keeps the arguments of tasks, so that a solver among them would keep its threads and their memory.
    shape, around, settings, threads, halo, columns = plan
    return FarWorld(shape, around, _solver(settings, threads), halo, columns)


def _read(plan: _Plan, part: Window, reader: Callable[..., Cells], *arguments: Any) -> bytes:
    return _far_world(plan).read(part, reader(*arguments))


def _finish(plan: _Plan, parts: list[bytes]) -> FarWorld:
    # All tiles wait for it, so it may use all cores.
    shape, around, settings, _, halo, columns = plan
    return _far_world((shape, around, settings, None, halo, columns)).finished(parts)


def _bounce(plan: _Plan, blocks: bytes, part: Window, reader: Callable[..., Cells], *arguments: Any) -> bytes:
    return _far_world(plan).with_blocks(blocks).bounce(part, reader(*arguments))


def _tile(
    plan: _Plan, blocks: bytes, tile: Window, rim: Window, reader: Callable[..., Cells], *arguments: Any
) -> np.ndarray:
    return _far_world(plan).with_blocks(blocks).light(tile, reader(*arguments), rim).rgb


def _part(light: np.ndarray, window: Window, part: Window) -> np.ndarray:
    """The light of a part of a window."""
    y, x = part[0] - window[0], part[1] - window[1]
    return light[y : y + part[2], x : x + part[3]]


_Ring = list[tuple[Window, np.ndarray]]
"""Light around a tile, in strips above, below, to the left and to the right of it."""


def _ring(light: np.ndarray, rim: Window, tile: Window) -> _Ring:
    """The light of a rim beyond its tile."""
    (top, left, height, width), (y, x, rows, columns) = rim, tile
    below, beside = y + rows, x + columns
    strips = [
        (top, left, y - top, width),
        (below, left, top + height - below, width),
        (y, left, rows, x - left),
        (y, beside, rows, left + width - beside),
    ]
    # Arrays of their own: views would keep the whole in memory.
    return [(strip, _part(light, rim, strip).copy()) for strip in strips if strip[2] and strip[3]]


def _holds(window: Window, part: Window) -> bool:
    """Whether a part lies in a window."""
    return all(window[i] <= part[i] and part[i] + part[i + 2] <= window[i] + window[i + 2] for i in (0, 1))


def _mixed(tiling: Tiling, tile: Window, around: list[np.ndarray | _Ring]) -> np.ndarray:
    lights = []
    for (one, part), light in zip(tiling.around(tile), around):
        if isinstance(light, list):
            # Of the strips only one reaches into a tile.
            light = next(_part(found, strip, part) for strip, found in light if _holds(strip, part))
            lights.append((one, part, Light(light)))
        else:
            lights.append((one, tiling.with_rim(one), Light(light)))
    return tiling.mixed(tile, lights).rgb


def _trace(source: Scene | Cells, part: int, parts: int, samples: int, settings: dict[str, Any]) -> np.ndarray:
    cells = _cells(source)
    height, width = cells.shape
    first, end = (height * width * k // parts for k in (part, part + 1))
    return trace_part(cells, first, end - first, samples, **settings)


def _join(source: Scene | Cells, parts: list[np.ndarray], samples: int, settings: dict[str, Any]) -> Reference:
    return join_parts(_cells(source), np.concatenate(parts), samples, **settings)


def _frames(settings: dict[str, Any]) -> int:
    """The frames after which light is measured, as by the command: where each goes on from the one before, several."""
    if settings["method"] == "flood":
        return 32
    history = settings.get("temporal", {}).get("history_length", 0)
    return max(1, history, 16 if settings["bounces"] == "feedback" else 1)


def _measure(name: Any, source: Scene | Cells, settings: dict[str, Any], truth: Reference) -> dict[str, Any]:
    cells, solver = _cells(source), _solver(settings, 1)
    # The first frame makes buffers, which takes longer.
    light, frames = solver.solve(cells), _frames(solver.settings)
    if frames == 1:
        solver.reset()
    times = []
    for _ in range(max(1, frames - 1)):
        start = time.perf_counter()
        light = solver.solve(cells)
        times.append(time.perf_counter() - start)
    seconds = statistics.median(times)
    errors = compare(light, truth.light)
    measures = {key: getattr(errors, key) for key in ("relative_rmse", "bias", "median", "p99", "mean")}
    return {"scene": name, **settings, **measures, "seconds": seconds}
