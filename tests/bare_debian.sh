#!/usr/bin/env bash
# Tries the README's two commands as a newcomer would: a fresh clone in a bare Debian 12 root that has only git and sudo,
# made with debootstrap from the mirror that this machine's apt uses. Needs root.
#   tests/bare_debian.sh [ROOT FOLDER] [COMMAND]...      default: apps/demo.sh, then tests/run.sh
set -euo pipefail
source=$(cd "$(dirname "$0")/.." && pwd)
root=${1:-/var/tmp/kestrel-bare}
shift || true
[ $# -gt 0 ] && commands=("$@") || commands=(apps/demo.sh tests/run.sh)
[ "$(id -u)" -eq 0 ] || { echo "tests/bare_debian.sh: needs root for debootstrap and chroot" >&2; exit 3; }
command -v debootstrap >/dev/null || apt-get install -y -qq debootstrap

mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE)' | awk '$2 == "bookworm" { print $1; exit }')
if [ ! -x "$root/usr/bin/git" ]; then
    debootstrap --variant=minbase --include=git,sudo,ca-certificates bookworm "$root" "${mirror:?no bookworm mirror in apt}"
    # The same way to packages as this machine: its sources and its client's settings.
    cp -r /etc/apt/sources.list.d /etc/apt/apt.conf.d "$root/etc/apt/" 2>/dev/null || true
    rm -f "$root"/etc/apt/apt.conf.d/docker-*
    [ -s "$root/etc/apt/sources.list.d/debian.sources" ] && rm -f "$root/etc/apt/sources.list"
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    echo "127.0.0.1 localhost $(hostname)" >>"$root/etc/hosts"
    chroot "$root" useradd -m -G sudo newcomer
    echo 'newcomer ALL=(ALL) NOPASSWD: ALL' >"$root/etc/sudoers.d/newcomer"
fi
finish() { umount "$root/dev/pts" "$root/dev" "$root/proc" 2>/dev/null || true; }
trap finish EXIT
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc" 2>/dev/null || mount --bind /proc "$root/proc"
mountpoint -q "$root/dev" || mount --bind /dev "$root/dev"
mountpoint -q "$root/dev/pts" || mount --bind /dev/pts "$root/dev/pts"

rm -rf "$root/home/newcomer/kestrel"
git clone -q "$source" "$root/home/newcomer/kestrel"
chroot "$root" chown -R newcomer: /home/newcomer/kestrel
for command in "${commands[@]}"; do
    echo "== $command"
    # Only a newcomer's environment; proxy settings are the network's, not ours.
    time chroot "$root" su - newcomer -w http_proxy,https_proxy,no_proxy -c "cd kestrel && $command"
done
