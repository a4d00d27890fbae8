"""Installed packages, in an environment of the test's own."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from industnerf.doctor.environment import normalize_name, parse_pins

CHECK_SCRIPT = """
import sys
from pathlib import Path
from industnerf.doctor.environment import check
from industnerf.doctor.project_paths import ProjectPaths
for finding in check(ProjectPaths(Path.cwd(), Path.cwd(), Path.cwd())):
    print(finding.message)
    print(finding.fix)
"""


@pytest.fixture
def wheels(tmp_path: Path) -> Path:
    """A folder with two small packages, one of them in two versions."""
    folder = tmp_path / "wheels"
    folder.mkdir()
    for name, version in (("steel", "1.0"), ("steel", "2.0"), ("iron_ore", "3.0")):
        info = f"{name}-{version}.dist-info"
        with zipfile.ZipFile(folder / f"{name}-{version}-py3-none-any.whl", "w") as wheel:
            wheel.writestr(
                f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
            )
            wheel.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nTag: py3-none-any\n")
            wheel.writestr(f"{info}/RECORD", "")
    return folder


class Environment:
    """A virtual environment and a project that wants two packages in it."""

    def __init__(self, folder: Path, wheels: Path, root: Path) -> None:
        subprocess.run([sys.executable, "-m", "venv", str(folder / "env")], check=True)
        (folder / "constraints.txt").write_text("iron-ore==3.0\nsteel==2.0 ; sys_platform != 'x'\n")
        (folder / "pyproject.toml").write_text(
            '[project]\nname = "x"\nversion = "1"\ndependencies = ["steel>=1", "Iron.Ore"]\n'
        )
        self.folder, self.python = folder, folder / "env/bin/python"
        offline = {"PIP_NO_INDEX": "1", "UV_NO_INDEX": "1"}
        offline |= {"PIP_FIND_LINKS": str(wheels), "UV_FIND_LINKS": str(wheels)}
        # rich and omegaconf are not in there, but the check needs neither
        self.environment = {**os.environ, **offline, "PYTHONPATH": str(root / "src")}

    def run(self, *command: str) -> str:
        return subprocess.run(
            command,
            cwd=self.folder,
            env=self.environment,
            check=True,
            capture_output=True,
            text=True,
        ).stdout

    def check(self) -> list[str]:
        return self.run(str(self.python), "-c", CHECK_SCRIPT).splitlines()


def test_other_versions_and_missing_packages_are_found_and_mended(
    tmp_path: Path, wheels: Path, root: Path
):
    environment = Environment(tmp_path, wheels, root)
    environment.run(str(environment.python), "-m", "pip", "install", "-q", "steel==1.0")
    message, fix = environment.check()
    assert message == "steel is 1.0, not 2.0; iron-ore is missing"
    environment.run("bash", "-c", fix)
    assert environment.check() == []


def test_an_install_that_was_cut_off_is_found_and_mended(tmp_path: Path, wheels: Path, root: Path):
    """Whatever it left of METADATA; and the rest is checked all the same."""
    environment = Environment(tmp_path, wheels, root)
    environment.run(str(environment.python), "-m", "pip", "install", "-q", "steel==2.0")
    (info,) = tmp_path.glob("env/lib/python*/site-packages/steel-2.0.dist-info")
    for left in (None, b"", b"Metadata-Version: 2.1\nName: steel\n", b"Name: \xc3"):
        (info / "METADATA").unlink()  # never written to: it may be a link to uv's cache
        if left is not None:
            (info / "METADATA").write_bytes(left)
        truncated, fix, other, _ = environment.check()
        assert truncated == "is no whole package with a name and a version: an install was cut off"
        assert fix.startswith(f"rm -rf {info.relative_to(tmp_path)} && ")
        assert other == "iron-ore is missing"
        environment.run("bash", "-c", fix)
        assert environment.check()[0] == "iron-ore is missing"


def test_what_is_left_of_a_package_that_is_not_pinned_goes(
    tmp_path: Path, wheels: Path, root: Path
):
    """pip calls it so while it takes a package away; what it is cannot be installed by name."""
    environment = Environment(tmp_path, wheels, root)
    environment.run(str(environment.python), "-m", "pip", "install", "-q", "steel", "iron-ore")
    (info,) = tmp_path.glob("env/lib/python*/site-packages/steel-2.0.dist-info")
    shutil.copytree(info, set_aside := info.with_name("~teel-1.0.dist-info"))
    (set_aside / "METADATA").write_text("Metadata-Version: 2.1\nName: steel\nVersion: 1.0\n")
    _, fix = environment.check()
    environment.run("bash", "-c", fix)
    assert environment.check() == []
    assert info.exists()


def test_a_pin_may_depend_on_the_python():
    text = "# made by uv\nnumpy==2.4.6 ; python_full_version < '3.12'\nNumPy==2.5.5\nrich==14.0\n"
    assert parse_pins(text) == {"numpy": ["2.4.6", "2.5.5"], "rich": ["14.0"]}


def test_the_constraints_of_the_suite_pin_every_dependency(root: Path):
    pinned = parse_pins((root / "constraints.txt").read_text())
    assert {"torch", "dvc", "mlflow", "pot"} <= set(pinned)


def test_every_python_gets_the_same_libraries(root: Path):
    pinned = parse_pins((root / "constraints.txt").read_text())
    assert {name: versions for name, versions in pinned.items() if len(versions) > 1} == {}


def test_names_are_compared_as_packages_are():
    assert normalize_name("Py_YAML") == normalize_name("py.yaml") == normalize_name("py-yaml")
