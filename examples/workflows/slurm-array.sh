#!/bin/sh
# Solves one part of a sweep in each task of a Slurm array:
#
#   sbatch --array=1-4 examples/workflows/slurm-array.sh studies/size.ron size 4
#
# When all tasks are done, merge the parts:
#
#   furrow merge size/parts/* --out size
#
# Arguments: sweep file, output folder, number of parts. A failed part can be run alone, as with --array=3, and resumes from its
# finished rows. There is no cache, since an SQLite file must not be on a network file system. FURROW is the program, if it is
# not `furrow` on the PATH.
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
part=${SLURM_ARRAY_TASK_ID:?run this as a task of a Slurm array: sbatch --array=1-$parts}

exec "${FURROW:-furrow}" sweep "$sweep" --shard "$part/$parts" --out "$out/parts/$part" \
    --no-cache --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
