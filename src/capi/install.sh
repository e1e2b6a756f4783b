#!/bin/sh
# Builds the library and puts it with its headers and CMake package under PREFIX: src/capi/install.sh PREFIX
# --from DIR takes libraries that were built before.
set -eu
prefix=${1:?PREFIX is needed: src/capi/install.sh PREFIX [--from DIR]}
here=$(cd "$(dirname "$0")" && pwd)
if [ "${2:-}" = --from ]; then
    built=${3:?DIR is needed after --from}
else
    (cd "$here/../.." && cargo build --release --locked -p palpate-capi)
    built=${CARGO_TARGET_DIR:-$here/../../target}/release
fi
mkdir -p "$prefix/include" "$prefix/lib/cmake/palpate"
cp "$here/include/palpate.h" "$here/include/palpate.hpp" "$prefix/include"
cp "$here/cmake/palpate-config.cmake" "$prefix/lib/cmake/palpate"
found=no
for library in libpalpate_capi.so libpalpate_capi.a libpalpate_capi.dylib palpate_capi.dll palpate_capi.dll.lib palpate_capi.lib; do
    if [ -e "$built/$library" ]; then
        cp "$built/$library" "$prefix/lib"
        found=yes
    fi
done
if [ $found = no ]; then
    echo "no library in $built" >&2
    exit 1
fi
