"""The conda recipe, as far as it can be tried without a conda channel: read, build script, installed files, tests.

rattler-build's own reader takes the recipe and renders it. Its build script then runs in an empty environment that has
the requirements of `host` alone, what it installs is put into another that has those of `run` alone, as a conda package
is, and the tests of the recipe run there. Packages come from PyPI under their names there.

    python .ci/recipe.py [FOLDER]       FOLDER: where the environments go, a temporary one by default
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path
from typing import Any

from rattler_build import Stage0Recipe, VariantConfig

ROOT = Path(__file__).resolve().parents[1]
RECIPE = ROOT / "packaging" / "conda" / "recipe.yaml"
ON_PYPI = {"matplotlib-base": "matplotlib"}
"""Packages that conda-forge calls otherwise, but for case and hyphens."""

ENTRY = "#!{python}\nimport sys\nfrom {module} import {function}\nsys.exit({function}())\n"
"""What conda writes for an entry point of a package without architecture."""


def rendered() -> dict[str, Any]:
    """The recipe as rattler-build understands it; an unknown field or version is an error."""
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    (variant,) = Stage0Recipe.from_file(str(RECIPE)).render(VariantConfig.from_yaml(f'python: ["{python}"]\n'), None)
    return dict(variant.recipe.to_dict())


def environment(folder: Path, requirements: list[str]) -> Path:
    """The Python of an environment with some requirements of the recipe, which come from PyPI, and pip."""
    venv.create(folder, with_pip=True)
    wanted = [one.split(" ", 1) for one in requirements if one.split(" ")[0] not in ("python", "pip")]
    names = [f"{ON_PYPI.get(name, name)}{''.join(versions)}" for name, *versions in wanted]
    python = folder / "bin" / "python"
    run([str(python), "-m", "pip", "install", "--quiet", "--no-compile", "--disable-pip-version-check", *names])
    return python


def run(command: list[str] | str, **options: Any) -> None:
    """Run a command of the recipe; one that fails ends this script."""
    subprocess.run(command, check=True, shell=isinstance(command, str), **options)


def build(recipe: dict[str, Any], python: Path, folder: Path) -> None:
    """Run the build script on a copy of the sources."""
    work = folder / "work"
    (source,) = recipe["source"]
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True)
    for name in tracked.stdout.split("\0"):
        if name and (RECIPE.parent / source["path"] / name).is_file():
            (work / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(RECIPE.parent / source["path"] / name, work / name)
    for name in recipe["about"]["license_file"]:
        assert (work / name).is_file(), name
    script = recipe["build"]["script"].replace("${{ PYTHON }}", str(python))
    run(script, cwd=work, stdout=subprocess.DEVNULL)


def install(recipe: dict[str, Any], host: Path, python: Path) -> None:
    """Put what the build installed, and the entry points of the recipe, into the other environment."""
    name = recipe["package"]["name"]
    packages = [next(one.parents[1].glob("lib/python*/site-packages")) for one in (host, python)]
    installed = sorted(packages[0].glob(f"{name}*"))
    assert [one.name for one in installed] == [name, f"{name}-{recipe['package']['version']}.dist-info"]
    for one in installed:
        shutil.copytree(one, packages[1] / one.name)
    for point in recipe["build"]["python"]["entry_points"]:
        command, _, place = point.partition(" = ")
        module, _, function = place.partition(":")
        file = python.parent / command
        file.write_text(ENTRY.format(python=python, module=module, function=function), encoding="utf-8")
        file.chmod(0o755)


def check(recipe: dict[str, Any], python: Path, folder: Path) -> None:
    """Run the tests of the recipe in a folder without the sources; `pip check` is among them unless it is off."""
    surroundings = dict(os.environ, PATH=f"{python.parent}{os.pathsep}{os.environ['PATH']}")
    options: dict[str, Any] = {"cwd": folder, "env": surroundings, "stdout": subprocess.DEVNULL}
    for test in recipe["tests"]:
        for module in test.get("python", {}).get("imports", []):
            run([str(python), "-c", f"import {module}"], **options)
        if "python" in test and test["python"].get("pip_check", True):
            run([str(python), "-m", "pip", "check"], **options)
        for command in test.get("script", []):
            run(command, **options)


def main() -> None:
    """Try the recipe."""
    recipe = rendered()
    with tempfile.TemporaryDirectory(dir=sys.argv[1] if len(sys.argv) > 1 else None) as temporary:
        folder = Path(temporary)
        host = environment(folder / "host", recipe["requirements"]["host"])
        build(recipe, host, folder)
        python = environment(folder / "run", recipe["requirements"]["run"])
        install(recipe, host, python)
        (folder / "tests").mkdir()
        check(recipe, python, folder / "tests")
    print(f"conda recipe: rendered, built, its {len(recipe['tests'])} tests pass on Python {sys.version.split()[0]}")


if __name__ == "__main__":
    main()
