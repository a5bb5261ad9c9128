"""What against.sh does with the files of two sweeps: one repetition, times set aside, and the table.

    against.py once SWEEP.json          sets "repeats" to 1 and prints what it was
    against.py aside OUT ROUND          moves the times of OUT into the folder ROUND
    against.py table OLD NEW NAME KESTREL
"""
import json
import statistics
import subprocess
import sys
from pathlib import Path


def once(file):
    sweep = json.loads(file.read_text())
    before = sweep.get("repeats", 5)
    file.write_text(json.dumps({**sweep, "repeats": 1}, indent=1))
    print(before)


def aside(out, target):
    """Every file beside a point's picture.json holds times, whatever a revision calls it."""
    found = 0
    for picture in sorted(out.glob("parts/*/*/picture.json")):
        for file in sorted(picture.parent.glob("*.json")):
            if file != picture:
                place = target / picture.parent.relative_to(out / "parts")
                place.mkdir(parents=True, exist_ok=True)
                file.rename(place / "times.json")
                found += 1
    if not found:
        sys.exit(f"against.py: {out} holds no times")


def groups(times):
    """Milliseconds of each group and in all: the mean over the frames of a repetition."""
    sums = {"total": 0.0}
    for frame in times["frames"]:
        for _, _, group, ms in frame["steps"]:
            sums[group] = sums.get(group, 0.0) + ms
            sums["total"] += ms
    return {group: ms / len(times["frames"]) for group, ms in sums.items()}


def load_rounds(folder):
    """(unit, point) -> round -> group -> ms; and the spin tests."""
    found, spins = {}, []
    for file in sorted(folder.glob("rounds/*/*/*/times.json")):
        number, unit, point = file.parts[-4:-1]
        times = json.loads(file.read_text())
        found.setdefault((unit, point), {})[int(number)] = groups(times)
        spins.append(tuple(times["spin"]))
    return found, sorted(set(spins))


def ratio_text(old, new, group):
    """Medians of both and of the ratio within each round, with its quartiles where there are enough rounds."""
    pairs = [(old[r][group], new[r][group]) for r in sorted(old) if r in new and group in old[r] and group in new[r]]
    if not pairs:
        return None
    before, after = (statistics.median(column) for column in zip(*pairs))
    ratios = sorted(b / a for a, b in pairs if a > 0)
    if not ratios:
        return f"{before:9.2f} {after:9.2f}      -"
    spread = ""
    if len(ratios) >= 4:
        q1, _, q3 = statistics.quantiles(ratios, n=4, method="inclusive")
        spread = f"  ({q1:.3f} to {q3:.3f})"
    return f"{before:9.2f} {after:9.2f} {statistics.median(ratios):6.3f}{spread}"


def compare(old, new, unit, point, kestrel):
    """How two pictures or two sets of hits differ, in words."""
    name = Path("parts") / unit / point / "picture.json"
    a, b = (json.loads((folder / "out" / name).read_text()) for folder in (old, new))
    for which, data in (("old", a), ("new", b)):
        if data["failed"]:
            return f"{which} failed: {data['failed']}"
    if "rays" in b:
        same = a.get("rays") == b["rays"]
        return "answers equal" if same else f"answers differ: agreement {a['rays']['agreement']:.6f} and {b['rays']['agreement']:.6f}"
    files = [folder / "out" / data["picture"] for folder, data in ((old, a), (new, b))]
    if files[0].read_bytes() == files[1].read_bytes():
        return "equal" if a["errors"] == b["errors"] else \
            f"equal in 8 bits; FLIP against the reference {a['errors']['flip']:.6f} and {b['errors']['flip']:.6f}"
    run = subprocess.run([kestrel, "compare", *map(str, files), "--json"], capture_output=True, text=True)
    if run.returncode > 1:
        return "not comparable: " + run.stderr.strip()
    figures = json.loads(run.stdout)
    return f"differ: MSE {figures['mse']:.2e}, FLIP {figures['flip']['mean']:.4f}"


def spin_line(name, spins):
    columns = list(zip(*spins))
    text = [f"{statistics.median(column):.1f} ({min(column):.1f} to {max(column):.1f})" for column in columns]
    return f"spin test, {name}: one thread {text[0]} ms, two at once {text[1]} ms"


def table(old, new, revision, kestrel):
    before, old_spins = load_rounds(old)
    after, new_spins = load_rounds(new)
    keys = [key for key in after if key in before]
    width = max([len(f"{unit}: {point}") for unit, point in keys] + [7]) + 2
    parts = ["total", *sorted({g for key in keys for times in after[key].values() for g in times} - {"total"})]
    print(f"milliseconds of {revision} and of the working tree, medians; the median of new over old within each round"
          " (quartiles)")
    print(f"{'scene: variant':{width}} {'part':10} {'old':>9} {'new':>9} {'ratio':>6}")
    for unit, point in keys:
        for part in parts:
            text = ratio_text(before[unit, point], after[unit, point], part)
            if text:
                print(f"{f'{unit}: {point}' if part == 'total' else '':{width}} {part:10} {text}")
        print(f"{'':{width}} {'picture':10} {compare(old, new, unit, point, kestrel)}")
    for name, mine, other in (("old", before, after), ("new", after, before)):
        for unit, point in mine:
            if (unit, point) not in other:
                print(f"only in the {name} results: {unit}: {point}")
    every = [statistics.median(after[k][r]["total"] / before[k][r]["total"] for r in after[k] if r in before[k]) for k in keys]
    if every:
        print(f"all variants: total, geometric mean of the ratios {statistics.geometric_mean(every):.3f},"
              f" {min(every):.3f} to {max(every):.3f}")
    print(spin_line(revision, old_spins))
    print(spin_line("working tree", new_spins))


if __name__ == "__main__":
    command, *rest = sys.argv[1:]
    if command == "once":
        once(Path(rest[0]))
    elif command == "aside":
        aside(Path(rest[0]), Path(rest[1]))
    else:
        table(Path(rest[0]), Path(rest[1]), *rest[2:])
