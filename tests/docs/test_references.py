"""What the pages name is there: files, folders, commands, options, case keys, names of the code, equations."""

from __future__ import annotations

import importlib
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer.main

from petalfoil.analysis import known_verbs
from petalfoil.analysis.sensitivity_table import RESULTS
from petalfoil.case import Case
from petalfoil.cli.app import STUDIES, app
from petalfoil.cli.commands import command_of
from petalfoil.cli.show import show_command
from petalfoil.cli.study_commands import study_command
from tests.docs.texts import DOCS, ROOT, SOURCE, labels_in, modules, name_of, pages, text, theory_labels

FILE = re.compile(r"[\w<>.-]*/[\w<>./-]*|[\w<>-]+\.(?:py|md|toml|csv|json)")
OF_THE_READER = {"case.toml", "index.html", "report.json", "result.nc", "study.toml", "table.csv", "figures/"}
OF_THE_READER |= {"fields/", "designs/", "build/docs", "build/fuzz.jsonl"}
"""Files that a reader makes."""

PLACES = (ROOT, SOURCE, ROOT / "examples", DOCS)
"""Where a path may begin."""


def every_page() -> list[Path]:
    """README, the guide for contributors and the documentation."""
    return [ROOT / "README.md", *pages()]


def quoted(page: Path) -> set[str]:
    """What stands in code font on a page."""
    return set(re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text(page), flags=re.MULTILINE | re.DOTALL)))


def offenders(check: object) -> list[tuple[str, str]]:
    """Page and item of everything that `check`, a function of a page, finds."""
    assert callable(check)
    return [(name_of(page), item) for page in every_page() for item in sorted(check(page))]


# ---------------------------------------------------------------------------------------------- files


def is_there(path: str, page: Path) -> bool:
    """Whether a path exists from one of the places, or a bare file name anywhere in the code; `<name>` is any."""
    pattern = re.sub(r"<\w+>", "*", path.rstrip("/"))
    if any(list(place.glob(pattern)) for place in (*PLACES, page.parent)):
        return True
    return "/" not in pattern and any(SOURCE.rglob(pattern))


def missing_files(page: Path) -> set[str]:
    """Paths on a page that lead nowhere."""
    named = {item for item in quoted(page) if FILE.fullmatch(item)} - OF_THE_READER
    return {path for path in named if not is_there(path, page)}


def test_files_and_folders_exist() -> None:
    assert offenders(missing_files) == []


def test_scripts_in_commands_exist() -> None:
    named = {
        (name_of(page), script)
        for page in every_page()
        for script in re.findall(r"^ +(?:\$ )?python (\S+\.py)", text(page), re.MULTILINE)
    }
    assert len(named) >= 4
    assert [(page, script) for page, script in named if not (ROOT / script).exists()] == []


# ---------------------------------------------------------------------------------------------- commands


@cache
def commands() -> dict[str, Any]:
    """Commands of the program by name."""
    group: Any = typer.main.get_command(app)
    verbs = {verb: command_of(verb) for verb in known_verbs.summaries()}
    studies = {name: study_command(name, []) for name in STUDIES}
    sampled = {"sensitivity --samples": study_command("sensitivity", [])}
    return {**group.commands, **verbs, "show": show_command(), **studies, **sampled}


@cache
def options() -> set[str]:
    """Options of the program, its commands, the benchmarks and the runs of random bearings."""
    group: Any = typer.main.get_command(app)
    inner = [part for command in commands().values() for part in getattr(command, "commands", {}).values()]
    every = [parameter for command in (group, *commands().values(), *inner) for parameter in command.params]
    found = {name for parameter in every for name in (*parameter.opts, *parameter.secondary_opts)}
    scripts = ("benchmarks/run.py", "benchmarks/studies.py", "tests/fuzz.py", "tests/fuzz_verbs.py")
    of_scripts = [text(ROOT / name) for name in scripts]
    return found | {"--help"} | set(re.findall(r'"(--[a-z-]+)"', " ".join(of_scripts)))


OF_DASK = {"--nthreads", "--nworkers", "--port"}
"""Options of `dask scheduler` and `dask worker`."""


def unknown_options(page: Path) -> set[str]:
    """Options on a page that no command takes."""
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text(page))) - options() - OF_DASK


def unknown_commands(page: Path) -> set[str]:
    """Commands on a page that the program does not have."""
    called = re.findall(r"(?:`|^ +|^\$ )petalfoil ([a-z]+)", text(page), re.MULTILINE)
    return set(called) - set(commands())


def test_options_exist() -> None:
    assert {"--error", "--ramp", "--only", "--version"} <= options()
    assert offenders(unknown_options) == []


def test_commands_exist() -> None:
    assert offenders(unknown_commands) == []


# ---------------------------------------------------------------------------------------------- names


def unknown_case_keys(page: Path) -> set[str]:
    """Dotted keys on a page that no case has."""
    found = set()
    for item in quoted(page):
        section, dot, key = item.partition(".")
        field = Case.model_fields.get(section)
        if dot and field is not None and key.isidentifier() and not known_key(section, key):
            found.add(item)
    return found


def known_key(section: str, key: str) -> bool:
    """Whether a section of a case has a key."""
    annotation = Case.model_fields[section].annotation
    kinds = [annotation, *getattr(annotation, "__args__", ())]
    return any(key in getattr(kind, "model_fields", {}) for kind in kinds)


def unknown_python(page: Path) -> set[str]:
    """Dotted names of the package on a page that do not import."""
    named = re.findall(r"`(petalfoil(?:\.[A-Za-z_]\w*)+)", text(page))
    return {name for name in named if not imports(name)}


def imports(name: str) -> bool:
    """Whether a dotted name is a module, or an attribute of one."""
    owner, _, last = name.rpartition(".")
    try:
        importlib.import_module(name)
    except ImportError:
        return bool(owner) and hasattr(importlib.import_module(owner), last)
    return True


@cache
def words_of_the_code() -> set[str]:
    """Every word of the code, the benchmarks and the examples, and results whose names the code puts together."""
    files = [*modules(), *(ROOT / "benchmarks").glob("*.py"), *(ROOT / "examples").glob("*.py")]
    return {word for path in files for word in re.findall(r"[A-Za-z_]\w*", text(path))} | set(RESULTS)


FOREIGN = {"BearingElement", "assert_allclose"}
"""Names of other programs."""


def unknown_names(page: Path) -> set[str]:
    """Names in code font that nothing in the code is called."""
    dotted = {part for item in quoted(page) if re.fullmatch(r"[A-Za-z_][\w.]*", item) for part in item.split(".")}
    named = {part for part in dotted if re.search(r"_|[a-z][A-Z]|^[A-Z][a-z]{3}", part) and not part.endswith("_")}
    return {part for part in named - words_of_the_code() - FOREIGN if f"{part}.toml" not in examples()}


@cache
def examples() -> set[str]:
    """File names of the examples."""
    return {path.name for path in (ROOT / "examples").iterdir()}


def test_case_keys_exist() -> None:
    assert offenders(unknown_case_keys) == []


def test_python_names_import() -> None:
    assert offenders(unknown_python) == []


def test_names_in_code_font_are_in_the_code() -> None:
    assert offenders(unknown_names) == []


# ---------------------------------------------------------------------------------------------- equations


def background() -> set[str]:
    """Labels that the theory declares as background."""
    (line,) = re.findall(r"^Background, quoted by no code: (.*)\.$", text(DOCS / "theory.md"), re.MULTILINE)
    return labels_in(line)


def test_every_equation_is_quoted_by_the_code_or_background() -> None:
    by_code = set().union(*(labels_in(text(path)) for path in modules()))
    assert set(theory_labels()) - by_code == background()


# ---------------------------------------------------------------------------------------------- layers


def layers() -> list[str]:
    """Layers of the import contract, from above, without the entry point."""
    contracts = tomllib.loads(text(ROOT / "pyproject.toml"))["tool"]["importlinter"]["contracts"]
    (declared,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [re.sub(r"[() ]", "", layer) for layer in declared if "__main__" not in layer]


def test_the_layer_line_is_the_import_contract() -> None:
    (line,) = re.findall(r"^    (.* → .*)$", text(ROOT / "CONTRIBUTING.md"), re.MULTILINE)
    assert line.replace(" ", "").split("→") == layers()


def test_the_table_of_folders_is_the_tree() -> None:
    guide = text(ROOT / "CONTRIBUTING.md")
    table = guide[guide.index("| folder | holds |") : guide.index("`mesh` to `system`")]
    first = [row.split("|")[1] for row in table.splitlines()[2:] if row.startswith("|")]
    named = {name.removesuffix(".py") for cell in first for name in re.findall(r"`([^`]+)`", cell)}
    assert named == {name for layer in layers() for name in layer.split("|")}


# ---------------------------------------------------------------------------------------------- the searches


def test_the_searches_find(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "`solvers/nothing.py`, `petalfoil nothing`, --nothing, `model.nothing`, `petalfoil.nothing`, `no_thing`.",
        encoding="utf-8",
    )
    assert missing_files(page) == {"solvers/nothing.py"}
    assert unknown_commands(page) == {"nothing"}
    assert unknown_options(page) == {"--nothing"}
    assert unknown_case_keys(page) == {"model.nothing"}
    assert unknown_python(page) == {"petalfoil.nothing"}
    assert unknown_names(page) == {"no_thing"}


@pytest.mark.parametrize("words", ["`solvers/interior_point.py`", "`walls/<name>.py`", "`interior_point.py`", "`docs`"])
def test_the_search_for_files_leaves_what_is_there_alone(words: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(words, encoding="utf-8")
    assert missing_files(page) == set()
