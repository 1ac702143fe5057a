"""Measures what a world costs on many workers, and writes the tables of a page: ``python scale.py ../../../docs/scale.md``.

Costs of parts and tiles are those of one thread, by the processor's time, which other programs hardly change. Tiles are
lit by a bare loop and by Dask in turns. What larger worlds and more machines take follows by the formulas of the page.
"""

import argparse
import math
import multiprocessing
import pathlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from distributed import Client, LocalCluster

import lamplight2d as ll
import lamplight2d.dask

SIDE, TILE, LARGE_TILE, PART = 1536, 512, 1024, 512
WORKERS = [1, 2, 4, 8]
SOLVER = ll.Solver(threads=1)
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


def finished(empty: Any, parts: list[bytes]) -> tuple[Any, float, int]:
    """The far field, the seconds that merging and bounces took, and the bytes that memory grew by; in a process of its own."""
    before = most_memory()
    far, seconds = timed(lambda: empty.finished(parts))
    return far, seconds, most_memory() - before


def costs() -> tuple[ll.World, dict[str, float]]:
    """The costs of each step, for the formulas."""
    found: dict[str, float] = {}
    known = ll.World(world, shape=(SIDE, SIDE), solver=SOLVER)
    empty = known._empty
    parts, times = [], []
    for part, window in empty.parts():
        cells = world(*window)
        read, seconds = timed(lambda: empty.read(part, cells))
        parts.append(read)
        times.append(seconds)
    found["read"] = mean(times)
    found["part"] = mean([len(part) for part in parts])
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        far, seconds, memory = pool.apply(finished, (empty, parts))
    found["finish"], found["memory"] = seconds / len(parts), memory / len(parts)
    for tile in (TILE, LARGE_TILE):
        cut_times, sizes, times = [], [], []
        for window in known.tiles(tile):
            if window[2:] != (tile, tile):
                continue
            blocks, seconds = timed(lambda: far.blocks(window))
            cut_times.append(seconds)
            sizes.append(len(blocks))
            cells = world(*far.around_tile(window))
            times.append(timed(lambda: empty.with_blocks(blocks).light(window, cells))[1])
        found |= {f"cut {tile}": mean(cut_times), f"blocks {tile}": mean(sizes), f"light {tile}": mean(times)}
    matter = world(0, 0, SIDE, SIDE).opacity
    found["matter"] = float(matter.mean())
    return known, found


def loop(known: ll.World) -> np.ndarray:
    light = np.empty((*known.shape, 3), np.float32)
    for y, x, height, width in known.tiles(TILE):
        light[y : y + height, x : x + width] = known.light(y, x, height, width).rgb
    return light


def on_workers(known: ll.World) -> list[list[str]]:
    """A row per number of workers: the tiles on them, after the same tiles in a bare loop."""
    rows = []
    tiles = len(known.tiles(TILE))
    for count in WORKERS:
        with (
            LocalCluster(n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            lit = ll.dask.light_world(known, tile=TILE)
            # The first one makes buffers and imports modules.
            lit[: 2 * TILE].compute()
            start = time.perf_counter()
            expected, alone = timed(lambda: loop(known))
            clock_alone = time.perf_counter() - start
            before = sum(client.run(time.process_time).values())
            start = time.perf_counter()
            found, here = timed(lit.compute)
            clock = time.perf_counter() - start
            there = sum(client.run(time.process_time).values()) - before
            memory = max(client.run(most_memory).values())
        assert np.array_equal(found, expected), count
        more = 100 * (there / alone - 1)
        print(".", end="", flush=True)
        rows.append(
            [str(count), f"{clock_alone:.1f} s", f"{clock:.1f} s", f"{alone / tiles:.2f} s", f"{there / tiles:.2f} s"]
            + [f"{more:+.0f} %", f"{1000 * here / tiles:.0f} ms", size(memory)]
        )
    return rows


def size(count: float) -> str:
    """A number of bytes in words."""
    for unit in ["bytes", "kB", "MB", "GB", "TB"]:
        if count < 1000 or unit == "TB":
            return f"{count:.3g} {unit}" if count < 1000 else f"{count:.0f} {unit}"
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


RING = 260 * (96**2 - 48**2)
"""The most bytes of a level that a tile receives: of a ring of 24 blocks around 48, all with matter."""


def extrapolated(found: dict[str, float]) -> list[list[str]]:
    """A row per quantity, for the library's largest world and for the one to come."""
    rows: dict[str, list[str]] = {}

    def add(name: str, text: str) -> None:
        rows.setdefault(name, [name]).append(text)

    for side in (LIMIT, GOAL):
        parts, tiles, workers = side**2 / PART**2, side**2 / LARGE_TILE**2, MACHINES * CORES
        cut = found[f"blocks {LARGE_TILE}"]
        blocks = cut + RING * (levels(side) - levels(SIDE))
        add("parts of 512², tiles of 1024²", f"{parts:,.0f}, {tiles:,.0f}")
        add("reading, all workers", duration(found["read"] * parts / workers))
        add("parts to the one that merges", size(found["part"] * parts))
        add("merging and bounces, on one core", duration(found["finish"] * parts))
        add("memory of the far field, on one machine", size(found["memory"] * parts))
        add("blocks to a tile, at most", size(blocks))
        add("blocks to the tiles, in all", size(blocks * tiles))
        add("cutting them out, on one core", duration(found[f"cut {LARGE_TILE}"] * blocks / cut * tiles))
        add("tiles, all workers", duration(found[f"light {LARGE_TILE}"] * tiles / workers))
        add("light, 12 bytes a cell", size(12 * side**2))
    return list(rows.values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=pathlib.Path, nargs="?", help="the page whose tables are replaced")
    page = parser.parse_args().page
    known, found = costs()
    steps = [
        ["reading a part of 512×512 cells", f"{found['read']:.2f} s", size(found["part"])],
        ["merging and bounces, per part", f"{found['finish']:.3f} s", f"{size(found['memory'])} of memory"],
    ]
    for tile in (TILE, LARGE_TILE):
        steps += [
            [f"cutting out the blocks of a tile of {tile}×{tile}", f"{found[f'cut {tile}']:.4f} s"]
            + [size(found[f"blocks {tile}"])],
            ["lighting it", f"{found[f'light {tile}']:.2f} s", size(12 * tile**2)],
        ]
    head = ["workers", "loop, clock", "Dask, clock", "loop, per tile", "Dask, per tile", "more", "scheduler, per tile", "memory of a worker"]
    parts = {
        "steps": table(["step", "one core", "result"], steps)
        + f"\n\n{100 * found['matter']:.0f} % of the cells are solid; holographic, two bounces, halo 64, 512 columns.",
        "workers": table(head, on_workers(known)),
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
    main()
