#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests, all but those that take long. Arguments go to ctest, which then
# chooses among all of them: tests/run.sh -L unit
#
# tests/run.sh --stage NAME [CTEST ARGUMENT]... runs one of the further stages instead:
#   slow       the tests that take long: every combination of what a pass can be, whole lists against Embree
#   long       days in the window: by hand
#   format     every C++ file stands as .clang-format has it
#   sanitize   the tests that need no GL, under the address and undefined-behaviour sanitizers
#   sanitize_gl  all others but those that take long, under the same: by hand. With --stage sanitize_gl -R REGEX, any of them
#   fuzz       what reads files, by libFuzzer under both sanitizers: --stage fuzz [SECONDS [TARGET]...], 10 s a target
#   strict     every file by itself, without precompiled headers, also for names that hide others: it must include what it uses;
#              in the folders that are named, or in all
#   tidy       clang-tidy over framework/ and passes/, by .clang-tidy
#   all        the tests and every stage
#
# tests/run.sh --driver zink [CTEST ARGUMENT]... runs the GL tests on OpenGL over Vulkan (lavapipe), where both are installed.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
stage=tests
if [ "${1:-}" = --stage ]; then
    stage=${2:?--stage needs a name}
    shift 2
fi
driver=
if [ "${1:-}" = --driver ]; then
    driver=${2:?--driver needs a name: zink}
    [ "$driver" = zink ] || { echo "tests/run.sh: there is no driver '$driver': zink" >&2; exit 2; }
    shift 2
fi
# Half of the time of all tests; the graphs' own tests go through the same passes.
slow='ABuffer(Lists|Rays|Hits|Primitives|Construction|Limits|Layers)\.|ShippedErrors\.NoGraph'
slow+='|ShippedShaders\.CompileUnderEvery|stress_test\.test_what_is_killed|that_is_killed|Composite\.(Panes|TheHouse|What|More|Surfaces)'
slow+='|Hold/path_trace|LeavingOutTest\.ChangesNoImage/(path_trace|full|transparency|rsm_gather)|Horizons\.WithLayersTheTower'
slow+='|DistanceFields\.EveryVariant|ShippedMemory'
# Eight minutes of processor time: ten thousand actions in the window, undone to the byte; ten thousand edits, and what they leave in memory.
long='Editor(Monkey|Endurance)\.TenThousand'
sources() { git -C "$root" ls-files '*.cpp' '*.h' | grep -v '^shaders/'; }

# build FOLDER CMAKE_ARGUMENT... [-- TARGET...]: the build of a stage beside the usual one.
build() {
    local folder=$1
    shift
    local arguments=() targets=()
    while [ $# -gt 0 ] && [ "$1" != -- ]; do arguments+=("$1") && shift; done
    [ $# -gt 0 ] && shift && targets=(--target "$@")
    "$root/apps/install.sh" test
    cmake -S "$root" -B "$folder" -G Ninja -DKESTREL_TESTS=ON "${arguments[@]}" >/dev/null
    cmake --build "$folder" "${targets[@]}"
}

# Mesa's own cache of compiled shaders makes the second run of a test start fifty times faster.
run() {
    local folder=$1
    shift
    export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-$folder/shader-cache}
    mkdir -p "$MESA_SHADER_CACHE_DIR"
    ctest --test-dir "$folder" --output-on-failure -j "$(nproc)" "$@"
}

case "$stage" in
tests | slow | long)
    export KESTREL_BUILD=${KESTREL_BUILD:-$root/build}
    "$root/apps/build.sh" test
    if [ -n "$driver" ]; then
        # With values of uniforms compiled in, zink of Mesa 25.0 runs shaders with older ones; which of both is not part of
        # its cache's key, so that it has a folder of its own.
        export LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=zink ZINK_INLINE_UNIFORMS=0
        export MESA_SHADER_CACHE_DIR=$KESTREL_BUILD/shader-cache-zink
        renderer=$("$KESTREL_BUILD/bin/kestrel" --version --gl | sed -n 's/^  "renderer": "\(.*\)",$/\1/p' || true)
        [[ $renderer == zink* ]] || { echo "tests/run.sh: no zink over lavapipe here: install mesa-vulkan-drivers" >&2; exit 3; }
        echo "On $renderer"
        mkdir -p "$MESA_SHADER_CACHE_DIR"
        # OSMesa draws by itself, whatever the driver, and crashes in Mesa 25 with zink, which also keeps more memory.
        run "$KESTREL_BUILD" -L '^(gl|stability)$' -E "[Oo]s[Mm]esa|ADaysEditsLeaveMemoryFlat|$slow|$long" "$@"
    elif [ "$stage" != tests ]; then
        run "$KESTREL_BUILD" -R "${!stage}" "$@"
    elif [ $# -gt 0 ]; then
        run "$KESTREL_BUILD" "$@"
    else
        run "$KESTREL_BUILD" -E "$slow|$long"
    fi
    ;;
format)
    "$root/apps/install.sh" stage
    cd "$root"
    sources | xargs clang-format --dry-run -Werror
    echo "$(sources | wc -l) files stand as .clang-format has them"
    ;;
sanitize)
    # What needs no GL: one program a folder of the framework, and what editing does to a graph. The packaged libraries are not instrumented.
    tests=(core image scene reference shader graph draw execute measure editor)
    build "$root/build-sanitize" -DKESTREL_CONFIG=sanitize -DKESTREL_UNITY=ON -DKESTREL_PCH=ON -- "${tests[@]/#/test_}"
    # One after the other on each core; what a program says is told if it fails.
    check() {
        local said
        said=$("$@" --gtest_brief=1 2>&1) || { printf '%s\n' "$said" && return 1; }
        printf '%s: %s\n' "$(basename "$1")" "$(grep -a '^\[  PASSED' <<<"$said")"
    }
    export -f check
    export UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$root/tests/sanitize.supp:print_suppressions=0
    printf '%s\0' "${tests[@]/#/$root/build-sanitize/bin/test_}" |
        xargs -0 -P "$(nproc)" -I PROGRAM bash -c 'check "$@"' check PROGRAM "$@"
    ;;
sanitize_gl)
    build "$root/build-sanitize" -DKESTREL_CONFIG=sanitize -DKESTREL_UNITY=ON -DKESTREL_PCH=ON
    export UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$root/tests/sanitize.supp:print_suppressions=0
    # AddressSanitizer keeps back what is freed, which looks like growth.
    [ $# -gt 0 ] || set -- -LE unit -E "$slow|$long|ADaysEditsLeaveMemoryFlat"
    # LeakSanitizer at times falls over a thread of the driver that is just ending: such a test is run again.
    run "$root/build-sanitize" --timeout 1200 --repeat until-pass:2 "$@"
    ;;
fuzz)
    "$root/apps/install.sh" stage
    build "$root/build-fuzz" -DKESTREL_CONFIG=fuzz -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
        "-DKESTREL_FOLDERS=core;image;scene;shader;graph" -DKESTREL_UNITY=ON -DKESTREL_PCH=ON -- fuzz
    "$root/tests/fuzz/fuzz.sh" "$root/build-fuzz" "$@"
    ;;
strict)
    build "$root/build-strict" -DKESTREL_UNITY=OFF -DKESTREL_PCH=OFF -- kestrel_stamp kestrel_glad
    python3 "$root/tests/strict.py" "$root/build-strict/compile_commands.json" "$@"
    ;;
tidy)
    # In the groups of a unity build: the headers, which are most of the work, are read once a group.
    "$root/apps/install.sh" stage
    build "$root/build-tidy" -DKESTREL_UNITY=ON -DKESTREL_PCH=OFF -- kestrel_stamp kestrel_glad
    find "$root/build-tidy/framework" "$root/build-tidy/passes" -path '*/Unity/*.cxx' -print0 |
        xargs -0 -P "$(nproc)" -n 1 clang-tidy --quiet -p "$root/build-tidy" --checks=-bugprone-suspicious-include \
            --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument
    ;;
all)
    "$0"
    for each in slow long format tidy strict sanitize fuzz; do
        echo "== $each"
        "$0" --stage "$each"
    done
    ;;
*)
    echo "tests/run.sh: there is no stage '$stage': slow, long, format, tidy, strict, sanitize, fuzz, all" >&2
    exit 2
    ;;
esac
