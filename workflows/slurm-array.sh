#!/bin/sh
# One part of a sweep for each task of a Slurm array:
#
#   sbatch --array=1-4 workflows/slurm-array.sh studies/size.ron size 4
#
# and, once all of them are done, the whole:
#
#   furrow merge size/parts/* --out size
#
# Arguments: the sweep file, the folder of the results, the number of parts. The number is said again, so that a part that
# failed can be run alone, as --array=3. Solved divisions are kept in the folder's `cache`: that part goes on from there.
# FURROW names the program, if it is not `furrow` on the PATH.
#
#SBATCH --job-name=furrow-sweep
#SBATCH --cpus-per-task=1
#SBATCH --mem=1G
#SBATCH --time=02:00:00
#SBATCH --output=furrow-sweep-%A-%a.log
set -eu

if [ $# -ne 3 ]; then
    echo "usage: sbatch --array=1-N $0 SWEEP.ron OUT N" >&2
    exit 2
fi
sweep=$1 out=$2 parts=$3
part=${SLURM_ARRAY_TASK_ID:?this is a task of a Slurm array: sbatch --array=1-$parts}

exec "${FURROW:-furrow}" sweep "$sweep" --shard "$part/$parts" --out "$out/parts/$part" \
    --cache "$out/cache" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
