"""Measures what a world costs on many workers, and writes the tables of a page: ``python scale.py ../../../docs/scale.md``.

Costs of parts and tiles are those of one thread, by the processor's time, which other programs hardly change. What
Dask takes besides lighting is measured in the same run, as the same loop takes more or less from one run to the next.
What larger worlds and more machines take follows by the formulas of the page.
"""

import argparse
import math
import multiprocessing
import pathlib
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
from typing import Any, NamedTuple

import dask
import numpy as np
from distributed import Client, LocalCluster, wait

import lamplight2d as ll
import lamplight2d.dask
from lamplight2d._core import Tiling
from lamplight2d._world import COLUMNS, HALO, prepare

SIDE, LIT, TILE, PART = 4096, 2048, 512, 1024
"""Of the world whose steps are measured, of the one that workers light, of small tiles, and of parts and large tiles, px."""
WORKERS = [1, 2, 4, 8]
QUIET = {"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s"}
"""Settings of Dask with which idle workers are idle."""
ROUNDS, IDLE = 5, 5
"""Rounds, of which the median counts, and the seconds for which workers are left idle before them."""
SOLVER = ll.Solver(threads=1)
BOUNCES: int = SOLVER.settings["bounces"]
MACHINES, CORES, LIMIT, GOAL = 100, 64, 65_536, 1_000_000
"""The cluster and the worlds of the last table: the library's largest, and the one to come."""


def site(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A number below 2^16 for each site of the world, the same wherever it is asked for."""
    mixed = (y * 73_856_093 ^ x * 19_349_663) & 0xFFFFFFFF
    return (mixed * 2_654_435_761 >> 16) & 0xFFFF


def world(y: int, x: int, height: int, width: int) -> ll.Cells:
    """Any window of an endless world: a block of stone in each square of 64 px, a lamp in each of 256 px."""
    rows, columns = np.ogrid[y : y + height, x : x + width]
    number = site(rows // 64, columns // 64)
    inside = (rows % 64 < 8 + number % 24) & (columns % 64 < 8 + number // 24 % 24)
    top, left = np.mgrid[y // 256 : (y + height) // 256 + 1, x // 256 : (x + width) // 256 + 1]
    lamps = [{"position": [float(256 * j + 50 - x), float(256 * i + 50 - y)]} for i, j in zip(top.flat, left.flat)]
    albedo = np.full((height, width, 3), 0.5, np.float32)
    return ll.Cells((height, width), opacity=inside, albedo=albedo, lamps=lamps)


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """What work returns, and the seconds of the processor that it took."""
    start = time.process_time()
    return work(), time.process_time() - start


def mean(times: list[float]) -> float:
    return sum(times) / len(times)


def most_memory() -> int:
    """The most memory that this process has had, bytes. Only Linux has this file."""
    [line] = (line for line in open("/proc/self/status") if line.startswith("VmHWM:"))
    return 1024 * int(line.split()[1])


def merging(empty: Any, parts: list[bytes]) -> tuple[float, int]:
    """The seconds that merging takes, and the bytes that memory grows by; in a process of its own."""
    # What parts took on their way here is not counted.
    pathlib.Path("/proc/self/clear_refs").write_text("5")
    before = most_memory()
    _, seconds = timed(lambda: empty.finished(parts))
    return seconds, most_memory() - before


def costs() -> dict[str, float]:
    """The costs of each step, for the formulas."""
    found: dict[str, float] = {}
    _, empty = prepare(world, SOLVER, HALO, COLUMNS, (SIDE, SIDE), None, None, None)
    parts, times = [], []
    for part, window in empty.parts():
        cells = world(*window)
        read, seconds = timed(lambda: empty.read(part, cells))
        parts.append(read)
        times.append(seconds)
    found |= {"read": mean(times), "part": mean([len(part) for part in parts])}
    far = empty.finished(parts)
    parts, times = [], []
    for part, _ in empty.parts():
        blocks, cells = far.blocks(part), world(*far.around_tile(part))
        bounced, seconds = timed(lambda: empty.with_blocks(blocks).bounce(part, cells))
        parts.append(bounced)
        times.append(seconds)
    found |= {"bounce": mean(times), "bounced": mean([len(part) for part in parts])}
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        seconds, memory = pool.apply(merging, (empty, parts))
    found |= {"merge": seconds / len(parts), "memory": memory / len(parts)}
    far = empty.finished(parts)
    for tile in (TILE, PART):
        cut_times, sizes, times = [], [], []
        for window in Tiling((SIDE, SIDE), tile, HALO).tiles():
            blocks, seconds = timed(lambda: far.blocks(window))
            cut_times.append(seconds)
            sizes.append(len(blocks))
            cells = world(*far.around_tile(window))
            times.append(timed(lambda: empty.with_blocks(blocks).light(window, cells))[1])
        found |= {f"cut {tile}": mean(cut_times), f"blocks {tile}": mean(sizes), f"light {tile}": mean(times)}
    found["matter"] = float(world(0, 0, LIT, LIT).opacity.mean())
    return found


spent = [0.0, 0.0]
"""What lighting has taken in this process: seconds of the processor, and by the clock."""


@contextmanager
def lighting() -> Iterator[None]:
    before = [time.process_time(), time.perf_counter()]
    yield
    for i, now in enumerate([time.process_time(), time.perf_counter()]):
        spent[i] += now - before[i]


def read(*window: int) -> ll.Cells:
    """Any window of the world, for lighting: a bare loop reads it too."""
    with lighting():
        return world(*window)


class TimedFarWorld:
    """The far world of a task, which notes what its lighting takes."""

    def __init__(self, far: Any) -> None:
        self.far = far

    def with_blocks(self, blocks: bytes) -> "TimedFarWorld":
        return TimedFarWorld(self.far.with_blocks(blocks))

    def light(self, *arguments: Any) -> ll.Light:
        with lighting():
            return self.far.light(*arguments)


def watch() -> None:
    """Has all tasks of this process note what their lighting takes."""
    make = lamplight2d.dask._far_world
    lamplight2d.dask._far_world = lambda plan: TimedFarWorld(make(plan))


def taken() -> list[float]:
    """The seconds of the processor that this process has taken, those of lighting, and lighting's by the clock."""
    return [time.process_time(), *spent]


class Round(NamedTuple):
    """What a round takes, all workers together: seconds by the clock; of the processor, for lighting and in all; of this
    process, which schedules."""

    clock: float
    lighting: float
    workers: float
    here: float

    @property
    def overhead(self) -> float:
        """What workers do besides, as a fraction of lighting."""
        return self.workers / self.lighting - 1


class Measured(NamedTuple):
    """The median round, the fraction of a core that an idle worker takes, and the most memory of a worker, bytes."""

    median: Round
    idle: float
    memory: int


def measured(lit: Any, expected: np.ndarray, count: int, settings: dict[str, Any]) -> Measured:
    """Lights all tiles on so many workers of one thread each, with settings of Dask, time and again."""
    options = {"n_workers": count, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with dask.config.set(settings), LocalCluster(**options) as cluster, Client(cluster) as client:

        def all_taken() -> np.ndarray:
            return np.sum(list(client.run(taken).values()), axis=0)

        client.run(watch)
        # The first round makes buffers and imports modules.
        assert np.array_equal(lit.compute(), expected), count
        before = all_taken()[0]
        time.sleep(IDLE)
        idle = (all_taken()[0] - before) / (IDLE * count)
        rounds = []
        for _ in range(ROUNDS):
            before, clock, here = all_taken(), time.perf_counter(), time.process_time()
            # Workers keep the light, as a loop would.
            kept = lit.persist()
            wait(kept)
            clock, here = time.perf_counter() - clock, time.process_time() - here
            workers, light, light_clock = all_taken() - before
            # What an idle worker takes goes on while one lights.
            rounds.append(Round(clock, light - idle * light_clock, workers, here))
            del kept
        memory = max(client.run(most_memory).values())
    return Measured(sorted(rounds, key=lambda one: one.overhead)[ROUNDS // 2], idle, memory)


def on_workers(known: ll.World) -> tuple[list[list[str]], str]:
    """A row for a bare loop and for each number of workers, and what workers take when idle."""
    expected = np.empty((*known.shape, 3), np.float32)
    tiles = known.tiles(TILE)
    number = len(tiles)
    # Makes buffers.
    known.light(*tiles[0])
    start = time.perf_counter()
    _, seconds = timed(lambda: [known.light(*window) for window in tiles])
    clock = time.perf_counter() - start
    for (y, x, height, width), tile in known.light_tiles(TILE):
        expected[y : y + height, x : x + width] = tile.rgb
    rows = [["a bare loop", f"{clock:.1f} s", f"{seconds / number:.2f} s", "", "", "", "", ""]]
    lit = lamplight2d.dask.light_world(known, tile=TILE)
    idle = []
    for count in WORKERS:
        quiet, plain = (measured(lit, expected, count, settings) for settings in (QUIET, {}))
        print(".", end="", flush=True)
        found = quiet.median
        besides = 1000 * (found.workers - found.lighting) / number
        rows.append(
            [str(count), f"{found.clock:.1f} s", f"{found.lighting / number:.2f} s", f"{besides:.0f} ms"]
            + [f"{100 * one.median.overhead:+.0f} %" for one in (quiet, plain)]
            + [f"{1000 * found.here / number:.0f} ms", size(quiet.memory)]
        )
        idle.append([quiet.idle, plain.idle])
    quietly, plainly = (f"{100 * median(ones):.1f} %" for ones in zip(*idle))
    return rows, f"A worker that has nothing to do takes {quietly} of a core with these settings, and {plainly} without."


def size(count: float) -> str:
    """A number of bytes in words."""
    for unit in ["bytes", "kB", "MB", "GB", "TB"]:
        if count < 999.5 or unit == "TB":
            return f"{count:.3g} {unit}" if count < 999.5 else f"{count:.0f} {unit}"
        count /= 1000
    raise AssertionError


def duration(seconds: float) -> str:
    for unit, length in [("s", 60), ("min", 60), ("h", 48)]:
        if seconds < length:
            return f"{seconds:.2g} {unit}" if seconds < 10 else f"{seconds:.0f} {unit}"
        seconds /= length if unit != "h" else 24
    return f"{seconds:.0f} days"


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def levels(side: int) -> int:
    """The number of levels of a world: of blocks of 4 px, and twice as large until one has at most 24 in a row."""
    return 1 + math.ceil(math.log2(side / 4 / 24))


RING = 670 * (192**2 - 96**2)
"""The most bytes of a level that a tile receives: of a ring of 48 blocks around 96, all with matter and no colour black.
A block travels as its place and those of its 160 colours that are not."""


def extrapolated(found: dict[str, float]) -> list[list[str]]:
    """A row per quantity, for the library's largest world and for the one to come."""
    rows: dict[str, list[str]] = {}
    rim = Tiling((SIDE, SIDE), PART, HALO).rim

    def add(name: str, text: str) -> None:
        rows.setdefault(name, [name]).append(text)

    for side in (LIMIT, GOAL):
        # Tiles are as large as parts, and receive as much as these for each bounce.
        count, workers = side**2 / PART**2, MACHINES * CORES
        cut = found[f"blocks {PART}"]
        blocks = cut + RING * (levels(side) - levels(SIDE))
        handed = (BOUNCES + 1) * count
        add("parts, and tiles, of 1024²", f"{count:,.0f}")
        add("reading, all workers", duration(found["read"] * count / workers))
        add(f"{BOUNCES} bounces, all workers", duration(BOUNCES * found["bounce"] * count / workers))
        add("tiles, all workers", duration(found[f"light {PART}"] * count / workers))
        add("parts to the one that merges, in all", size((found["part"] + BOUNCES * found["bounced"]) * count))
        add(f"merging {BOUNCES + 1} times, on one core", duration((BOUNCES + 1) * found["merge"] * count))
        add("memory of two far fields, on one machine", size(2 * found["memory"] * count))
        add("blocks to a part or a tile, at most", size(blocks))
        add("blocks to all, with those for bounces", size(blocks * handed))
        add("cutting them out, on one core", duration(found[f"cut {PART}"] * blocks / cut * handed))
        add("light of rims, to the tiles beside", size(8 * 4 * rim * (PART + rim) * 12 * count))
        add("light, 12 bytes a cell", size(12 * side**2))
    return list(rows.values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=pathlib.Path, nargs="?", help="the page whose tables are replaced")
    page = parser.parse_args().page
    found = costs()
    known = ll.World(read, shape=(LIT, LIT), solver=SOLVER)
    part = f"a part of {PART}×{PART} cells"
    steps = [
        [f"reading {part}", f"{found['read']:.2f} s", size(found["part"])],
        [f"finding a bounce of {part}", f"{found['bounce']:.2f} s", size(found["bounced"])],
        ["merging a bounce, per part", f"{found['merge']:.3f} s", f"{size(found['memory'])} of memory"],
    ]
    for tile in (TILE, PART):
        steps += [
            [f"cutting out the blocks of a tile of {tile}×{tile}", f"{found[f'cut {tile}']:.4f} s"]
            + [size(found[f"blocks {tile}"])],
            ["lighting it", f"{found[f'light {tile}']:.2f} s", size(12 * tile**2)],
        ]
    head = ["workers", "clock", "lighting, per tile", "besides, per tile"]
    head += ["overhead", "overhead, default settings", "scheduler, per tile", "memory of a worker"]
    rows, idle = on_workers(known)
    parts = {
        "steps": table(["step", "one core", "result"], steps)
        + f"\n\n{100 * found['matter']:.0f} % of the cells are solid; holographic, {BOUNCES} bounces, halo 64, 512 columns.",
        "workers": table(head, rows) + f"\n\n{idle}",
        "worlds": table(
            [f"{MACHINES} machines of {CORES} cores", f"{LIMIT}×{LIMIT}", "10⁶×10⁶"], extrapolated(found)
        ),
    }
    for name, text in parts.items():
        print(f"\n{text}", flush=True)
        if page is not None:
            begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
            before, _, rest = page.read_text().partition(begin)
            _, _, after = rest.partition(end)
            page.write_text(f"{before}{begin}{text}\n{end}{after}")


if __name__ == "__main__":
    # Functions of `__main__` would travel by value, each with sums of its own.
    import scale

    scale.main()
