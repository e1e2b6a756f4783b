#!/bin/bash
# All parts of a study on one machine, or by ssh on several, one a processor:
#
#   on_one_machine.sh SCENE REPLICATES PARTS
#
# The line that does the work, with GNU parallel (--sshloginfile, --retries and --joblog as you like):
#
#   seq 0 99 | parallel palpate study SCENE --replicates N --part parts/part-{} --quiet \
#       --range '$((N * {} / 100)):$((N * ({} + 1) / 100))'
#
# Where there is no GNU parallel, xargs -P does the same on this machine.
set -euo pipefail

export scene=$1 replicates=$2 count=$3 parts=${PALPATE_PARTS:-parts} RAYON_NUM_THREADS=1
mkdir -p "$parts"

one() {
    palpate study "$scene" --replicates "$replicates" --part "$parts/part-$(printf %05d "$1")" --quiet \
        --range "$((replicates * $1 / count)):$((replicates * ($1 + 1) / count))"
}
export -f one

if command -v parallel >/dev/null && parallel --version 2>/dev/null | grep -q GNU; then
    seq 0 $((count - 1)) | parallel --halt now,fail=1 one
else
    seq 0 $((count - 1)) | xargs -P "$(nproc)" -I{} bash -c 'one {}'
fi
palpate merge "$parts"/part-*
