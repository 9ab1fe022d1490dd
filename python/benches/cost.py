"""What a division costs from Python beside Rust, and how much of the machine eight Python threads use.

Run with the package installed: ``python python/benches/cost.py``. Rounds alternate and the quickest counts, since what
else a machine does only ever adds.
"""

from __future__ import annotations

import os
import subprocess
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import furrow

CELLS = 40
ROUNDS = 5
RADII = [2.5 + 0.01 * k for k in range(4 * CELLS)]
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


def cores_at_once(work: Callable[[], object]) -> float:
    """Seconds of all cores by seconds on the clock."""
    start, used = time.perf_counter(), time.process_time()
    work()
    return (time.process_time() - used) / (time.perf_counter() - start)


def by_python_threads() -> None:
    """Eight Python threads divide cells."""
    memo = furrow.Memo()
    cells = [furrow.Cell(radius, cue="germline") for radius in RADII]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda cell: cell.divide(memo=memo), cells))


def by_own_threads() -> None:
    """Eight threads of furrow divide the same: what else the machine does slows both."""
    furrow.sweep(axes={"r0": RADII}, cue="germline", memo=furrow.Memo(), threads=8, progress=False)


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
    ours, theirs = (max(cores_at_once(work) for _ in range(3)) for work in (by_python_threads, by_own_threads))
    print(f"eight threads use of {os.cpu_count()} cores at once: {ours:.2f} from Python, {theirs:.2f} within furrow")
    assert threading.active_count() == 1


if __name__ == "__main__":
    main()
