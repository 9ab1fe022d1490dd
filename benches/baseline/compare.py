"""Times furrow against the numpy and scipy baselines in one run.

    python compare.py [--furrow PATH] [--repeats 5] [--only CASE]

furrow: the whole process, one thread, no cache; baseline: inside the process, imports
not counted (this favours the baseline). Medians of wall time and of CPU time (user and
system); the ratio of CPU times holds on a busy machine too. The two sides take turns.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "../.."))
FINE = ["--dt-max", "0.025", "--tol", "0.00125", "--neck-step", "0.02"]
CUE = (0.465, 0.0577, 0.1)

CASES = [
    # name, furrow arguments, [(baseline name, script, arguments)]
    *[
        (
            f"divide R0={r0}" + (" cue" if cue else ""),
            ["divide", "--preset", "gao2026-thresholds", "--r0", str(r0), "--seed", "0"]
            + (["--cue", "kappa:u0=%g,omega=%g,amplitude=%g" % CUE] if cue else []),
            [
                ("backward Euler", "division.py", base),
                ("backward Euler, steps / 4", "division.py", base + FINE),
                ("BDF2", "division.py", base + ["--order", "2"]),
            ],
        )
        for r0, cue in ((2.5, False), (2.0, False), (5.4, True))
        for base in [["--r0", str(r0)] + (["--cue", "%g,%g,%g" % CUE] if cue else [])]
    ],
    *[
        (
            f"steady R0=2.0 xi={xi}",
            ["steady", "--preset", "gao2026-thresholds", "--r0", "2.0", "--xi", str(xi)],
            [("solve_bvp 1e-8", "steady.py", ["--r0", "2.0", "--xi", str(xi)])],
        )
        for xi in (8.6322, 20.7468, 25.8689)
    ],
]


def build():
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    return os.path.join(target, "release", "furrow")


def children_cpu():
    """CPU seconds, user and system, of all finished children."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(command):
    """((wall, CPU) seconds, parsed JSON), or None and an error message."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    began, cpu_began = time.perf_counter(), children_cpu()
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
    except OSError as error:
        return None, str(error)
    seconds = time.perf_counter() - began, children_cpu() - cpu_began
    if done.returncode != 0:
        tail = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return None, f"exit {done.returncode}: {tail}"
    try:
        return seconds, json.loads(done.stdout)
    except json.JSONDecodeError as error:
        return None, f"stdout is not JSON: {error}"


def value(answer):
    """The number that shows both solved the same problem."""
    for key in ("chi", "L"):
        if answer.get(key) is not None:
            return f"{key}={answer[key]:.4f}"
    return answer.get("outcome", "-")


def medians(times):
    """Medians of the wall and of the CPU times."""
    return [statistics.median(column) for column in zip(*times)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--furrow", help="binary to time (default: built here, in release)")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    a = parser.parse_args()
    furrow = a.furrow or build()
    print("| case | baseline | result | wall s | CPU s | furrow result | wall s | CPU s | wall ratio | CPU ratio |")
    print("|---|---|---|---|---|---|---|---|---|---|", flush=True)
    missing = 0
    for name, arguments, baselines in CASES:
        if a.only not in name:
            continue
        mine, theirs = [], [[] for _ in baselines]
        answer, results = None, [None] * len(baselines)
        for _ in range(a.repeats):
            for i, (_, script, options) in enumerate(baselines):
                seconds, got = run([sys.executable, os.path.join(HERE, script), *options])
                if seconds is None:
                    raise SystemExit(f"{script} {' '.join(options)}: {got}")
                theirs[i].append((got["seconds"], got["cpu_seconds"]))
                results[i] = got
            seconds, answer = run([furrow, *arguments, "--threads", "1", "--no-cache", "--json"])
            if seconds is not None:
                mine.append(seconds)
        missing += not mine
        for i, (label, _, _) in enumerate(baselines):
            base = medians(theirs[i])
            if mine:
                own = medians(mine)
                ratios = [f"{b / o:.0f}" if o > 0 else "-" for b, o in zip(base, own)]
                cells = f"{value(answer)} | {own[0]:.4f} | {own[1]:.4f} | {ratios[0]} | {ratios[1]}"
            else:
                cells = f"not available ({answer}) | | | | "
            print(f"| {name} | {label} | {value(results[i])} | {base[0]:.3f} | {base[1]:.3f} | {cells} |", flush=True)
    if missing:
        raise SystemExit(f"furrow gave no answer in {missing} of the cases")


if __name__ == "__main__":
    main()
