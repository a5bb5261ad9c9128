#!/bin/sh
# Starts the program of its own name in a bundle (apps/bundle.sh). Of the libraries in lib/fallback/VERSION/ the machine's
# are taken, but where it has none or an older one: its GL driver needs its own, or newer ones.
here=$(dirname "$(readlink -f "$0")")
program=$here/bin/$(basename "$0")
found=$(LD_TRACE_LOADED_OBJECTS=1 "$program")
for own in "$here"/lib/fallback/*/*; do
    ours=$(basename "$(dirname "$own")")
    theirs=$(printf '%s\n' "$found" | awk -v name="$(basename "$own")" '$1 == name && $3 ~ "^/" { print $3 }')
    [ -z "$theirs" ] || theirs=$(basename "$(readlink -f "$theirs")")
    newest=$(printf '%s\n' "$theirs" "$ours" | sort -V | tail -n 1)
    [ "$newest" = "$theirs" ] || LD_LIBRARY_PATH=$(dirname "$own")${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
done
[ -z "${LD_LIBRARY_PATH:-}" ] || export LD_LIBRARY_PATH
exec "$program" "$@"
