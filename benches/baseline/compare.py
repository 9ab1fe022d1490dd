"""Times furrow against the numpy and scipy baselines in one run.

    python compare.py [--furrow PATH] [--repeats 5] [--only CASE]

furrow: wall time of the whole process, one thread, no cache; baseline: time inside
the process, imports not counted (this favours the baseline). Medians; the two sides
take turns, so that a busy machine slows both.
"""

import argparse
import json
import os
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
            ["divide", "--r0", str(r0), "--seed", "0"]
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
            ["steady", "--r0", "2.0", "--xi", str(xi)],
            [("solve_bvp 1e-8", "steady.py", ["--r0", "2.0", "--xi", str(xi)])],
        )
        for xi in (8.6322, 20.7468, 25.8689)
    ],
]


def build():
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    return os.path.join(target, "release", "furrow")


def run(command):
    """(seconds, parsed JSON) or an error message."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    began = time.perf_counter()
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
    except OSError as error:
        return None, str(error)
    seconds = time.perf_counter() - began
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--furrow", help="binary to time (default: built here, in release)")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    a = parser.parse_args()
    furrow = a.furrow or build()
    print("| case | baseline | result | baseline s | furrow result | furrow s | ratio |")
    print("|---|---|---|---|---|---|---|", flush=True)
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
                theirs[i].append(got["seconds"])
                results[i] = got
            seconds, answer = run([furrow, *arguments, "--threads", "1", "--no-cache", "--json"])
            if seconds is not None:
                mine.append(seconds)
        missing += not mine
        for i, (label, _, _) in enumerate(baselines):
            base = statistics.median(theirs[i])
            if mine:
                own = statistics.median(mine)
                cells = f"{value(answer)} | {own:.4f} | {base / own:.1f}"
            else:
                cells = f"not available ({answer}) | | "
            print(f"| {name} | {label} | {value(results[i])} | {base:.3f} | {cells} |", flush=True)
    if missing:
        raise SystemExit(f"furrow gave no answer in {missing} of the cases")


if __name__ == "__main__":
    main()
