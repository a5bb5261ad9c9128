#!/usr/bin/env bash
# Installs what is missing, builds, renders ambient occlusion on the built-in tower by ROMA and by the BVH without a
# display, and measures both against Embree. Everything lands in out/.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${KESTREL_BUILD:-$root/build}
out=$root/out
frames=64
"$root/apps/build.sh" demo
kestrel=$build/bin/kestrel
mkdir -p "$out"
cd "$root"

# The median time of a frame, from a stats file.
frame_ms() { python3 -c 'import json, sys; print("%.1f" % json.load(open(sys.argv[1]))["frame_ms"]["median"])' "$1"; }
# One figure of an error report.
figure() { python3 -c 'import json, sys; e = json.load(open(sys.argv[1])); print("%.4f" % (e["flip"]["mean"] if sys.argv[2] == "flip" else e[sys.argv[2]]))' "$1" "$2"; }

echo "Reference: Embree, 256 rays a pixel"
"$kestrel" render graphs/reference_ao.json --set reference.samples=256 --stats "$out/reference.stats.json" \
    --output reference.visibility="$out/reference.png" --output gbuffer.coverage="$out/coverage.png" >/dev/null
rows=("out/reference.png|the reference|$(frame_ms "$out/reference.stats.json")|-|-")
for tracer in roma bvh; do
    echo "Rendering: $tracer, $frames frames of one ray a pixel"
    "$kestrel" render graphs/ray_ao.json --set ao.tracer=$tracer.tracer --frames $frames \
        --output mean.result="$out/$tracer.png" --stats "$out/$tracer.stats.json" >/dev/null
    "$kestrel" compare "$out/reference.png" "$out/$tracer.png" --mask "$out/coverage.png" \
        --heatmap "$out/$tracer.flip.png" --json >"$out/$tracer.error.json"
    rows+=("out/$tracer.png|$frames frames|$(frame_ms "$out/$tracer.stats.json")|$(figure "$out/$tracer.error.json" flip)|$(figure "$out/$tracer.error.json" mse)")
    rows+=("out/$tracer.flip.png|where it differs|||")
done
cp "$out/roma.stats.json" "$out/stats.json"

echo
printf '%-24s %-18s %12s %8s %8s\n' file what 'ms a frame' FLIP MSE
for row in "${rows[@]}"; do
    IFS='|' read -r file what ms flip mse <<<"$row"
    printf '%-24s %-18s %12s %8s %8s\n' "$file" "$what" "$ms" "$flip" "$mse"
done
echo "out/stats.json: the times and the memory of the run with ROMA, step by step"
echo "apps/build.sh builds the rest: the other passes, and the editor"
