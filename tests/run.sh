#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. Arguments go to ctest: tests/run.sh -L unit
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
export KESTREL_BUILD=${KESTREL_BUILD:-$root/build}
"$root/apps/build.sh" test
# Mesa's own cache of compiled shaders makes the second run of a test start fifty times faster.
export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-$KESTREL_BUILD/shader-cache}
mkdir -p "$MESA_SHADER_CACHE_DIR"
exec ctest --test-dir "$KESTREL_BUILD" --output-on-failure -j "$(nproc)" "$@"
