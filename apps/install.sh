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
"${as_root[@]}" apt-get update -qq
known=()
for package in "${missing[@]}"; do
    if [ "${need_of[$package]}" = required ] || apt-cache show "$package" >/dev/null 2>&1; then
        known+=("$package")
    else
        echo "Left out: $package (this release of Debian has none)"
    fi
done
[ ${#known[@]} -eq 0 ] && exit 0
echo "Installing: ${known[*]}"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${known[@]}" >/dev/null
