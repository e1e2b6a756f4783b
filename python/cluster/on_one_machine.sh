#!/bin/bash
# All parts of a study on one machine, one a processor, and the study that they make:
#
#   on_one_machine.sh SCENE REPLICATES PARTS [OPTION...]
#
# OPTION: any of `palpate study` that decides a number. REPLICATES is written out, without an exponent. One folder holds one study.
#
# GNU parallel tries a part that was killed three times, and keeps a log by which the same line goes on where it was ended.
# Where there is no GNU parallel, xargs -P does the parts that have no file yet. The README has the line for several machines.
set -euo pipefail

scene=$1 replicates=$2 count=$3
shift 3
parts=${PALPATE_PARTS:-parts}
export RAYON_NUM_THREADS=1
mkdir -p "$parts"

if command -v parallel >/dev/null && parallel --version 2>/dev/null | grep -q GNU; then logged=yes; else logged=no; fi

# A line of bash for every part. palpate that is ended writes what it has, so that a part gets its name when it is whole.
lines() {
    local k name
    for ((k = 0; k < count; k++)); do
        name=$(printf %05d "$k")
        if [ $logged = no ] && [ -e "$parts/part-$name" ]; then continue; fi
        printf '%q ' palpate study "$scene" --replicates "$replicates" --part "$parts/unfinished-$name" --quiet \
            --range "$((replicates * k / count)):$((replicates * (k + 1) / count))" "$@"
        printf '&& mv %q %q\n' "$parts/unfinished-$name" "$parts/part-$name"
    done
}

if [ $logged = yes ]; then
    lines "$@" | parallel --joblog "$parts/joblog" --resume-failed --retries 3 --halt soon,fail=1
else
    lines "$@" | tr '\n' '\0' | xargs -0 -P "$(nproc)" -I{} bash -c '{}'
fi
palpate merge "$parts"/part-*
