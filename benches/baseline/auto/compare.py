"""Times AUTO-07p and furrow on one branch of stationary shapes, side by side on one core.

    python compare.py [--rounds 10] [--bench PATH] [--core N]

Half domain, 40 intervals of 3 Gauss points, tolerance 1e-8, R0 = 2.00, eps = 0.87, from the passive shape at xi_s = 0
to the first point past the fold, 69 points; furrow also on 20 intervals of 4 points, where its fold is as close. Builds AUTO's program with AUTO's own makefile in a temporary directory and
furrow's bench with cargo, then lets both take turns. All times are CPU times: of the AUTO process less those of a run
that stops at its first point (start, input, first direction), of furrow's thread inside the process. In brackets:
how many of the iterations factorised.

Needs AUTO-07p and gfortran (Debian: apt-get install auto-07p gfortran); AUTO_DIR if AUTO is not in /usr/lib/auto-07p.
"""

import argparse
import csv
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "../../.."))
AUTO = os.environ.get("AUTO_DIR", "/usr/lib/auto-07p")
REFERENCE = os.path.join(ROOT, "../shared/reference/folds.csv")
MISSING = "{}; on Debian: apt-get install auto-07p gfortran (elsewhere set AUTO_DIR to AUTO's directory)"
POINTS = 69
# Meshes of furrow: AUTO's mesh, one with a fold as accurate as AUTO's, and one with a fold that counts as exact.
SAME, AS_CLOSE, FINE = "40 x 3", "20 x 4", "80 x 5"

EIGHT = {"NDIM": 8, "NBC": 10, "NINT": 0}
SEVEN = {"NDIM": 7, "NBC": 8, "NINT": 1}
DETECTION = {"ILP": 1, "ISP": 2, "NMX": POINTS + 1}  # the located fold is one point more
CHORD = {"NWTN": 1, "ITNW": 30}
# Steps that AUTO chooses itself, up to 8 long: with longer ones it takes as many points.
OWN_STEPS = {"IADS": 1, "DSMAX": 8, "NMX": 200}
VARIANTS = [
    # name, constants of both runs, constants of the timed run
    ("8 equations, differenced derivatives (JAC=0)", EIGHT, {"JAC": 0}),
    ("8 equations, written derivatives (JAC=1)", EIGHT, {}),
    ("8 equations, JAC=1, folds and branch points located", EIGHT, DETECTION),
    ("7 equations and an integral, JAC=0", SEVEN, {"JAC": 0}),
    ("7 equations and an integral, JAC=1", SEVEN, {}),
    ("7 equations and an integral, JAC=1, NWTN=2", SEVEN, {"NWTN": 2}),
    ("7 equations and an integral, JAC=1, NWTN=1", SEVEN, CHORD),
]
# The same with steps that each program chooses.
OWN = [
    ("7 equations and an integral, JAC=1", SEVEN, OWN_STEPS),
    ("7 equations and an integral, JAC=1, NWTN=2", SEVEN, {**OWN_STEPS, "NWTN": 2}),
    ("7 equations and an integral, JAC=1, NWTN=1", SEVEN, {**OWN_STEPS, **CHORD}),
]


def constants(name, changes):
    """The constants file with some constants replaced."""
    with open(os.path.join(HERE, name)) as file:
        text = "".join(line for line in file if not line.startswith("#"))
    for key, value in changes.items():
        text, found = re.subn(rf"\b{key} = [-\w.]+", f"{key} = {value}", text)
        if not found:
            text += f"{key} = {value}\n"
    return text


def child_cpu():
    """CPU seconds, user and system, of all finished children."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def auto(place, text):
    """Runs AUTO once; CPU time in ms."""
    began = child_cpu()
    done = subprocess.run(["./cell.exe"], cwd=place, input=text, text=True, capture_output=True)
    ms = 1e3 * (child_cpu() - began)
    if done.returncode != 0:
        raise SystemExit(f"AUTO ended with {done.returncode}: {(done.stderr or done.stdout).strip()}")
    return ms


def branch_rows(place):
    """Points AUTO wrote: kind, xi_s, L, p."""
    with open(os.path.join(place, "fort.7")) as file:
        rows = [line.split() for line in file]
    rows = [row for row in rows if row and row[0] != "0"]
    return [(int(row[2]), float(row[4]), float(row[-2]), float(row[-1])) for row in rows]


def iterations(place, nwtn):
    """Newton iterations in AUTO's log of a run with IID=2 and, in brackets, those that factorised: the first NWTN."""
    with open(os.path.join(place, "fort.9")) as file:
        rows = [line.split() for line in file]
    # Point, iteration: the prediction is number 0.
    numbers = [int(row[2]) for row in rows if len(row) == 5 and all(field.isdigit() for field in row[:3])]
    return f"{sum(n > 0 for n in numbers)} ({sum(0 < n <= nwtn for n in numbers)})"


def build_auto(place):
    """Builds AUTO's program with AUTO's makefile, user file at -O3; the compiler's command."""
    makefile = os.path.join(AUTO, "cmds", "cmds.make")
    if not os.path.exists(makefile):
        raise SystemExit(MISSING.format(f"AUTO-07p is not installed: there is no {makefile}"))
    for tool in ("gfortran", "make"):
        if shutil.which(tool) is None:
            raise SystemExit(MISSING.format(f"{tool} is not installed, and AUTO needs it"))
    shutil.copy(os.path.join(HERE, "cell.f90"), place)
    command = ["make", "-f", makefile, "cell.exe", "EQUATION_NAME=cell", "OPT=-O3", f"AUTO_DIR={AUTO}"]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True)
    if not os.path.exists(os.path.join(place, "cell.exe")):
        raise SystemExit(f"AUTO's program cannot be built:\n{done.stdout}{done.stderr}")
    compiled = next(line for line in done.stdout.splitlines() if "-c cell.f90" in line)
    return re.sub(r"-ffile-prefix-map=\S+ ", "", compiled)


def prepare_auto(place):
    """Computes the passive shapes and checks every variant; what each one is and what is to be run."""
    out = []
    for name, formulation, changes in VARIANTS + OWN:
        own = (name, formulation, changes) in OWN
        auto(place, constants("c.passive", formulation))
        shutil.move(os.path.join(place, "fort.8"), os.path.join(place, f"s.passive{formulation['NDIM']}"))
        # Type -4: stopped at the value of b asked for.
        if branch_rows(place)[-1][0] != -4:
            raise SystemExit(f"{name}: AUTO did not reach the passive shape")
        run = {**formulation, "s": f"'passive{formulation['NDIM']}'", **changes}
        auto(place, constants("c.branch", {**run, "IID": 2}))
        rows, work = branch_rows(place), iterations(place, run.get("NWTN", 3))
        xi = [row[1] for row in rows if row[0] != 5]
        last_before = max(range(len(xi)), key=xi.__getitem__)
        if own:
            # Ends at the first point past the fold.
            run["NMX"] = next(i for i in range(1, len(xi)) if xi[i] < xi[i - 1]) + 1
            auto(place, constants("c.branch", {**run, "IID": 2}))
            work = iterations(place, run.get("NWTN", 3))
        elif len(xi) != POINTS or last_before != POINTS - 2 or abs(xi[0]) > 1e-12:
            raise SystemExit(f"{name}: AUTO took {len(xi)} points, its largest xi_s is number {last_before + 1}")
        fold = next((row[1:] for row in rows if row[0] == 5), None)
        first = constants("c.branch", {**run, "NMX": 1})
        points = run["NMX"] if own else POINTS
        whole = constants("c.branch", run)
        out.append({"name": name, "own": own, "points": points, "work": work, "fold": fold, "first": first, "all": whole})
    return out


def build_furrow():
    """Builds furrow's bench; its path."""
    command = ["cargo", "bench", "--bench", "steady", "--no-run", "--message-format=json", "--quiet"]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return next(m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "steady")


def furrow(bench):
    """Runs furrow's bench once: for every mesh the line with AUTO's steps, and what is located on the branch."""
    text = subprocess.run([bench, "branch"], capture_output=True, text=True, check=True).stdout
    out = {}
    lines = r"fold, (\d+ x \d+): (\d+) points, (\d+) Newton iterations with (\d+) factorisations, ([\d.]+) ms"
    for mesh, points, work, factored, ms in re.findall(lines, text):
        line = {"points": int(points), "work": f"{work} ({factored})", "ms": float(ms)}
        if abs(line["points"] - POINTS) <= 1:
            out.setdefault(mesh, {}).update(line)
        else:
            out.setdefault(mesh, {})["own"] = line
    for mesh, ms in re.findall(r"(\d+ x \d+): of this the passive shape from nothing: ([\d.]+) ms", text):
        out.setdefault(mesh, {})["passive"] = float(ms)
    for mesh, kind, *values in re.findall(r"(\d+ x \d+): (\w+) at xi_s = ([-\d.]+), L = ([\d.]+), p = ([-\d.]+)", text):
        out[mesh][kind] = [float(value) for value in values]
    if not all("ms" in out.get(mesh, {}) for mesh in (SAME, AS_CLOSE)):
        raise SystemExit(f"furrow took no branch of {POINTS} points, as AUTO does: change the bench's step")
    return out


def reference_fold():
    """xi_s of the fold in the reference table, if there is one."""
    if not os.path.exists(REFERENCE):
        return None
    with open(REFERENCE) as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return next(float(row["xi_fold"]) for row in rows if (float(row["R0"]), float(row["eps"])) == (2.0, 0.87))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--bench", help="furrow's bench executable (default: built here)")
    parser.add_argument("--core", type=int, help="core to run on (default: the last one allowed)")
    a = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"  # with more, AUTO's threads spend most of their time waiting for each other
    place = tempfile.mkdtemp(prefix="furrow-auto-")
    try:
        compiled = build_auto(place)
        bench = a.bench or build_furrow()
        if hasattr(os, "sched_setaffinity"):
            core = max(os.sched_getaffinity(0)) if a.core is None else a.core
            os.sched_setaffinity(0, {core})
        variants = prepare_auto(place)
        mine, theirs = [], [[] for _ in variants]
        for _ in range(a.rounds):
            mine.append(furrow(bench))
            # furrow's bench takes the least of seven runs; so here.
            for times, variant in zip(theirs, variants):
                least = [min(auto(place, variant[key]) for _ in range(7)) for key in ("all", "first")]
                times.append((least[0] - least[1]) / (1 if variant["own"] else POINTS - 1))
    finally:
        shutil.rmtree(place)
    result = mine[-1]
    timed = [SAME, AS_CLOSE]

    def a_point(mesh, passive):
        """ms a point on a mesh in every round, with or without the passive shape."""
        rounds = (taken[mesh] for taken in mine)
        return [(r["ms"] - (0 if passive else r["passive"])) / (r["points"] - 1) for r in rounds]

    print(f"AUTO's user file: {compiled}")
    print("| | points | Newton iterations (factorisations) | ms a point, least | median | AUTO over furrow, least | median |")
    print("|---|---|---|---|---|---|---|")
    for mesh in timed:
        for name, passive in (("pitchfork test included", False), ("with the passive shape from nothing", True)):
            own, taken = a_point(mesh, passive), result[mesh]
            print(
                f"| furrow, {mesh}, {name} | {taken['points']} | {taken['work']} | {min(own):.3f} "
                f"| {statistics.median(own):.3f} | | |"
            )
    for variant, times in zip(variants, theirs):
        if variant["own"]:
            continue
        shown = []
        for mesh in timed:
            own = a_point(mesh, False)
            shown.append((min(times) / min(own), statistics.median(t / o for t, o in zip(times, own))))
        least, median = (" / ".join(f"{pair[k]:.1f}" for pair in shown) for k in (0, 1))
        print(
            f"| AUTO, {variant['name']} | {POINTS} | {variant['work']} | {min(times):.3f} "
            f"| {statistics.median(times):.3f} | {least} | {median} |"
        )
    print(f"ratios: furrow on {' / '.join(timed)}, AUTO on {SAME}")
    print("\nsteps that each program chooses")
    print("| | points | Newton iterations (factorisations) | ms a branch, least | median | AUTO over furrow, median |")
    print("|---|---|---|---|---|---|")
    branches = {mesh: [taken[mesh]["own"]["ms"] - taken[mesh]["passive"] for taken in mine] for mesh in timed}
    for mesh, own in branches.items():
        points, work = result[mesh]["own"]["points"], result[mesh]["own"]["work"]
        print(f"| furrow, {mesh} | {points} | {work} | {min(own):.2f} | {statistics.median(own):.2f} | |")
    for variant, times in zip(variants, theirs):
        if variant["own"]:
            ratios = (statistics.median(t / o for t, o in zip(times, own)) for own in branches.values())
            print(
                f"| AUTO, {variant['name']} | {variant['points']} | {variant['work']} | {min(times):.2f} "
                f"| {statistics.median(times):.2f} | {' / '.join(f'{ratio:.1f}' for ratio in ratios)} |"
            )
    fold = next(variant["fold"] for variant in variants if variant["fold"])
    exact = result[FINE]["fold"]
    for name, values in ((f"AUTO {SAME}", fold), *((f"furrow {mesh}", result[mesh]["fold"]) for mesh in timed)):
        off = ", ".join(f"{n} {x - y:+.1e}" for n, x, y in zip(("xi_s", "L", "p"), values, exact))
        print(f"fold of {name} minus that of furrow {FINE}: {off}")
    expected = reference_fold()
    if expected is None:
        print("no reference table of folds: not compared with it")
    else:
        print(f"xi_s of that fold minus the reference's {expected}, which has five decimals: {exact[0] - expected:+.1e}")
    print(f"furrow's pitchfork on the way, which AUTO does not look for: xi_s = {result[SAME]['pitchfork'][0]:.6f}")


if __name__ == "__main__":
    main()
