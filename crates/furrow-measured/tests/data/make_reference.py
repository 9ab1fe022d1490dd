"""Writes reference.json: what SciPy says of samples drawn here. Run with: python make_reference.py > reference.json"""

import json
import random

import scipy
from scipy import stats

random.seed(1983)


def draw(n, centre, digits):
    return [round(random.gauss(centre, 1.0), digits) for _ in range(n)]


ranks = []
for n_a, n_b, digits in [(3, 4, 9), (8, 30, 9), (5, 5, 9), (12, 9, 9), (40, 25, 9), (6, 7, 0), (30, 20, 1), (1, 9, 9), (20, 8, 9)]:
    a, b = draw(n_a, 0.4, digits), draw(n_b, 0.0, digits)
    test = stats.mannwhitneyu(a, b, alternative="greater")
    # "auto" counts arrangements where a sample has at most eight values and there are no ties.
    ranks.append({"a": a, "b": b, "u": test.statistic, "p": test.pvalue})

lines = []
for n in [3, 5, 20, 100]:
    x = draw(n, 2.0, 9)
    y = [1.151 * u + 0.1 * random.gauss(0, 1) for u in x]
    fit = stats.linregress(x, y)
    lines.append({"x": x, "y": y, "slope": fit.slope, "intercept": fit.intercept, "slope_error": fit.stderr, "r_squared": fit.rvalue**2})

boxes = []
for n in [1, 2, 7, 30]:
    x = draw(n, 0.0, 9)
    q = stats.mstats.mquantiles(x, [0.25, 0.5, 0.75], alphap=1, betap=1)
    boxes.append({"x": x, "quartiles": list(q), "mean": float(sum(x) / n), "sd": stats.tstd(x) if n > 1 else None})

print(json.dumps({"scipy": scipy.__version__, "ranks": ranks, "lines": lines, "boxes": boxes}, indent=1))
