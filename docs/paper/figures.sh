#!/bin/sh
# Draws the figures of paper.md: `docs/paper/figures.sh`. FURROW names the program, if it is not `furrow` on the PATH. Needs nothing else.
set -eu
cd "$(dirname "$0")"
furrow=${FURROW:-furrow}
mkdir -p figures
"$furrow" --quiet branch --r0 2 --xi-max 30 --no-cache --plot figures/branch.png >/dev/null
"$furrow" --quiet divide --r0 5.4 --cue germline --no-cache --plot figures/division.png >/dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$furrow" --quiet tree --no-cache --out "$work/tree" --plot figures/rounds.png >/dev/null
ls -l figures
