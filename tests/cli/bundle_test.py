"""apps/bundle.sh: what is unpacked elsewhere brings every library along but the machine's own, and renders."""
import os
import re
import subprocess
from pathlib import Path

from kestrel_cli import KESTREL, SMALL, SOURCE, folder, need, run_tests

# The C library and the GL driver, which are the machine's.
MACHINES = re.compile(r"(ld-linux|linux-vdso|lib(c|m|dl|pthread|rt|mvec|resolv|util|anl)\.so|libE?GL|libOSMesa)")


def programs():
    return [line for line in ["kestrel", "kestrel-editor"] if (Path(KESTREL).parent / line).exists()]


def test_a_bundle_stands_by_itself():
    need(subprocess.run(["which", "patchelf", "xz"], capture_output=True).returncode == 0, "patchelf or xz is not here")
    with folder() as here:
        made = subprocess.run([SOURCE / "apps" / "bundle.sh", here], capture_output=True, text=True,
                              env={**os.environ, "KESTREL_BUILD": str(Path(KESTREL).parents[1]), "XZ_OPT": "-0"})
        assert made.returncode == 0, made.stderr
        [archive] = Path(here).glob("kestrel-*.tar.xz")
        subprocess.run(["tar", "-C", here, "-xJf", archive], check=True)
        bundle = Path(here) / archive.name.removesuffix(".tar.xz")
        libraries = [file for file in (bundle / "lib").rglob("*.so*") if not file.is_symlink()]
        own = ":".join(str(file.parent) for file in libraries if "fallback" in file.parts)
        for file in [*(bundle / "bin").iterdir(), *libraries]:
            needed = subprocess.run(["ldd", file], capture_output=True, text=True,
                                    env={"PATH": os.environ["PATH"], "LD_LIBRARY_PATH": own}).stdout
            for line in needed.splitlines():
                assert "not found" not in line, f"{file}: {line}"
                if not MACHINES.search(line):
                    assert str(bundle) in line, f"{file} takes {line.strip()}"
        clean = {"PATH": "/usr/bin:/bin", "HOME": here, "LC_ALL": "C.UTF-8"}
        for program in programs():
            help_ = subprocess.run([bundle / program, "--help"], capture_output=True, text=True, env=clean)
            assert help_.returncode == 0 and "Usage" in help_.stdout, help_.stderr
        render = subprocess.run([bundle / "kestrel", "render", "ray_ao.json", *SMALL, "--out", here],
                                capture_output=True, text=True, env=clean, cwd="/")
        assert render.returncode == 0 and render.stderr == "", render.stderr
        assert (Path(here) / "mean.result.png").exists()
        assert (bundle / "licences" / "kestrel").exists() and len(list((bundle / "licences").iterdir())) > 5


if __name__ == "__main__":
    run_tests(globals())
