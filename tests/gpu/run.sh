#!/usr/bin/env bash
# What a machine with a GPU shows, in at most six minutes: pictures against another driver's, GL errors, values that are not
# finite, timer queries against wall clock, and the ratios of the papers. Needs bash, tar, xz and awk besides the bundle.
#   tests/gpu/run.sh BUNDLE [OUT]            BUNDLE: kestrel-VERSION-ARCH.tar.xz of apps/bundle.sh, or its folder; OUT: default gpu-results
#   tests/gpu/run.sh --pictures BUNDLE       makes BUNDLE's pictures on this driver, which lie beside it as NAME-pictures.tar
# Writes OUT/report.md and OUT.tar.xz. Exit status: 0, or 1 if something does not hold.
# Two tolerances: of a picture's mean FLIP and of its MSE against the same on the driver that made the pictures; on that
# driver itself both are 0. On a CPU renderer, sizes and numbers are smaller, and clocks are told, not judged.
set -uo pipefail
flip=0.02 mse=0.001
picture_size=96x54
limit=340 # seconds in all, so that packing ends within six minutes
# Seconds that are kept for the sweeps, which come last: what is slow before them loses its own rest, not theirs.
declare -A kept=([roma_table2]=80 [snap]=40 [sd_path]=40 [abuffer_variants]=50)
left() { # seconds that remain for what is not kept
    local remain=$((limit - SECONDS)) name
    for name in "${!kept[@]}"; do remain=$((remain - kept[$name])); done
    echo $remain
}

making=
[ "${1:-}" = --pictures ] && making=1 && shift
bundle=${1:?tests/gpu/run.sh needs the bundle}
[ -e "$bundle" ] || { echo "tests/gpu/run.sh: there is no $bundle" >&2; exit 2; }
bundle=$(realpath "$bundle")
pictures=${bundle%.tar.xz}-pictures.tar
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
if [ -f "$bundle" ]; then
    tar -C "$temporary" -xJf "$bundle" || exit 2
    bundle=$(echo "$temporary"/kestrel-*)
fi
export KESTREL=$bundle/kestrel KESTREL_CACHE=$temporary/cache
graphs=$bundle/share/kestrel/graphs
out=$temporary/made
[ -n "$making" ] || { mkdir -p "${2:-gpu-results}" && out=$(realpath "${2:-gpu-results}"); }
mkdir -p "$out/pictures" "$out/said"
export OUT=$out SIZE=$picture_size
"$KESTREL" --version --gl >"$out/machine.json" || exit
value() { sed -n "s/^ *\"$1\": \"\\{0,1\\}\\([^\"]*[^\",]\\)\"\\{0,1\\},\\{0,1\\}\$/\\1/p" "$2" | head -n 1; }
renderer=$(value renderer "$out/machine.json")
driver=$(value driver "$out/machine.json")
software=$(value software "$out/machine.json")
cores=$(nproc)

# One picture of each output: GRAPH SCENE. Status and what was said lie in said/.
render() {
    local name=${1%.json}.$2
    "$KESTREL" -q render "$1" --scene "builtin:$2?detail=0.2" --size "$SIZE" --frames 2 --check-finite --out "$OUT/pictures/$name" \
        >/dev/null 2>"$OUT/said/$name"
    echo $? >"$OUT/said/$name.status"
}
export -f render
# The first scene with every graph, then the next: what time is short for are the last scenes.
everything() {
    "$KESTREL" scene list | sed -n 's/^builtin:\([a-z]*\).*/\1/p' | while read -r scene; do
        for graph in "$graphs"/*.json; do
            [ "${graph##*/}" = schema.json ] || echo "${graph##*/} $scene"
        done
    done
}
if [ -n "$making" ]; then
    everything | xargs -P "$cores" -L 1 bash -c 'render "$@"' render
    echo "$driver, $renderer" >"$out/pictures/driver"
    tar -C "$out" -cf "$pictures" pictures
    du -h "$pictures"
    exit
fi

failed=0
report=$out/report.md
tell() { printf '%s\n' "$@" | tee -a "$report"; }
wrong() { tell "**${*}**" && failed=1; }
: >"$report"
tell "# $renderer" "" "$driver. Kestrel $(value version <(sed -n '/"kestrel": {/,$p' "$out/machine.json")); $cores cores; $(date -u +%F)."
command -v nvidia-smi >/dev/null && tell "" "$(nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2>&1)"

tell "" "## Pictures" ""
everything | timeout 90 xargs -P "$cores" -L 1 bash -c 'render "$@"' render
mkdir -p "$temporary/theirs"
theirs=$temporary/theirs/pictures
[ -f "$pictures" ] && tar -C "$temporary/theirs" -xf "$pictures"
[ -f "$theirs/driver" ] && [ "$(cat "$theirs/driver")" = "$driver, $renderer" ] && flip=0 mse=0
ran=0 lacks=0 compared=0
for status in "$out"/said/*.status; do
    name=$(basename "$status" .status)
    said=$(cat "$out/said/$name")
    ran=$((ran + 1))
    case $(cat "$status") in
    0) [ -z "$said" ] || wrong "$name says: $(head -n 3 <<<"$said")" ;;
    3) lacks=$((lacks + 1)) && tell "$name is not for this machine: $(head -n 1 <<<"$said")" && continue ;;
    *) wrong "$name fails: $(head -n 3 <<<"$said")" && continue ;;
    esac
    for picture in "$theirs/$name"/*.png; do
        [ -f "$picture" ] || continue
        compared=$((compared + 1))
        error=$("$KESTREL" -q compare "$picture" "$out/pictures/$name/$(basename "$picture")" --max flip=$flip --max mse=$mse 2>&1) ||
            { wrong "$name, $(basename "$picture"): $(tail -n 1 <<<"$error")" && cp "$picture" "$out/pictures/$name/expected.$(basename "$picture")"; }
    done
done
tell "" "$ran of $(everything | wc -l) graphs on scenes at $picture_size, every output finite; $lacks not for this machine; $compared" \
    "pictures against those of $(cat "$theirs/driver" 2>/dev/null || echo 'no driver: there are none beside the bundle')," \
    "mean FLIP at most $flip and MSE at most $mse each."

tell "" "## Timer queries against wall clock" "" \
    "Sums of the medians of what runs in every frame, in milliseconds, and the frame on the wall clock that waits for the GPU once." "" \
    "| graph | timer queries | finish, step by step | frame |" "|---|---:|---:|---:|"
size=1280x720 frames=32
[ "$software" = true ] && size=160x90 frames=4
# Of the passes that run in every frame.
total() { sed -n 's/^time of .*: median \([0-9.]*\) ms, ran in \([0-9]*\) of \([0-9]*\) .*/\1 \2 \3/p' "$1" | awk '$2 == $3 { sum += $1 } END { printf "%.3f", sum }'; }
for graph in ray_ao path_trace full; do
    [ "$(left)" -gt 0 ] || { tell "| $graph: no time is left | | | |" && continue; }
    for clock in timer_query finish; do
        "$KESTREL" render $graph.json --scene builtin:tower --size $size --frames $frames --clock $clock --stats "$out/$graph.$clock.json" \
            --out "$temporary/timed" >"$temporary/$clock" 2>>"$out/said/clocks" || wrong "$graph.json with --clock $clock fails"
    done
    queries=$(total "$temporary/timer_query") finish=$(total "$temporary/finish")
    frame=$(sed -n 's/^time: .*median \([0-9.]*\) ms.*/\1/p' "$temporary/timer_query")
    tell "| $graph | $queries | $finish | $frame |"
    # Waiting after each step adds to each, never takes away; and what the GPU does is part of the frame.
    [ "$software" = true ] || awk "BEGIN { exit !($queries > 0 && $queries <= 1.05 * $finish && $queries <= 1.05 * $frame) }" ||
        wrong "$graph: timer queries and wall clock disagree"
done

# The times of a sweep and what they are of the least, in what is kept for it or of what others have left: NAME [SWEEP ARGUMENT]...
sweep() {
    local name=$1 seconds repeats=3 samples=64
    shift
    [ "$software" = true ] && repeats=1 samples=16
    unset "kept[$name]"
    seconds=$(left)
    tell "" "## $name" ""
    [ "$seconds" -gt 5 ] || { tell "no time is left"; return; }
    sed "s/\"repeats\": [0-9]*/\"repeats\": $repeats/; s/\\.samples=[0-9]*/.samples=$samples/" "$graphs/sweeps/$name.json" \
        >"$graphs/sweeps/gpu_$name.json"
    timeout "$seconds" "$KESTREL" -q sweep "$graphs/sweeps/gpu_$name.json" --out "$temporary/$name" "$@" 2>>"$out/said/$name"
    case $? in 0) ;; 124) tell "Stopped after $seconds s: the last measurements are missing." "" ;; *) wrong "$name: $(tail -n 1 "$out/said/$name")" ;; esac
    "$KESTREL" -q sweep "$graphs/sweeps/gpu_$name.json" --out "$out/$name" --merge "$temporary/$name" "$@" 2>>"$out/said/$name"
    "$KESTREL" sweep --markdown "$out/$name/results.json" | awk -F' *[|] *' '
        function flush(  i) { for (i = 1; i <= n; ++i) printf "| %s | %s | %.2f |\n", names[i], ms[i], ms[i] / least; n = 0; least = 0 }
        /^### / { flush(); print "\n" $0 "\n" }
        /^\| variant/ { print "| " $2 " | " $3 " | times the least |\n|---|---:|---:|"; next }
        /^\|---/ { next }
        /^\|/ && $3 + 0 > 0 { names[++n] = $2; ms[n] = $3; if (!least || $3 + 0 < least) least = $3 + 0 }
        END { flush() }' | tee -a "$report"
}
small=()
[ "$software" = true ] && small=(--size 64x36 --frames 2)
sweep roma_table2 "${small[@]}"
sweep snap "${small[@]}"
[ "$software" = true ] || small=(--size 1920x1080)
sweep sd_path "${small[@]}"
[ "$software" = true ] || small=(--size 1280x720)
sweep abuffer_variants "${small[@]}"

tell "" "$SECONDS s in all; $([ $failed -eq 0 ] && echo 'everything holds' || echo 'not everything holds')."
tar -C "$(dirname "$out")" -cJf "$out.tar.xz" "$(basename "$out")"
echo "$out.tar.xz"
exit $failed
