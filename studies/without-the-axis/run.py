#!/usr/bin/env python3
"""Which cells divide, how unequally and from which side, if they need not keep their axis: all sweeps of this folder.

    python3 studies/without-the-axis/run.py [--furrow target/release/furrow] [--out FOLDER] [--figure FILE.svg] [NAME ...]

Runs `furrow sweep NAME.ron`, which goes on where it was interrupted, and prints a table of Markdown for each: by size, how many
cells rest, divide equally and divide unequally; χ, the time of pinch-off and the distance of the neck from the axis over R0, each
as the median and the range over seeds. `--figure` needs matplotlib. All sweeps take about two hours of one core.
"""

import argparse
import json
import pathlib
import statistics
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
# Axes of a sweep that tell the rows of its table apart.
ROWS = ("r0", "shell_flattening", "cue")
OUTCOMES = {"failed": "rest", "symmetric": "equal", "asymmetric": "unequal"}


def computed(furrow, name, out):
    """The rows of a sweep."""
    folder = pathlib.Path(out) / name
    command = [furrow, "sweep", str(HERE / f"{name}.ron"), "--out", str(folder), "--quiet"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(folder / "results.jsonl", encoding="utf-8") as rows:
        return [json.loads(row) for row in rows]


def grouped(rows):
    """Rows by the axes that tell them apart, in their order."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[axis] for axis in ROWS if axis in row), []).append(row)
    return groups


def spread(values, digits):
    """The median, and the range if it is wider than the last digit."""
    if not values:
        return ""
    low, middle, high = min(values), statistics.median(values), max(values)
    text = f"{middle:.{digits}f}"
    return text if high - low < 0.6 * 10**-digits else f"{text} [{low:.{digits}f}, {high:.{digits}f}]"


def line(key, rows):
    """A row of the table."""
    divided = [row for row in rows if row.get("chi") is not None]
    counts = [(word, sum(row["outcome"] == outcome for row in rows)) for outcome, word in OUTCOMES.items()]
    fate = ", ".join(f"{count} {word}" for word, count in counts if count) or "not computed"
    offsets = [row["neck_offset"] / row["r0"] for row in divided if "r0" in row and row.get("neck_offset") is not None]
    numbers = [
        spread([row["chi"] for row in divided], 3),
        spread([row["t_end"] for row in divided], 2),
        spread(offsets, 2),
    ]
    return "| " + " | ".join([*map(str, key), fate, *numbers]) + " |"


def table(name, rows):
    """The table of a sweep."""
    groups = grouped(rows)
    axes = [axis for axis in ROWS if axis in rows[0]]
    head = [*axes, "cells", "χ", "t_end", "offset/R0"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join([f"\n## {name}\n", *lines, *(line(key, group) for key, group in groups.items())])


def draw(found, path):
    """χ, offset and time over R0, for weak and strong noise."""
    import matplotlib
    from matplotlib.figure import Figure

    # Letters as text: a small file.
    matplotlib.rcParams["svg.fonttype"] = "none"
    figure = Figure(figsize=(8, 9), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True)
    labels = ("size asymmetry χ", "neck's distance from the axis / R₀", "time of pinch-off (τ)")
    for name, colour, shift in (("weak", "#1f77b4", -0.004), ("strong", "#d95f02", 0.004)):
        rows = [row for row in found.get(name, []) if row.get("chi") is not None]
        size = [row["r0"] * (1 + shift) for row in rows]
        values = ([row["chi"] for row in rows], [row["neck_offset"] / row["r0"] for row in rows], [row["t_end"] for row in rows])
        for panel, value in zip(panels, values):
            panel.plot(size, value, "o", ms=4, alpha=0.6, color=colour, label=f"{name} noise")
    for panel, label in zip(panels, labels):
        panel.set_ylabel(label)
        panel.axvspan(0.95, 1.426, color="0.9", lw=0)
        panel.grid(alpha=0.3)
    panels[0].text(1.01, 0.5, "rest, bent")
    panels[0].legend()
    panels[2].set(yscale="log", xlabel="radius R₀ (L_h)", xscale="log", xlim=(0.95, 5.7))
    panels[2].set_xticks([1, 1.5, 2, 2.5, 3, 4, 5], ["1", "1.5", "2", "2.5", "3", "4", "5"])
    panels[2].minorticks_off()
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--furrow", default="furrow")
    parser.add_argument("--out", default="without-the-axis")
    parser.add_argument("--figure")
    parser.add_argument("names", nargs="*", default=sorted(path.stem for path in HERE.glob("*.ron")))
    args = parser.parse_args()
    found = {}
    for name in args.names:
        found[name] = computed(args.furrow, name, args.out)
        print(table(name, found[name]), flush=True)
    if args.figure:
        draw(found, args.figure)


if __name__ == "__main__":
    main()
