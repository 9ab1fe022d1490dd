"""Writes reference.json: what SciPy says of samples drawn here, and of published tables in a folder.

Run with: python make_reference.py FOLDER > reference.json
The folder holds villoutreix2016_divisions.csv and rodrigues2024_dosage.csv.
"""

import csv
import json
import random
import sys

import numpy as np
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

correlations = []
for n, digits in [(3, 9), (10, 9), (40, 0), (83, 2)]:
    x = draw(n, 2.0, digits)
    y = [round(0.5 * u + random.gauss(0, 1), digits) for u in x]
    test = stats.spearmanr(x, y)
    # Of few pairs all orders are counted.
    counted = stats.permutation_test((x,), lambda x: stats.spearmanr(x, y).statistic, permutation_type="pairings") if n < 10 else test
    correlations.append({"x": x, "y": y, "rho": test.statistic, "p": counted.pvalue})


def regression(x, y):
    """Through the origin by NumPy, with an intercept by SciPy; R² of the first about 0 and about the mean."""
    x, y = np.array(x), np.array(y)
    slope = (x @ y) / (x @ x)
    left = ((y - slope * x) ** 2).sum()
    fit = stats.linregress(x, y)
    return {
        "x": x.tolist(),
        "y": y.tolist(),
        "origin": {
            "slope": slope,
            "slope_error": np.sqrt(left / (len(x) - 1) / (x @ x)),
            "r_squared": 1 - left / (y @ y),
            "r_squared_about_mean": 1 - left / ((y - y.mean()) ** 2).sum(),
        },
        "line": {
            "slope": fit.slope,
            "slope_error": fit.stderr,
            "intercept": fit.intercept,
            "intercept_error": fit.intercept_stderr,
            "r_squared": fit.rvalue**2,
        },
    }


regressions = []
for n in [3, 12, 60]:
    x = [abs(u) for u in draw(n, 0.2, 9)]
    regressions.append(regression(x, [1.151 * u + 0.05 * random.gauss(0, 1) for u in x]))


def table(name):
    with open(f"{sys.argv[1]}/{name}", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def sea_urchin():
    """Macromeres and mesomeres: chi by class of the mother's volume, each class against the next larger one; noise by eighths."""
    rows = [row for row in table("villoutreix2016_divisions.csv") if row["population"] in ("Mac", "Mes")]
    mother, larger, smaller = (np.array([float(row[f"{of}_um3"]) for row in rows]) for of in ("mother", "larger", "smaller"))
    volume, chi = larger + smaller, (larger - smaller) / (larger + smaller)
    found = {"n": len(rows)}
    for name, edges in [("decades", [1e2, 1e3, 1e4, 1e5]), ("classes", [0, 1e3, 2e3, 4e3, 8e3, 16e3, 1e6])]:
        classes = [chi[(volume >= a) & (volume < b)] for a, b in zip(edges, edges[1:])][::-1]
        tests = [stats.mannwhitneyu(small, large, alternative="greater") for large, small in zip(classes, classes[1:])]
        found[name] = {
            "edges": edges,
            "bins": [{"n": len(c), "mean": c.mean(), "sd": c.std(ddof=1)} for c in classes],
            "tests": [{"u": t.statistic, "p": t.pvalue} for t in tests],
        }
    fit = stats.linregress(np.log10(volume), chi)
    # Equal ratios of different volumes differ in their last digit: without rounding they are no ties.
    rank = stats.spearmanr(volume.round(9), chi.round(12))
    found["trend"] = {"slope": fit.slope, "slope_error": fit.stderr, "rho": rank.statistic, "p": rank.pvalue}
    return found


def dose():
    """Asymmetry over the dose of PAR-6, the share read as an area and as a volume."""
    rows = table("rodrigues2024_dosage.csv")
    dose, share = (np.array([float(row[column]) for row in rows]) for column in ("par6_dosage", "larger_share"))
    power, rest = share**1.5, (1 - share) ** 1.5
    rank = stats.spearmanr(dose, share)
    found = {"n": len(rows), "rho": rank.statistic, "p": rank.pvalue}
    for name, chi in [("chi_area", (power - rest) / (power + rest)), ("chi_volume", 2 * share - 1)]:
        fit = stats.linregress(dose, chi)
        found[name] = {
            "mean": chi.mean(),
            "slope": fit.slope,
            "slope_error": fit.stderr,
            "intercept": fit.intercept,
            "intercept_error": fit.intercept_stderr,
            "r_squared": fit.rvalue**2,
        }
    return found


reference = {"scipy": scipy.__version__, "ranks": ranks, "lines": lines, "boxes": boxes}
reference |= {"correlations": correlations, "regressions": regressions, "sea_urchin": sea_urchin(), "dose": dose()}
print(json.dumps(reference, indent=1))
