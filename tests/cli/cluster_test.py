"""A sweep over many machines: GNU parallel with two workers, a shard that is started twice, the whole joined."""
import os
import subprocess
from pathlib import Path
from shutil import which

from kestrel_cli import KESTREL, SOURCE, done, folder, need, need_part, run_tests
from sweep_test import results, tiny, without_times

SHARD = SOURCE / "apps" / "cluster" / "sweep.sbatch"


def test_two_workers_measure_what_one_does():
    need_part("embree")
    need(which("parallel"), "GNU parallel is not here")
    with folder() as here:
        file, out = tiny(here, repeats=1), Path(here) / "out"
        done("sweep", file, "--out", f"{here}/whole")
        env = {**os.environ, "KESTREL": KESTREL, "HOME": here}
        subprocess.run(["parallel", "-j", "2", "sh", SHARD, file, out, "{}", "3", ":::", "1", "2", "3"],
                       check=True, capture_output=True, env=env, timeout=100)
        before = (out / "done" / "2" / "results.json").stat()
        subprocess.run(["sh", SHARD, file, out, "2", "3"], check=True, capture_output=True, env=env)
        assert (out / "done" / "2" / "results.json").stat() == before
        done("sweep", file, "--out", f"{here}/joined", "--merge", *sorted((out / "done").iterdir()))
        assert without_times(results(f"{here}/joined")) == without_times(results(f"{here}/whole"))
        assert not list((out / "begun").iterdir())


if __name__ == "__main__":
    run_tests(globals())
