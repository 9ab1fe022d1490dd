#!/usr/bin/env python3
"""How the divisions of the sweeps in this folder end, and how long each takes: one process a division, with a time-out.

    python3 studies/robustness/measure.py [--furrow target/release/furrow] [--timeout 60] [--out rows.jsonl] [FILE.ron ...]

Prints a row of a table for each file, of Markdown, and then every reason with how often it is given. Times are those of the
processor, in milliseconds, the start of the program included. `furrow sweep FILE.ron --out DIR` computes the same divisions.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent


# The constants of docs/robustness.md.
PRESET = ["--preset", "gao2026-thresholds"]


def points(furrow, file):
    """The points of a sweep: of divisions that are given no time at all, every row has its values and no outcome."""
    with tempfile.TemporaryDirectory() as folder:
        command = [furrow, "sweep", file, *PRESET, "--set", "t_max=1e-9", "--no-cache", "--quiet", "--out", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(folder, "results.jsonl"), encoding="utf-8") as rows:
            return [json.loads(row) for row in rows]


def options(point):
    """The options of `furrow divide` for a point."""
    out = ["--r0", repr(point["r0"]), "--epsilon", repr(point["epsilon"]), "--xi", repr(point["xi_s"])]
    if "aspect" in point:
        out += ["--set", f"aspect={point['aspect']!r}"]
    if "cue" in point:
        kind, *numbers = point["cue"].split(",")
        names = [number.split("=")[0] for number in numbers]
        given = dict(number.split("=") for number in numbers)
        values = [f"{name}={point.get('cue.' + name, given[name])!r}".replace("'", "") for name in names]
        out += ["--cue", ",".join([kind, *values])]
    return out


def division(furrow, point, timeout, more=()):
    """Outcome, or the reason that there is none; and the processor's time in ms."""
    command = [furrow, "divide", *PRESET, *options(point), *more, "--json", "--no-cache", "--threads", "1"]
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as answer:
        child = subprocess.Popen(command, stdout=answer, stderr=said)
        begun = time.monotonic()
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            used = sum(float(x) for x in cpu_seconds(child.pid))
            if used > timeout or time.monotonic() - begun > 20 * timeout:
                child.kill()
                _, _, usage = os.wait4(child.pid, 0)
                return "timed out", 1e3 * (usage.ru_utime + usage.ru_stime)
            time.sleep(0.004)
        child.returncode = os.waitstatus_to_exitcode(status)
        ms = 1e3 * (usage.ru_utime + usage.ru_stime)
        answer.seek(0)
        said.seek(0)
        if child.returncode == 0:
            return json.load(answer)["outcome"], ms
        text = said.read().decode(errors="replace")
        if child.returncode not in (1, 2) or "panicked" in text:
            return f"PANIC, exit code {child.returncode}: {text}", ms
        return text.removeprefix("furrow: error: ").strip(), ms


def cpu_seconds(pid):
    """Processor time of a process so far; none where the system does not tell."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as stat:
            fields = stat.read().rsplit(")", 1)[1].split()
        return [int(ticks) / os.sysconf("SC_CLK_TCK") for ticks in fields[11:13]]
    except (OSError, IndexError):
        return [0.0]


def kind(reason):
    """A reason without its numbers."""
    reason = re.sub(r"\((?:stalled|the residual|[a-z ]+ after)[^()]*\)", "(...)", reason)
    return re.sub(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", "#", reason)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*")
    parser.add_argument("--furrow", default=str(HERE.parent.parent / "target/release/furrow"))
    parser.add_argument("--timeout", type=float, default=60.0)
    parser.add_argument("--out", help="every division, one a line")
    given = parser.parse_args()
    rows = open(given.out, "w", encoding="utf-8") if given.out else None
    reasons = collections.Counter()
    print("| sweep | divisions | divided | at rest | refused | no outcome | timed out | ms: median | p99 | worst |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for file in given.files or sorted(str(path) for path in HERE.glob("*.ron")):
        counts, times = collections.Counter(), []
        for point in points(given.furrow, file):
            ended, ms = division(given.furrow, point, given.timeout)
            if ended in ("symmetric", "asymmetric"):
                what = "divided"
            elif ended in ("failed", "timed out"):
                what = ended
            else:
                what = "refused" if "must be" in ended else "no outcome"
                reasons[(what, kind(ended))] += 1
            counts[what] += 1
            if what != "refused":
                times.append(ms)
            if rows:
                point.pop("why", None)
                print(json.dumps({"file": pathlib.Path(file).stem, **point, "outcome": ended, "ms": round(ms, 1)}), file=rows, flush=True)
        times.sort()
        place = lambda share: times[min(len(times) - 1, int(share * len(times)))] if times else 0.0
        total = sum(counts.values())
        kinds = ["divided", "failed", "refused", "no outcome", "timed out"]
        cells = [pathlib.Path(file).stem, total, *(counts[k] for k in kinds), *(f"{x:.0f}" for x in (place(0.5), place(0.99), times[-1] if times else 0))]
        print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)
    print()
    for (what, reason), count in reasons.most_common():
        print(f"{count} {what}: {reason}")
    return 1 if any("PANIC" in reason for _, reason in reasons) else 0


if __name__ == "__main__":
    sys.exit(main())
