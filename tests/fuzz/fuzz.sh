#!/usr/bin/env bash
# Runs the fuzz targets that a build folder has: tests/fuzz/fuzz.sh BUILD [SECONDS [TARGET]...]. As many side by side as
# there are processors, SECONDS (10) each. What is found is kept in BUILD/fuzz/found with what was said; what is interesting
# in BUILD/fuzz/corpus, with which the next run begins. Exit status 1: something was found.
set -euo pipefail
build=${1:?usage: tests/fuzz/fuzz.sh BUILD [SECONDS [TARGET]...]}
export seconds=${2:-10} build
shift $(($# < 2 ? $# : 2))
[ $# -gt 0 ] || set -- camera gltf graph image sweep
# A failed allocation is a finding, as more than 2 GiB in all is.
export UBSAN_OPTIONS=print_stacktrace=1
rm -rf "$build/fuzz/seeds" && "$build/bin/fuzz_seeds" "$build/fuzz/seeds"

fuzz() {
    local target=$1 folder=$build/fuzz
    mkdir -p "$folder/corpus/$target" "$folder/found"
    local log=$folder/found/$target.log
    if "$build/bin/fuzz_$target" "$folder/corpus/$target" "$folder/seeds/$target" -max_total_time="$seconds" -seed=1 \
        -max_len=16384 -timeout=10 -rss_limit_mb=2048 -artifact_prefix="$folder/found/$target-" \
        -print_final_stats=1 >"$log" 2>&1; then
        printf '%s: %s inputs\n' "$target" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
        rm "$log"
    else
        tail -n 40 "$log"
        printf '%s: found something; the input and what was said are in %s\n' "$target" "$folder/found"
        return 1
    fi
}
export -f fuzz
printf '%s\0' "$@" | xargs -0 -P "$(nproc)" -I TARGET bash -c 'fuzz TARGET'
