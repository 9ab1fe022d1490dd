"""What a division costs from Python beside Rust, and how much of the machine eight Python threads use.

Run with the package installed: ``python python/benches/cost.py``. Rounds alternate and the quickest counts, since what
else a machine does only ever adds.
"""

from __future__ import annotations

import os
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import furrow

CELLS = 40
ROUNDS = 5
REPOSITORY = Path(__file__).resolve().parents[2]


def one_round() -> float:
    """The seconds of dividing every cell, none of them known."""
    memo = furrow.Memo()
    cells = [furrow.Cell(2.5 + 0.05 * k, cue="germline") for k in range(CELLS)]
    start = time.perf_counter()
    for cell in cells:
        cell.divide(memo=memo)
    return time.perf_counter() - start


def in_rust() -> list[float]:
    """The seconds of the same in Rust."""
    command = ["cargo", "bench", "--quiet", "-p", "furrow-python", "--bench", "cost"]
    done = subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True)
    return [float(line) for line in done.stdout.split()]


def threads(count: int) -> tuple[float, float]:
    """Seconds and seconds of all cores when so many Python threads divide cells."""
    memo = furrow.Memo()
    cells = [furrow.Cell(2.5 + 0.01 * k, cue="germline") for k in range(4 * CELLS)]
    start, used = time.perf_counter(), time.process_time()
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda cell: cell.divide(memo=memo), cells))
    return time.perf_counter() - start, time.process_time() - used


def main() -> None:
    """Prints all."""
    in_rust()
    rust: list[float] = []
    python: list[float] = []
    for _ in range(3):
        rust += in_rust()
        python += [one_round() for _ in range(ROUNDS)]
    quickest = min(rust) / CELLS, min(python) / CELLS
    print(f"a division: {1e3 * quickest[0]:.3f} ms in Rust, {1e3 * quickest[1]:.3f} ms from Python")
    print(f"from Python it costs {100 * (quickest[1] / quickest[0] - 1):+.1f} %")
    memo = furrow.Memo()
    cell = furrow.Cell(2.5)
    cell.divide(memo=memo)
    start = time.perf_counter()
    for _ in range(1000):
        cell.divide(memo=memo)
    print(f"a division that is known: {1e3 * (time.perf_counter() - start):.1f} µs")
    wall, used = threads(8)
    cores = os.cpu_count() or 1
    print(f"eight Python threads: {wall:.2f} s, {used:.2f} s of all {cores} cores, {used / wall:.2f} of them at once")
    assert threading.active_count() == 1


if __name__ == "__main__":
    main()
