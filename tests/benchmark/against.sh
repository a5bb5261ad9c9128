#!/usr/bin/env bash
# Is the working tree faster than a revision, with the same pictures? Builds the revision beside the working tree with the
# same options, runs a sweep with both programs in turn, and prints the ratios of their times and how their pictures differ.
#
#   tests/benchmark/against.sh REVISION SWEEP [--rounds N] [--ours] [sweep arguments: --frames 1, --size 320x180, --only ROMA ...]
#
#   --rounds N   how often each program times each variant (default: the sweep's "repeats")
#   --ours       both programs read the working tree's sweep files and their graphs; otherwise each reads its own revision's
#
# A round is one process of each program that times each variant once: old, new, old, new ... A machine that changes its
# speed by the minute then slows both alike, and a ratio is taken within a round. Each program keeps one folder: the first round
# makes references and pictures, later ones resume it with the times before set aside, so that only times are
# measured. Processes and the files of their folders are all that is relied on: old revisions need no knowledge of this script.
# Pictures are equal where the 8-bit files are and every figure against the reference (computed from floats) agrees to the last digit.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${KESTREL_BUILD:-$root/build}
if [ $# -lt 2 ]; then sed -n '2,15s/^# \{0,1\}//p' "$0"; exit 2; fi
revision=$(git -C "$root" rev-parse --short "$1^{commit}") || { echo "against.sh: there is no revision '$1'" >&2; exit 2; }
sweep=$(realpath --relative-to="$root" "$2")
[[ $sweep != ../* ]] || { echo "against.sh: $2 lies outside of this tree, so the revision has no copy of it" >&2; exit 2; }
shift 2
rounds='' ours=no arguments=()
while [ $# -gt 0 ]; do
    case $1 in
    --rounds) rounds=${2:?against.sh: --rounds needs a number}; shift ;;
    --ours) ours=yes ;;
    *) arguments+=("$1") ;;
    esac
    shift
done
[ -x "$build/bin/kestrel" ] || { echo "against.sh: $build/bin/kestrel is not built" >&2; exit 2; }

# The revision, with the options of the working tree's build.
home=$root/build-against/$revision
if [ ! -x "$home/build/bin/kestrel" ]; then
    mkdir -p "$home/source"
    git -C "$root" archive "$revision" | tar -x -C "$home/source"
    mapfile -t options < <(sed -n 's/^\(\(KESTREL_\(CONFIG\|UNITY\|PCH\)\|CMAKE_BUILD_TYPE\|CMAKE_CXX_FLAGS\):[A-Z]*=.*\)/-D\1/p' "$build/CMakeCache.txt")
    echo "Building $revision in $home" >&2
    cmake -S "$home/source" -B "$home/build" -G Ninja "${options[@]}" -DKESTREL_TESTS=OFF >"$home/build.log" 2>&1 &&
        cmake --build "$home/build" >>"$home/build.log" 2>&1 || { tail -20 "$home/build.log" >&2; exit 2; }
fi

# The sweep file with one repetition, in a copy of the folder that its graphs lie in.
work=$(mktemp -d "$root/build-against/run.XXXXXX")
prepare() { # NAME TREE
    [ -f "$2/$sweep" ] || { echo "against.sh: $2 has no $sweep" >&2; exit 2; }
    mkdir -p "$work/$1"
    cp -r "$(dirname "$2/$sweep")" "$work/$1/sweeps"
    python3 "$root/tests/benchmark/against.py" once "$work/$1/sweeps/$(basename "$sweep")"
}
tree=$home/source
[ $ours = no ] || tree=$root
of_old=$(prepare old "$tree")
of_new=$(prepare new "$root")
rounds=${rounds:-$of_new}
[ "$rounds" -ge 1 ] || { echo "against.sh: --rounds $rounds: at least one" >&2; exit 2; }
[ "$of_old" = "$of_new" ] || echo "The two sweep files ask for $of_old and $of_new repetitions: $rounds are made of each" >&2

# Times are set aside as NAME/rounds/ROUND, spin tests with them.
measure() { # NAME PROGRAM ROUND
    local out=$work/$1/out more=() status=0
    [ "$3" -eq 1 ] || more=(--resume)
    "$2" sweep "$work/$1/sweeps/$(basename "$sweep")" --out "$out" ${arguments[@]+"${arguments[@]}"} ${more[@]+"${more[@]}"} \
        >"$work/$1/log" || status=$?
    [ $status -le 1 ] || { echo "against.sh: the sweep by $2 stopped" >&2; exit 2; } # 1: a variant failed, the table says which
    python3 "$root/tests/benchmark/against.py" aside "$out" "$work/$1/rounds/$3"
}
for round in $(seq "$rounds"); do
    echo "Round $round of $rounds" >&2
    measure old "$home/build/bin/kestrel" "$round"
    measure new "$build/bin/kestrel" "$round"
done
python3 "$root/tests/benchmark/against.py" table "$work/old" "$work/new" "$revision" "$build/bin/kestrel"
echo "Both folders of results: $work/old/out and $work/new/out"
