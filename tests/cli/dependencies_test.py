"""One place states the dependencies: what CMake asks for by a Debian package's name is in apps/packages.txt."""
import re

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
    named = set(re.findall(r"\b(?:lib[a-z0-9]+-dev|glslang-dev)\b", text))
    assert len(named) > 6
    assert named <= set(stated()), named - set(stated())


def test_what_may_be_absent_is_optional():
    text = (SOURCE / "framework" / "cmake" / "KestrelDependencies.cmake").read_text()
    optional = set(re.findall(r"kestrel_optional\([^)]*?(lib\S+-dev)\)", text))
    # Fonts are looked for when the program runs.
    packages = {name for name, need in stated().items() if need == "optional" and not name.startswith("fonts-")}
    assert optional == packages


def test_the_readme_points_to_the_one_place():
    assert "apps/packages.txt" in (SOURCE / "README.md").read_text()


if __name__ == "__main__":
    run_tests(globals())
