#!/usr/bin/env bash
# Makes graphs/results/README.md of head.md, truth.md, the tables of every NAME.json beside it, and by_hand.md.
#
#   graphs/results/generate.sh [FOLDER...]     takes the results.json of these folders of sweeps in first
#   graphs/results/generate.sh --check         changes nothing; 1 if the page is not what it would write
#
# KESTREL names the program (build/bin/kestrel). What no table shows (commands with the paths of one machine, steps, what was left
# out) is not kept.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
kestrel=${KESTREL:-$here/../../build/bin/kestrel}

# Links to the sections of a page.
contents() {
    sed -n 's/^## //p' "$1" | while read -r title; do
        anchor=$(tr '[:upper:]' '[:lower:]' <<<"$title" | sed 's/[^a-z0-9 _-]//g; s/ /-/g')
        echo "- [$title](#$anchor)"
    done
}

page() {
    local body
    body=$(mktemp)
    sections >"$body"
    cat "$here/head.md"
    echo
    contents "$body"
    echo
    cat "$body"
    rm "$body"
}

sections() {
    cat "$here/truth.md"
    for file in "$here"/*.json; do
        [ -e "$file" ] || continue
        echo
        "$kestrel" sweep --markdown "$file"
    done
    echo
    cat "$here/by_hand.md"
}

if [ "${1:-}" = --check ]; then
    page | diff -u "$here/README.md" -
    exit
fi
for folder in "$@"; do
    python3 - "$folder/results.json" "$here" <<'PYTHON'
import json, sys
from pathlib import Path
data = json.loads(Path(sys.argv[1]).read_text())
if data["missing"]:
    sys.exit(f"{sys.argv[1]}: {len(data['missing'])} measurements are missing: finish it with --resume first")
for row in data["rows"]:
    for key in ["command", "times_command", "steps", "left_out", "reports", "picture", "heat_map"]:
        row.pop(key, None)
for scene in data["scenes"]:
    scene.pop("reference_reports", None)
Path(sys.argv[2], data["name"] + ".json").write_text(json.dumps(data, ensure_ascii=False) + "\n")
PYTHON
done
page >"$here/README.md.new"
mv "$here/README.md.new" "$here/README.md"
