#!/usr/bin/env bash
# Makes graphs/results/README.md of head.md, a list of the sweeps, truth.md and by_hand.md, and NAME.md of every NAME.json beside it.
#
#   graphs/results/generate.sh [FOLDER...]     takes the results.json of these folders of sweeps in first
#   graphs/results/generate.sh --check         changes nothing; 1 if a page is not what it would write
#
# KESTREL names the program (build/bin/kestrel). What no table shows (commands with the paths of one machine, steps, what was left
# out) is not kept.
set -euo pipefail
shopt -s nullglob
here=$(cd "$(dirname "$0")" && pwd)
kestrel=${KESTREL:-$here/../../build/bin/kestrel}
made=$(mktemp -d)
trap 'rm -r "$made"' EXIT

# A sweep's own page: its tables.
sweep_page() { "$kestrel" sweep --markdown "$1" | sed 's/^##\(#*\) /#\1 /'; }

# The sweeps, with what tells a quiet machine from one that was not.
list() {
    echo '| sweep | measured | spin test, ms: one thread, two at once |'
    echo '|---|---|---|'
    for file in "$here"/*.json; do
        name=$(basename "$file" .json)
        title=$(sed -n '1s/^# //p' "$made/$name.md")
        python3 - "$file" "[$title]($name.md)" <<'PYTHON'
import json, sys
machines = json.load(open(sys.argv[1]))["machines"]
def spin(machine):
    return ", ".join(f"{machine['spin'][threads]['median']:.1f}" for threads in ["one_thread_ms", "two_threads_ms"])
print("|", sys.argv[2], "|", "; ".join(m["date"] for m in machines), "|", "; ".join(map(spin, machines)), "|")
PYTHON
    done
}

# Links to the sections of a page.
contents() {
    sed -n 's/^##\(#\{0,1\}\) /\1 /p' "$1" | while IFS= read -r line; do
        title=${line#* }
        anchor=$(tr '[:upper:]' '[:lower:]' <<<"$title" | sed 's/[^a-z0-9 _-]//g; s/ /-/g')
        case $line in '#'*) printf '  ' ;; esac
        echo "- [$title](#$anchor)"
    done
}

for folder in "$@"; do
    [ "$folder" != --check ] || continue
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

for file in "$here"/*.json; do
    sweep_page "$file" >"$made/$(basename "$file" .json).md"
done
{
    cat "$here/truth.md"
    echo
    cat "$here/by_hand.md"
} >"$made/body"
{
    cat "$here/head.md"
    echo
    list
    echo
    contents "$made/body"
    echo
    cat "$made/body"
} >"$made/README.md"
rm "$made/body"

# Pages of sweeps that are gone go too.
status=0
for page in "$here"/*.md; do
    name=$(basename "$page")
    case $name in head.md | truth.md | by_hand.md) continue ;; esac
    [ ! -e "$made/$name" ] || continue
    if [ "${1:-}" = --check ]; then
        echo "$name is of no sweep"
        status=1
    else
        rm "$page"
    fi
done
for page in "$made"/*.md; do
    if [ "${1:-}" = --check ]; then
        diff -u "$here/$(basename "$page")" "$page" || status=1
    else
        cp "$page" "$here/"
    fi
done
exit $status
