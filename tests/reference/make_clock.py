"""Writes clock.json: the clock that SciPy fits to the shipped lifetimes and volumes. Run with: python make_clock.py > clock.json"""

import csv
import json
from collections import defaultdict
from pathlib import Path

import numpy as np
import scipy
from scipy import stats

shipped = Path(__file__).parent.parent.parent / "crates/furrow-measured/data"


def rows(name):
    with open(shipped / name) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


measured = defaultdict(list)
for row in rows("jankele2021_volumes.csv"):
    measured[row["cell"]].append(float(row["mean_volume_um3"]))
volumes = {cell: np.mean(of) for cell, of in measured.items()}
founders = ["EMS", "AB", "P0", "P1", "P2", "P3", "P4", "MS", "C", "D", "E"]
points = defaultdict(list)
skipped = []
for row in rows("jankele2021_lifetimes.csv"):
    cell = row["cell"]
    if cell not in volumes:
        skipped.append(cell)
        continue
    founder = next(name for name in founders if cell.startswith(name))
    for group in ["all", founder]:
        points[group].append((volumes[cell] / volumes["P0"], float(row["lifetime_min"])))


def law(of):
    volume, lifetime = np.array(of).T
    found = {"n": len(of), "at_volume": stats.gmean(volume), "lifetime_min": stats.gmean(lifetime)}
    if len(of) > 2:
        line = stats.linregress(np.log(volume), np.log(lifetime))
        found |= {"exponent": -line.slope, "se": line.stderr, "r_squared": line.rvalue**2, "p": line.pvalue}
    return found


laws = {group: law(of) for group, of in points.items()}
print(json.dumps({"scipy": scipy.__version__, "first_volume": volumes["P0"], "skipped": len(skipped), "laws": laws}, indent=1))
