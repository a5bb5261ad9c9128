#!/usr/bin/env bash
# Installs what is missing and builds into build/ (or $KESTREL_BUILD). Usage: apps/build.sh [test | demo] [CMAKE ARGUMENT]...;
# `demo` builds what apps/demo.sh runs: the command line without what makes many pictures, and the plugins of its graphs.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${KESTREL_BUILD:-$root/build}
tests=OFF target=all passes= studies=ON
if [ "${1:-}" = demo ]; then
    shift
    target=kestrel_app
    passes='ambient_occlusion;bvh;filter;gbuffer;occupancy;reference'
    studies=OFF
fi
if [ "${1:-}" = test ]; then
    tests=ON
    shift
    "$root/apps/install.sh" test
else
    "$root/apps/install.sh"
fi
# What a build has stays: the demo must not throw away what another command built.
has() { grep -q "^$1\$" "$build/CMakeCache.txt" 2>/dev/null; }
has KESTREL_TESTS:BOOL=ON && tests=ON
has KESTREL_PASSES:STRING= && passes= studies=ON
cmake -S "$root" -B "$build" -G Ninja -DKESTREL_UNITY=ON -DKESTREL_PCH=ON -DKESTREL_TESTS=$tests "-DKESTREL_PASSES=$passes" -DKESTREL_STUDIES=$studies "$@" >"$build.log" 2>&1 ||
    { cat "$build.log" >&2; exit 2; }
grep -- '-- Left out' "$build.log" || true
rm -f "$build.log"
cmake --build "$build" --target $target
