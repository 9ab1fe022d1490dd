"""Writes lifetimes.json: what SciPy says of the shipped lifetimes and volumes. Run with: python make_lifetimes.py > lifetimes.json"""

import csv
import json
import math
from collections import defaultdict
from pathlib import Path

import scipy
from scipy import stats

shipped = Path(__file__).parent.parent.parent / "data"


def rows(name):
    with open(shipped / name) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


founders = ["EMS", "AB", "P0", "P1", "P2", "P3", "P4", "MS", "C", "D", "E"]
named = {"AB": "P0", "EMS": "P1", "MS": "EMS", "C": "P2", "D": "P3"}
partners = {"AB": "P1", "EMS": "P2", "MS": "E", "C": "P3", "D": "P4"}
letters = {"a": "p", "l": "r", "d": "v"}


def founder(cell):
    return next(name for name in founders if cell.startswith(name))


volumes = defaultdict(list)
for row in rows("jankele2021_volumes.csv"):
    volumes[row["cell"]].append(float(row["mean_volume_um3"]))
volumes = {cell: sum(of) / len(of) for cell, of in volumes.items()}
lives = {row["cell"]: (int(row["n"]), float(row["lifetime_min"]), float(row["sd_min"])) for row in rows("jankele2021_lifetimes.csv")}

points = defaultdict(list)
for cell, (_, mean, _) in lives.items():
    if cell in volumes:
        for group in ["all", founder(cell)]:
            points[group].append((math.log(volumes[cell]), math.log(mean)))


def trend(of):
    fit = stats.linregress(*zip(*of))
    return {"n": len(of), "slope": fit.slope, "slope_error": fit.stderr, "intercept": fit.intercept, "r_squared": fit.rvalue**2, "p": fit.pvalue}


sisters, orders = {}, []
for cell in lives:
    if cell in named:
        mother, other = named[cell], partners[cell]
    elif cell not in founders and cell[-1] in letters:
        mother, other = cell[:-1], cell[:-1] + letters[cell[-1]]
    else:
        continue
    if other in lives:
        (n_a, a, sd_a), (n_b, b, sd_b) = lives[cell], lives[other]
        sisters[mother] = {"first": None if a == b else [cell, other][b < a], "p": stats.ttest_ind_from_stats(a, sd_a, n_a, b, sd_b, n_b, equal_var=False).pvalue}
        if a != b and cell in volumes and other in volumes and volumes[cell] != volumes[other]:
            orders.append((a < b) == (volumes[cell] > volumes[other]))

signs = [(3, 5), (0, 4), (60, 95), (95, 95), (1400, 2600)]
print(json.dumps({
    "scipy": scipy.__version__,
    "trends": {group: trend(of) for group, of in points.items() if len(of) > 2},
    "sisters": sisters,
    "by_volume": {"pairs": len(orders), "agree": sum(orders), "p": stats.binomtest(sum(orders), len(orders), 0.5, alternative="greater").pvalue},
    "signs": [{"agree": k, "of": n, "p": stats.binomtest(k, n, 0.5, alternative="greater").pvalue} for k, n in signs],
}, indent=1))
