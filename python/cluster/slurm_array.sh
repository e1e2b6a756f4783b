#!/bin/bash
# One part of a study a task of a Slurm array:
#
#   sbatch --array=0-99 slurm_array.sh SCENE REPLICATES [OPTION...]
#   sbatch --dependency=afterany:JOB --wrap 'palpate merge parts/part-* --json > study.json'
#
# OPTION: any of `palpate study` that decides a number, such as --seed 7 or --degree 3. REPLICATES is written out, without an
# exponent. One folder holds one study.
#
# A task that Slurm starts again writes the same file again. palpate that is ended writes what it has, so that a part gets its
# name when it is whole. palpate merge says which replicates are missing; part-00017 is that of task 17. A task that died for
# good is made up for by
#
#   PALPATE_TASKS=100 sbatch --array=17 slurm_array.sh SCENE REPLICATES [OPTION...]
#
# Every node must have processors of one instruction set, or OPTION be --portable.
#SBATCH --job-name=palpate
#SBATCH --cpus-per-task=1
#SBATCH --requeue
set -euo pipefail

scene=$1
replicates=$2
shift 2
parts=${PALPATE_PARTS:-parts}
if [ -n "${PALPATE_TASKS:-}" ]; then
    tasks=$PALPATE_TASKS task=$SLURM_ARRAY_TASK_ID
else
    tasks=$SLURM_ARRAY_TASK_COUNT task=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN))
fi

export RAYON_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
mkdir -p "$parts"
from=$((replicates * task / tasks))
to=$((replicates * (task + 1) / tasks))
name=$(printf %05d "$task")
palpate study "$scene" --replicates "$replicates" --range "$from:$to" --part "$parts/unfinished-$name" --quiet "$@"
mv "$parts/unfinished-$name" "$parts/part-$name"
