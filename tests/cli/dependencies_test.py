"""One place states the dependencies: what CMake asks for by a Debian package's name is in apps/packages.txt; and what takes
long to compile is included by few files."""
import re
from collections import Counter
from functools import cache

from kestrel_cli import SOURCE, run_tests


def stated():
    rows = [line.split() for line in (SOURCE / "apps" / "packages.txt").read_text().splitlines()]
    return {row[0]: row[1] for row in rows if row and not row[0].startswith("#")}


def test_every_row_has_a_package_and_a_known_need():
    packages = stated()
    assert len(packages) > 10
    assert set(packages.values()) == {"required", "optional", "bundle", "test", "stage"}


def test_cmake_names_only_packages_that_are_stated():
    text = (SOURCE / "framework" / "cmake" / "KestrelDependencies.cmake").read_text()
    named = set(re.findall(r"\b(?:lib[a-z0-9]+|glslang|pybind11|python3)-dev\b", text))
    assert len(named) > 6
    assert named <= set(stated()), named - set(stated())


def test_what_may_be_absent_is_optional():
    text = (SOURCE / "framework" / "cmake" / "KestrelDependencies.cmake").read_text()
    optional = {name for call in re.findall(r"kestrel_optional\(([^)]*)\)", text) for name in re.findall(r"[\w.]+-dev", call)}
    # Fonts, and what Python imports, are looked for when the program runs.
    packages = {name for name, need in stated().items()
                if need == "optional" and not name.startswith("fonts-") and name != "python3-numpy"}
    assert optional == packages


# Of all files that are compiled, how many may include what takes a second or more to read, directly or by our headers, besides
# what is precompiled (glm.hpp, quaternion.hpp; gtest and gmock in tests). More means a header of ours that brings it along. (Of CLI11's
# files never all are compiled: no_studies.cpp stands for those in studies/.)
HEAVY = {"nlohmann/json.hpp": 65, "CLI/CLI.hpp": 14, "tiny_gltf.h": 10, "glm/gtc/matrix_transform.hpp": 65, "imgui.h": 30,
         "spdlog/spdlog.h": 1, "glslang/Public/ShaderLang.h": 1, "gtest/gtest.h outside of tests": 0}
PLACES = ["framework", "passes", "", "tests", "tests/gl", "apps/common", "apps/editor", "apps/kestrel"]


@cache
def included(file):
    """What a file of ours includes: files of ours, and names of others."""
    found = set()
    for mark, name in re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)', file.read_text(), re.M):
        own = [path for path in [file.parent / name, *(SOURCE / place / name for place in PLACES)] if path.is_file()]
        found.add(own[0].resolve() if mark == '"' and own else name)
    return found


def reached(file, seen):
    for item in included(file) - seen:
        seen.add(item)
        if not isinstance(item, str):
            reached(item, seen)
    return seen


def test_few_files_include_what_takes_long_to_compile():
    counts = Counter()
    for top in ["framework", "passes", "apps", "tests"]:
        for file in (SOURCE / top).rglob("*.cpp"):
            names = {item for item in reached(file.resolve(), set()) if isinstance(item, str)}
            if top != "tests" and "gtest/gtest.h" in names:
                names.add("gtest/gtest.h outside of tests")
            counts.update(names)
    assert counts["nlohmann/json.hpp"] > 20 and counts["gtest/gtest.h"] > 50, "the includes are not found"
    over = {name: f"{counts[name]} files, {most} may" for name, most in HEAVY.items() if counts[name] > most}
    assert not over, over


def test_the_readme_points_to_the_one_place():
    assert "apps/packages.txt" in (SOURCE / "README.md").read_text()


if __name__ == "__main__":
    run_tests(globals())
