#!/usr/bin/env bash
# Tries the README's two commands as a newcomer would: a fresh clone in a bare Debian root that has only git and sudo,
# made with debootstrap from the mirror that this machine's apt uses. Needs root.
#   tests/bare_debian.sh [SUITE] [ROOT FOLDER] [COMMAND]...      default: bookworm (Debian 12); apps/demo.sh, then tests/run.sh
set -euo pipefail
source=$(cd "$(dirname "$0")/.." && pwd)
suite=${1:-bookworm}
root=${2:-/var/tmp/kestrel-$suite}
shift $(($# < 2 ? $# : 2))
[ $# -gt 0 ] && commands=("$@") || commands=(apps/demo.sh tests/run.sh)
[ "$(id -u)" -eq 0 ] || { echo "tests/bare_debian.sh: needs root for debootstrap and chroot" >&2; exit 3; }
command -v debootstrap >/dev/null || apt-get install -y -qq debootstrap

if [ ! -x "$root/usr/bin/git" ]; then
    mirror=$(apt-get indextargets --format '$(SITE) $(LABEL)' | awk '$2 == "Debian" { print $1; exit }')
    # The script of unstable serves every suite of today, also one that this debootstrap has not heard of.
    debootstrap --variant=minbase --include=git,sudo,ca-certificates "$suite" "$root" \
        "${mirror:?apt has no mirror of Debian}" /usr/share/debootstrap/scripts/sid
    # The same way to packages as this machine: its client's settings.
    cp -r /etc/apt/apt.conf.d "$root/etc/apt/" 2>/dev/null || true
    rm -f "$root"/etc/apt/apt.conf.d/docker-*
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    echo "127.0.0.1 localhost $(hostname)" >>"$root/etc/hosts"
fi
if ! chroot "$root" id newcomer >/dev/null 2>&1; then
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
