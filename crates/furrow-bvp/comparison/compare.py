"""The test problems of Cash and Mazzia by scipy's solve_bvp and by COLNEW, beside furrow-bvp.

    cargo run --release --example cash_mazzia reference.csv
    python comparison/compare.py reference.csv [colnew.f]

COLNEW is left out unless its source is named, with right-hand sides that are called as f(n, x, z, f, rpar, ipar); it needs gcc, gfortran and
BLAS, and has exact derivatives and four collocation points.

Both start from the same line on ten equal intervals. scipy has a tolerance of 1e-6, 20,000 nodes at most, and Jacobians by differences,
which is what it does unless told otherwise. A solution is wrong if it is off by more than 1e-3 (1 + |value|) at any of the places of the
reference. Times are the shortest of several runs.
"""

import csv
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np
from instructions import build
from numpy import cosh, exp, pi, sin, sinh, sqrt
from scipy.integrate import solve_bvp
from scipy.special import erf

NODES = 20_000
RUNS = 3
PLACES = 201
WRONG = 1e-3
cos = np.cos


def second(w):
    """y'' = w(x, y, y')."""
    return lambda x, y: np.vstack([y[1], w(x, y[0], y[1])])


def ends(a, b):
    """y given at both ends."""
    return lambda left, right: np.array([left[0] - a, right[0] - b])


def linear(number, e):
    """Problems 1 to 18: the interval, y'' = w and its values at the ends."""
    c, s = (lambda x: cos(pi * x)), (lambda x: sin(pi * x))
    forced = 1 + e * pi**2
    driven = lambda x, y, d: (y - forced * c(x)) / e
    far = exp(-2 / sqrt(e))
    odd = 1 / (round(1 / e) + 1)
    return {
        1: ((0, 1), lambda x, y, d: y / e, (1, 0)),
        2: ((0, 1), lambda x, y, d: d / e, (1, 0)),
        3: ((-1, 1), lambda x, y, d: (y - (2 + c(x)) * d - forced * c(x) - (2 + c(x)) * pi * s(x)) / e, (-1, -1)),
        4: ((-1, 1), lambda x, y, d: ((1 + e) * y - d) / e, (1 + exp(-2), 1 + exp(-2 * (1 + e) / e))),
        5: ((-1, 1), lambda x, y, d: (y + x * d - forced * c(x) + pi * x * s(x)) / e, (-1, -1)),
        6: ((-1, 1), lambda x, y, d: (-x * d - e * pi**2 * c(x) - pi * x * s(x)) / e, (-2, 0)),
        7: ((-1, 1), lambda x, y, d: (y - x * d - forced * c(x) - pi * x * s(x)) / e, (-1, 1)),
        8: ((0, 1), lambda x, y, d: -d / e, (1, 2)),
        9: ((-1, 1), lambda x, y, d: (-2 * y - 4 * x * d) / (e + x * x), (1 / (1 + e),) * 2),
        10: ((-1, 1), lambda x, y, d: -x * d / e, (0, 2)),
        11: ((-1, 1), driven, (-1, -1)),
        12: ((-1, 1), driven, (-1, 0)),
        13: ((-1, 1), driven, (0, -1)),
        14: ((-1, 1), driven, (far, far)),
        15: ((-1, 1), lambda x, y, d: x * y / e, (1, 1)),
        16: ((0, 1), lambda x, y, d: -((pi / (2 * odd)) ** 2) * y, (0, sin(pi / (2 * odd)))),
        17: ((-0.1, 0.1), lambda x, y, d: -3 * e * y / (e + x * x) ** 2, (-0.1 / sqrt(e + 0.01), 0.1 / sqrt(e + 0.01))),
        18: ((0, 1), lambda x, y, d: -d / e, (1, exp(-1 / e))),
    }[number]


def nonlinear(number, e):
    """Problems 19 to 30, as `linear`."""
    hill = lambda x: 1 + e * (np.logaddexp((x - 0.745) / e, (0.745 - x) / e) - np.log(2))
    decay = lambda x: exp(-x / sqrt(e))
    if number >= 25:
        pair = [(-1 / 3, 1 / 3), (1, -1 / 3), (1, 1 / 3), (1, 1.5), (0, 1.5), (-7 / 6, 1.5)][number - 25]
        return (0, 1), lambda x, y, d: (y - y * d) / e, pair

    def nozzle(x, y, d):
        area, grows = 1 + x * x, 2 * x
        return ((1.2 - e * grows) * y * d - d / y - grows / area * (1 - 0.2 * y * y)) / (e * area * y)

    return {
        19: ((0, 1), lambda x, y, d: (pi / 2 * sin(pi * x / 2) * exp(2 * y) - exp(y) * d) / e, (0, 0)),
        20: ((0, 1), lambda x, y, d: (1 - d * d) / e, (hill(0), hill(1))),
        21: ((0, 1), lambda x, y, d: (y + y * y - decay(2 * x)) / e, (decay(0), decay(1))),
        22: ((0, 1), lambda x, y, d: -(d + y * y) / e, (0, 0.5)),
        23: ((0, 1), lambda x, y, d: sinh(y / e) / e, (0, 1)),
        24: ((0, 1), nozzle, (0.9129, 0.375)),
    }[number]


def system(number, e):
    """Problems 31 to 33: equations, conditions, number of components."""
    if number == 31:

        def rhs(x, y):
            y, angle, m, q = y
            bend = 1 / cos(angle) + e * q * np.tan(angle)
            return np.vstack([sin(angle), m, -q / e, ((y - 1) * cos(angle) - m * bend) / e])

        return rhs, lambda a, b: np.array([a[0], a[2], b[0], b[2]]), 4
    if number == 32:
        rhs = lambda x, y: np.vstack([y[1], y[2], y[3], (y[1] * y[2] - y[0] * y[3]) / e])
        return rhs, lambda a, b: np.array([a[0], a[1], b[0] - 1, b[1]]), 4
    rhs = lambda x, y: np.vstack(
        [y[1], (y[0] * y[3] - y[2] * y[1]) / e, y[3], y[4], y[5], (-y[2] * y[5] - y[0] * y[1]) / e]
    )
    return rhs, lambda a, b: np.array([a[0] + 1, a[2], a[3], b[0] - 1, b[2], b[3]]), 6


def statement(number, e):
    """Equations, conditions and the first guess on its nodes."""
    if number > 30:
        rhs, conditions, count = system(number, e)
        x = np.linspace(0, 1, 11)
        y = np.zeros((count, 11))
        given = {32: (0, 1), 33: (-1, 1)}.get(number, (0, 0))
        y[0] = np.linspace(*given, 11)
        if number != 31:
            y[1] = given[1] - given[0]
        return rhs, conditions, x, y
    (a, b), w, (left, right) = (linear if number <= 18 else nonlinear)(number, e)
    x = np.linspace(a, b, 11)
    slope = (right - left) / (b - a)
    return second(w), ends(left, right), x, np.vstack([left + slope * (x - a), np.full(11, slope)])


def by_scipy(number, e):
    """Seconds and the first component as a function; the message of a failure instead."""
    rhs, conditions, x, y = statement(number, e)
    seconds = []
    for _ in range(RUNS):
        start = time.perf_counter()
        found = solve_bvp(rhs, conditions, x, y, tol=1e-6, max_nodes=NODES)
        seconds.append(time.perf_counter() - start)
        if found.status != 0:
            return found.message
    return min(seconds), found.sol(np.linspace(x[0], x[-1], PLACES))[0]


def by_colnew(folder, source, tolerance):
    """All cases by COLNEW, as `by_scipy`."""
    program = build(folder, source, "native")
    found = {}
    for line in subprocess.run([program, tolerance], check=True, capture_output=True, text=True).stdout.splitlines():
        number, e, flag, _, seconds, values = line.split(",")
        values = np.array(values.split(), dtype=float)
        found[int(number), float(e)] = (float(seconds), values) if flag == "1" else f"flag {flag}"
    return found


def report(name, solve, reference):
    """How many cases are solved, and how long they take beside furrow."""
    solved = wrong = tried = 0
    ratios, errors = [], []
    for number in range(1, 34):
        for e in (1e-1, 1e-2, 1e-3, 1e-4):
            if number == 23 and e < 1e-2:
                continue
            tried += 1
            found, known = solve(number, e), reference.get((number, e))
            if isinstance(found, str):
                print(f"{name}: {number} at {e:.0e}: {found}", file=sys.stderr)
                continue
            seconds, values = found
            off = np.max(np.abs(values - known[1]) / (1 + np.abs(known[1]))) if known else 0.0
            wrong += not off <= WRONG
            solved += 1
            if known:
                ratios.append(seconds / known[0])
                errors.append(off)
    print(f"{name}: solved {solved} of {tried}, wrong {wrong}, median error {statistics.median(errors):.1e}")
    spread = f"{min(ratios):.2f} to {max(ratios):.0f}"
    print(f"  time over that of furrow: median {statistics.median(ratios):.2f} ({spread}, {len(ratios)} cases)")


def main():
    warnings.filterwarnings("ignore")
    np.seterr(all="ignore")
    csv.field_size_limit(10**9)
    reference = {}
    with open(sys.argv[1], newline="") as file:
        for row in csv.DictReader(file):
            key = int(row["problem"]), float(row["epsilon"])
            reference[key] = float(row["seconds"]), np.array(row["values"].split(), dtype=float)
    report("scipy", by_scipy, reference)
    if len(sys.argv) < 3:
        print("COLNEW: left out, since its source is not named")
        return
    with tempfile.TemporaryDirectory() as folder:
        for tolerance in ("1e-6", "1e-8"):
            found = by_colnew(folder, sys.argv[2], tolerance)
            report(f"COLNEW at {tolerance}", lambda number, e: found[number, e], reference)


if __name__ == "__main__":
    main()
