"""Runs every row of the reference division tables and prints the differences.

    python check.py                     # ../shared/reference beside the repository
    python check.py --reference DIR

BDF2 with dt_max = min(0.05, 0.2/R0^2), step tolerance 5e-4 (about one minute).
"""

import argparse
import csv
import os

from division import divide
from model import Cell

import numpy as np

NAMES = {"div": "divided", "fail": "failed"}


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def run(cell, seed):
    result, _ = divide(cell, seed, order=2, dt_max=min(0.05, 0.2 / cell.r0**2), tol=5e-4, neck_step=0.05)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    here = os.path.dirname(os.path.abspath(__file__))
    parser.add_argument("--reference", default=os.path.join(here, "../../../shared/reference"))
    folder = parser.parse_args().reference
    if not os.path.isdir(folder):
        raise SystemExit(f"no reference folder at {folder}: give --reference")
    print("| R0 | eps | cue | seed | outcome | chi | ref | difference | u_furrow | ref | t_end | ref |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|", flush=True)
    wrong = 0
    for name, fixed in (("division_R0.csv", "R0"), ("division_eps.csv", "eps")):
        for row in rows(os.path.join(folder, name)):
            r0 = float(row["R0"]) if fixed == "R0" else 2.22
            epsilon = 0.87 if fixed == "R0" else float(row["eps"])
            found = [run(Cell(r0, epsilon), seed) for seed in (0, 1, 2)]
            for seed, got in enumerate(found):
                wrong += got["outcome"] != NAMES[row["outcome"]]
                if got["outcome"] != "divided":
                    print(f"| {r0} | {epsilon} | none | {seed} | {got['outcome']} (ref {row['outcome']}) | | | | | | | |")
                    continue
                ref = float(row[f"chi_seed{seed}"])
                print(f"| {r0} | {epsilon} | none | {seed} | divided | {got['chi']:.4f} | {ref:.4f} "
                      f"| {got['chi'] - ref:+.4f} | {min(got['u_furrow'], 1 - got['u_furrow']):.4f} | | {got['t_end']:.3f} | |")
            if found[0]["outcome"] == "divided":
                chi = np.array([f["chi"] for f in found])
                u = np.array([min(f["u_furrow"], 1 - f["u_furrow"]) for f in found])
                t = np.array([f["t_end"] for f in found])
                print(f"| {r0} | {epsilon} | none | mean | | {chi.mean():.4f} | {row['chi_mean']} "
                      f"| {chi.mean() - float(row['chi_mean']):+.4f} | {u.mean():.4f} | {row['u_furrow_mean']} "
                      f"| {t.mean():.3f} +- {t.std(ddof=1):.3f} | {row['t_end_mean']} +- {row['t_end_sd']} |", flush=True)
    for row in rows(os.path.join(folder, "division_cue.csv")):
        cue = tuple(float(row[k]) for k in ("u0", "om", "dk"))
        got = run(Cell(float(row["R0"]), float(row["eps"]), cue=cue), 0)
        wrong += got["outcome"] != NAMES[row["outcome"]]
        chi, ref = got.get("chi_signed", np.nan), float(row["chi"])
        print(f"| {row['R0']} | {row['eps']} | u0={cue[0]} omega={cue[1]} | 0 | {got['outcome']} | {chi:.4f} | {ref} "
              f"| {chi - ref:+.4f} | {got.get('u_furrow', np.nan):.4f} | {row['u_furrow']} | {got['t_end']:.3f} "
              f"| {row['t_end']} |", flush=True)
    print(f"\nrows with another outcome than the reference: {wrong}")


if __name__ == "__main__":
    main()
