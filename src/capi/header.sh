#!/bin/sh
# Makes include/palpate.h of this crate by cbindgen (cargo install cbindgen). --check: only says whether it is current.
# Whoever builds or uses the library needs no cbindgen.
set -eu
cd "$(dirname "$0")"
made=$(mktemp)
trap 'rm -f "$made"' EXIT
cbindgen --quiet --config cbindgen.toml --output "$made" .
if [ "${1:-}" = --check ]; then
    cmp "$made" include/palpate.h && echo "include/palpate.h is current"
else
    cp "$made" include/palpate.h
fi
