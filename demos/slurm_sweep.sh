#!/usr/bin/env bash
#SBATCH --job-name=fingerpad
#SBATCH --array=0-4
#SBATCH --ntasks=1
#SBATCH --mem=2G
#SBATCH --time=01:00:00
# Friction over voltage on a cluster: every voltage is a task of a Slurm array, on one processor each.
#
#   sbatch demos/slurm_sweep.sh [SCENE.toml] [OPTION ...]    from the project's folder; options of fingerpad sweep
#   demos/slurm_sweep.sh [SCENE.toml] [OPTION ...]           afterwards: the table of all voltages, without a run
#
# VOLTAGES="0 100 200" and OUT=DIR in the environment are other voltages, one for each task of --array, and another folder.
# The tasks share a folder and keep each point by its parameters, so that no task waits for another. A task leaves the
# table of its own point; the second command finds all points there, and computes those whose task failed.
set -euo pipefail
voltages=(${VOLTAGES:-0 50 100 150 200})
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    if [ "$SLURM_ARRAY_TASK_ID" -ge "${#voltages[@]}" ]; then
        echo "task $SLURM_ARRAY_TASK_ID has no voltage: VOLTAGES has ${#voltages[@]}; give --array=0-$((${#voltages[@]} - 1))" >&2
        exit 2
    fi
    voltages=("${voltages[$SLURM_ARRAY_TASK_ID]}")
fi
over=$(IFS=,; echo "${voltages[*]}")
environment/run python3 -m fingerpad sweep "$@" --over "voltage=$over" --jobs 1 --out "${OUT:-results/array}"
