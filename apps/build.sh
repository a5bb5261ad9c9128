#!/usr/bin/env bash
# Installs what is missing and builds into build/ (or $KESTREL_BUILD). Usage: apps/build.sh [test | render] [CMAKE ARGUMENT]...;
# `render` builds what renders a graph, without the editor.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${KESTREL_BUILD:-$root/build}
tests=OFF target=all
[ "${1:-}" = render ] && shift && target=kestrel_app
if [ "${1:-}" = test ]; then
    tests=ON
    shift
    "$root/apps/install.sh" test
else
    "$root/apps/install.sh"
fi
# Tests stay in a build that has them: the demo must not throw away what the test command built.
[ -f "$build/CMakeCache.txt" ] && grep -q '^KESTREL_TESTS:BOOL=ON' "$build/CMakeCache.txt" && tests=ON
cmake -S "$root" -B "$build" -G Ninja -DKESTREL_UNITY=ON -DKESTREL_PCH=ON -DKESTREL_TESTS=$tests "$@" >"$build.log" 2>&1 ||
    { cat "$build.log" >&2; exit 2; }
grep -- '-- Left out' "$build.log" || true
rm -f "$build.log"
cmake --build "$build" --target $target
