"""Measures what Dask adds to a frame: prints the time of a frame in a bare loop and on a worker process, ms.

Both make the same frames of 512×512 cells on one thread, in turns. The processor's time tells what a frame costs a
cluster. The clock's also has the gaps between tasks; it means something only on a machine with idle cores. Of all rounds
the least is printed, to which other programs have added least.
"""

import time
from collections.abc import Callable

import dask
import numpy as np
from distributed import Client, LocalCluster

import lamplight2d as ll
import lamplight2d.dask

SIDE, FRAMES, ROUNDS = 512, 8, 20


def frame(index: int) -> ll.Cells:
    """A lamp that moves among pillars."""
    y, x = np.mgrid[:SIDE, :SIDE]
    opacity = (x % 64 < 8) & (y % 64 < 8)
    albedo = np.full((SIDE, SIDE, 3), 0.5, np.float32)
    lamp = {"position": [200.5 + 10 * index, 230.5], "intensity": 40}
    return ll.Cells((SIDE, SIDE), opacity=opacity, albedo=albedo, lamps=[lamp])


def loop(solver: ll.Solver) -> np.ndarray:
    """The frames without Dask."""
    light = np.empty((FRAMES, SIDE, SIDE, 3), np.float32)
    for index, out in enumerate(light):
        solver.solve(frame(index), out=out)
    return light


def timed(work: Callable[[], object], processor: Callable[[], float]) -> tuple[float, float]:
    """The time of a frame by the processor and by the clock, ms."""
    before, start = processor(), time.perf_counter()
    work()
    clock, after = time.perf_counter() - start, processor()
    return 1000 * (after - before) / FRAMES, 1000 * clock / FRAMES


def main() -> None:
    solver = ll.Solver(threads=1)
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        frames = ll.dask.render_frames([dask.delayed(frame)(i) for i in range(FRAMES)], solver, shape=(SIDE, SIDE))
        [worker] = client.nthreads()

        def of_worker() -> float:
            return client.run(time.process_time)[worker]

        # The first round makes buffers and imports modules.
        assert np.array_equal(loop(solver), frames.compute())
        bare, with_dask = [], []
        for _ in range(ROUNDS):
            bare.append(timed(lambda: loop(solver), time.process_time))
            with_dask.append(timed(frames.compute, of_worker))
        for name, of in [("a processor", 0), ("the clock", 1)]:
            alone, there = (np.array(rounds)[:, of] for rounds in (bare, with_dask))
            more = 100 * (np.median(there / alone) - 1)
            print(f"by {name}: bare loop {alone.min():.1f}, Dask {there.min():.1f}; median of rounds {more:+.1f} %")


if __name__ == "__main__":
    main()
