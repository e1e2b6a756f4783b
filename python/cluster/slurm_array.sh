#!/bin/bash
# One part of a study a task of a Slurm array:
#
#   sbatch --array=0-99 slurm_array.sh SCENE REPLICATES
#   sbatch --dependency=afterok:JOB --wrap 'palpate merge parts/part-* --json > study.json'
#
# Tasks that Slurm starts again write the same file again. A part stands whole or not at all, and palpate merge says which
# replicates are missing, so that `sbatch --array=17 ...` can make up for a task that was lost (give it the same
# SLURM_ARRAY_TASK_COUNT as PALPATE_TASKS=100). Every node must have processors of one instruction set.
#SBATCH --job-name=palpate
#SBATCH --cpus-per-task=1
#SBATCH --requeue
set -euo pipefail

scene=$1
replicates=$2
parts=${PALPATE_PARTS:-parts}
tasks=${PALPATE_TASKS:-$SLURM_ARRAY_TASK_COUNT}
task=$((SLURM_ARRAY_TASK_ID - ${SLURM_ARRAY_TASK_MIN:-0}))
if [ -n "${PALPATE_TASKS:-}" ]; then task=$SLURM_ARRAY_TASK_ID; fi

export RAYON_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
mkdir -p "$parts"
from=$((replicates * task / tasks))
to=$((replicates * (task + 1) / tasks))
palpate study "$scene" --replicates "$replicates" --range "$from:$to" --part "$parts/part-$(printf %05d "$task")" --quiet
