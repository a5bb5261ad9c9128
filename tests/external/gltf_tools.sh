#!/usr/bin/env bash
# Rewrites scenes with the tools that people compress them with (gltf-transform, gltfpack) and holds each result against
# the plain file: the triangles that Kestrel counts, and the error of its picture (direct_light). Exit 1 where triangles are
# lost or the picture is further off than quantization and lossy WebP leave it (FLIP 0.03). Installs the tools with npm in a
# temporary folder: not part of the tests that run everywhere.
#   tests/external/gltf_tools.sh SCENE.glb...
# KESTREL names the program (default: build/bin/kestrel), GRAPHS the shipped graphs.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
kestrel=$(realpath "${KESTREL:-$root/build/bin/kestrel}")
graphs=$(realpath "${GRAPHS:-$root/graphs}")
command -v npm >/dev/null || { echo "gltf_tools.sh: needs npm" >&2; exit 3; }
[ $# -gt 0 ] || { echo "gltf_tools.sh: name the scenes" >&2; exit 2; }
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
echo "installing @gltf-transform/cli 4.5.1 and gltfpack 1.3.0 in $temporary"
(cd "$temporary" && npm install --silent --no-fund --no-audit @gltf-transform/cli@4.5.1 gltfpack@1.3.0 >/dev/null)
transform="$temporary/node_modules/.bin/gltf-transform"
pack="$temporary/node_modules/.bin/gltfpack"

failed=0
triangles() { "$kestrel" -q scene info "$1" | sed -n 's/^triangles: //p'; }
picture() { "$kestrel" -q render "$graphs/direct_light.json" -s "$1" --size 320x180 --camera "$camera" --output "tone.image=$2" >/dev/null; }
hold() { # NAME FILE
    if ! picture "$2" "$temporary/test.png" 2>"$temporary/said"; then
        printf '  %-34s %s\n' "$1" "$(head -n 1 "$temporary/said")"
        failed=1
        return
    fi
    flip=$("$kestrel" compare "$temporary/plain.png" "$temporary/test.png" --json |
        python3 -c 'import json,sys; print(format(json.load(sys.stdin)["flip"]["mean"], ".5f"))')
    count=$(triangles "$2")
    printf '  %-34s %8s triangles, FLIP %s, %s bytes\n' "$1" "$count" "$flip" "$(stat -c %s "$2")"
    if [ "$count" != "$plain" ] || awk "BEGIN { exit !($flip > 0.03) }"; then
        echo "  $1: differs from the plain file"
        failed=1
    fi
}

for scene in "$@"; do
    # A camera that the tools may move or rename would make another picture: the default one, or the first.
    camera=0
    plain=$(triangles "$scene")
    echo "$scene: $plain triangles"
    if ! picture "$scene" "$temporary/plain.png"; then continue; fi
    out="$temporary/out.glb"
    for way in copy draco meshopt webp "quantize" instance metalrough; do
        rm -f "$out"
        "$transform" "$way" "$scene" "$out" >/dev/null 2>&1 && hold "gltf-transform $way" "$out" ||
            echo "  gltf-transform $way: the tool fails"
    done
    # Names, materials and extras are kept: area lights stand in the extras of nodes.
    for way in -noq "" -c -cc -cz "-cc -noq" "-cz -noq" -mi; do
        rm -f "$out"
        # shellcheck disable=SC2086
        "$pack" -i "$scene" -o "$out" -kn -km -ke $way >/dev/null 2>&1 && hold "gltfpack $way" "$out" ||
            echo "  gltfpack $way: the tool fails"
    done
done
exit $failed
