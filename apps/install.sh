#!/usr/bin/env bash
# Installs the Debian packages of apps/packages.txt that are missing, saying which; what is not required and not in this
# release of Debian is left out with a line. Usage: apps/install.sh [bundle | test | stage]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
needs='required|optional'
[ "${1:-}" = bundle ] && needs='required|optional|bundle'
[ "${1:-}" = test ] && needs='required|optional|bundle|test'
[ "${1:-}" = stage ] && needs='required|optional|bundle|test|stage'

missing=()
declare -A need_of
while read -r package need _; do
    case "$package" in ''|'#'*) continue ;; esac
    [[ $need =~ ^($needs)$ ]] || continue
    need_of[$package]=$need
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done <"$here/packages.txt"
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "apps/install.sh: needs root or sudo to install packages" >&2; exit 3; }
    as_root=(sudo)
fi
# Of what is missing, what can be had by the lists that apt holds.
choose() {
    local there package
    there=$(apt-cache show --no-all-versions "${missing[@]}" 2>/dev/null | sed -n 's/^Package: //p' || true)
    known=() left=()
    for package in "${missing[@]}"; do
        if [ "${need_of[$package]}" = required ] || grep -qxF "$package" <<<"$there"; then
            known+=("$package")
        else
            left+=("$package")
        fi
    done
}
choose
if [ ${#known[@]} -gt 0 ] || ! apt-cache show cmake >/dev/null 2>&1; then
    "${as_root[@]}" apt-get update -qq
    choose
fi
[ ${#left[@]} -eq 0 ] || echo "Left out: ${left[*]} (this release of Debian has none)"
[ ${#known[@]} -eq 0 ] && exit 0
echo "Installing: ${known[*]}"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${known[@]}" >/dev/null
