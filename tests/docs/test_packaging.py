"""Version, requirements and citation are told alike everywhere."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

import petalfoil
from tests.docs.texts import ROOT, text

PROJECT: dict[str, Any] = tomllib.loads(text(ROOT / "pyproject.toml"))["project"]
RECIPE = text(ROOT / "packaging" / "conda" / "recipe.yaml")
IN_CONDA = {"matplotlib": "matplotlib-base", "tomli_w": "tomli-w"}
"""Packages that conda-forge calls otherwise."""


def test_the_version_stands_in_one_place() -> None:
    assert "version" in PROJECT["dynamic"]
    assert f"\nversion: {petalfoil.__version__}\n" in text(ROOT / "CITATION.cff")
    assert f"\n  version: {petalfoil.__version__}\n" in RECIPE


def test_the_recipe_requires_what_the_package_requires() -> None:
    (block,) = re.findall(r"^  run:\n((?:    - .*\n)+)", RECIPE, re.MULTILINE)
    told = {tuple(line.strip("- ").split()) for line in block.splitlines()} - {("python", ">=3.11")}
    wanted = set()
    for requirement in PROJECT["dependencies"]:
        name, versions = re.match(r"([\w-]+)(.*)", requirement).groups()  # type: ignore[union-attr]
        wanted.add((IN_CONDA.get(name, name.lower()), versions))
    assert told == wanted


def test_everybody_cites_the_paper() -> None:
    zenodo = json.loads(text(ROOT / ".zenodo.json"))
    doi = zenodo["related_identifiers"][0]["identifier"]
    assert doi in text(ROOT / "CITATION.cff")
    assert doi in text(ROOT / "README.md")
    assert doi in PROJECT["urls"]["Paper"]
    assert zenodo["license"] == PROJECT["license"]


def test_every_extra_stands_on_the_page_of_installation() -> None:
    told = set(re.findall(r"`petalfoil\[(\w+)\]`", text(ROOT / "docs" / "start" / "install.md")))
    assert told == set(PROJECT["optional-dependencies"])
