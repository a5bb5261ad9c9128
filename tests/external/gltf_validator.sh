#!/usr/bin/env bash
# Exports every built-in scene, and every .gltf and .glb below the folders that are named, and asks the Khronos validator
# whether what was written is valid glTF. Installs the validator with npm in a temporary folder: not part of the tests that
# run everywhere. Exit 1 if it finds an error.
#   tests/external/gltf_validator.sh [FOLDER OF SCENES]...
# KESTREL names the program (default: build/bin/kestrel).
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
kestrel=${KESTREL:-$root/build/bin/kestrel}
command -v npm >/dev/null || { echo "gltf_validator.sh: needs npm" >&2; exit 3; }
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
echo "installing gltf-validator 2.0.0-dev.3.10 in $temporary"
(cd "$temporary" && npm install --silent --no-fund --no-audit gltf-validator@2.0.0-dev.3.10 >/dev/null)

cat >"$temporary/validate.cjs" <<'JS'
const fs = require('fs'), validator = require('gltf-validator');
const [file, name] = process.argv.slice(2);
validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {maxIssues: 0}).then((report) => {
    const counts = report.issues, codes = {};
    for (const issue of counts.messages) codes[issue.code] = (codes[issue.code] || 0) + 1;
    console.log(`${name}: ${counts.numErrors} errors, ${counts.numWarnings} warnings, ${counts.numInfos} infos, ` +
                `${counts.numHints} hints ${JSON.stringify(codes)}`);
    for (const issue of counts.messages.filter((issue) => issue.severity === 0).slice(0, 5))
        console.log(`    ${issue.code} at ${issue.pointer}: ${issue.message}`);
    process.exit(counts.numErrors ? 1 : 0);
});
JS

failed=0
check() { # SCENE NAME
    if ! "$kestrel" -q scene export "$1" "$temporary/exported.glb" >/dev/null; then
        echo "$2: cannot be exported"
        failed=1
        return
    fi
    (cd "$temporary" && node validate.cjs exported.glb "$2") || failed=1
}
"$kestrel" scene list | sed -n 's/^\(builtin:[a-z]*\).*/\1/p' >"$temporary/scenes"
while read -r scene; do check "$scene" "$scene"; done <"$temporary/scenes"
for folder in "$@"; do
    find -L "$folder" \( -name '*.gltf' -o -name '*.glb' \) | sort >"$temporary/scenes"
    while read -r scene; do check "$scene" "${scene#"$folder"/}"; done <"$temporary/scenes"
done
exit $failed
