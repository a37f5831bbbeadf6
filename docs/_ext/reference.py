"""Directives of the reference: tables written from the definitions, so that no page repeats them by hand.

=========================  ==================================================================
``case-keys``              every table of a case with its keys
``commands``               every command with its arguments, files and results
``result-variables``       every variable that a result may hold
``python-functions``       the analyses as Python functions
=========================  ==================================================================
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

import gallery
import typer.main
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from petalfoil.analysis import known_verbs
from petalfoil.analysis.arguments import Argument, Flag, Measured
from petalfoil.analysis.declaration import Analysis
from petalfoil.case import Case, keys
from petalfoil.case.definition import Definition
from petalfoil.cli.app import STUDIES, app
from petalfoil.cli.show import show_command
from petalfoil.cli.study_commands import study_command
from petalfoil.results import schema
from petalfoil.results.variable import Role, Variable

STUDY_FUNCTIONS = ("sweep", "tolerance", "optimize", "sobol_indices")
"""Functions that ask an analysis of many cases."""


class Written(SphinxDirective):
    """A directive that stands for Markdown, which `write` makes."""

    has_content = False

    def write(self) -> Iterator[str]:
        """Lines of Markdown."""
        raise NotImplementedError

    def run(self) -> list[nodes.Node]:
        """Read the Markdown as a part of the page."""
        text = "\n".join(self.write())
        return list(self.parse_text_to_nodes(text, allow_section_headings=True))


def table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """A table; columns that are empty in all rows are left out."""
    rows = list(rows)
    kept = [k for k in range(len(head)) if any(row[k] for row in rows)]
    if rows:
        yield from ("", _line(head[k] for k in kept), _line("---" for _ in kept))
        yield from (_line(row[k].replace("|", r"\|") for k in kept) for row in rows)
        yield ""


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def symbol_text(symbol: str) -> str:
    """A symbol as the definitions write it, in code font."""
    return f"`{symbol}`" if symbol else ""


# ---------------------------------------------------------------------------------------------- case


class CaseKeys(Written):
    """Every table of a case with its keys."""

    def write(self) -> Iterator[str]:
        """A section for each table."""
        head = ("key", "symbol", "unit", "range", "default", "meaning")
        yield from table(head, map(_cells, keys.keys(Case)))
        for name, definition in keys.sections().items():
            yield f"(case-{name})="
            yield f"## `[{name}]`"
            yield ""
            yield inspect.getdoc(definition) or ""
            yield from table(head, map(_cells, own_keys(name, definition)))
            if name == "rotor":
                yield SECOND


SECOND = """The tables `rotor.second.bearing`, `shaft`, `bushing`, `petals`, `bump_foil`, `gas`, `heat`, `surface` and
`model` have the keys of the tables of these names on this page, and replace those of the first bearing
([two bearings on one shaft](../how-to/running-bearing.md#two-bearings-on-one-shaft)).
"""


def own_keys(name: str, definition: type[Definition]) -> Iterator[keys.Key]:
    """Keys of a table; those of the tables that a second bearing may replace are not told again."""
    for key in keys.keys(definition, f"{name}."):
        if not (key.name.startswith("rotor.second.") and key.name.count(".") > 2):
            yield key


def _cells(key: keys.Key) -> tuple[str, ...]:
    return f"`{key.name}`", symbol_text(key.symbol), key.unit, key.allowed, key.default, key.meaning


# ---------------------------------------------------------------------------------------------- commands


class Commands(Written):
    """Every command with its arguments and results."""

    def write(self) -> Iterator[str]:
        """A section for each command."""
        for verb in known_verbs.summaries():
            analysis = known_verbs.find(verb)
            assert analysis is not None
            yield from _analysis(analysis)
        group: Any = typer.main.get_command(app)
        studies = {name: study_command(name, []) for name in STUDIES}
        studies["sensitivity --samples"] = study_command("sensitivity", [])
        for name, command in {"show": show_command(), **studies, **group.commands}.items():
            yield from _heading(name, command.help)
            yield from _parameters(command)
            for inner, part in getattr(command, "commands", {}).items():
                yield from _heading(f"{name} {inner}", part.help)
                yield from _parameters(part)


def _heading(verb: str, text: str) -> Iterator[str]:
    """The help text, with the example as a command."""
    yield f"(command-{verb.replace(' ', '-')})="
    yield f"## `petalfoil {verb}`"
    yield ""
    words, _, example = text.partition("Example:")
    yield _options(words)
    if example:
        yield from ("```console", f"$ {' '.join(example.split())}", "```", "")


def _analysis(analysis: Analysis) -> Iterator[str]:
    yield from _heading(analysis.verb, analysis.help)
    rows = [_argument(analysis, name, argument) for name, argument in analysis.arguments.items()]
    yield from table(("option", "in Python", "unit", "range", "default", "meaning"), rows)
    files = [(f"`--{e.option} {e.metavar}`", ", ".join(e.suffixes), _text(e.help)) for e in analysis.exports]
    yield from table(("file", "suffix", "holds"), files)
    yield from _results(analysis)


def _argument(analysis: Analysis, name: str, argument: Argument) -> tuple[str, ...]:
    default = analysis.default(name)
    if default is inspect.Parameter.empty:
        given = "required"
    else:
        given = "–" if default in (None, False) else argument.text(default)
    unit = getattr(argument, "unit", "")
    bounds = argument.bounds(unit) if isinstance(argument, Measured) else ""
    option = argument.option_name(name) + ("" if isinstance(argument, Flag) else f" {argument.metavar}")
    return f"`{option}`", f"`{name}`", unit, bounds, given, _text(argument.help)


def _results(analysis: Analysis) -> Iterator[str]:
    """What a result holds: names as in JSON and files, read from the run of the gallery."""
    found = gallery.results_of(analysis.verb)
    if found is None:
        return
    known = {name: schema.VARIABLES[name] for name in found if name in schema.VARIABLES}
    answers = {name: variable for name, variable in known.items() if variable.role is Role.ANSWER}
    yield ":::{dropdown} Results"
    rows = [_variable(name, variable, found[name]) for name, variable in answers.items()]
    yield from table(("name", "dimensions", "unit", "meaning"), rows)
    others = sorted(set(known) - set(answers))
    yield f"Given, geometry and bookkeeping: {', '.join(f'`{name}`' for name in others)}."
    yield ":::"
    yield ""


def _parameters(command: Any) -> Iterator[str]:
    rows = [
        (f"`{', '.join(p.opts) if p.opts[0].startswith('-') else p.metavar}`", _text(p.help or ""))
        for p in command.params
    ]
    yield from table(("option", "meaning"), rows)


def _text(words: str) -> str:
    """Help text on one line; quoted values and options in code font."""
    return re.sub(r'"([^"]+)"', r"`\1`", _options(" ".join(words.split())))


def _options(words: str) -> str:
    """Help text with options in code font."""
    return re.sub(r"(?<![\w`])(--[a-z][a-z0-9-]*)", r"`\1`", words)


# ---------------------------------------------------------------------------------------------- results


def _variable(name: str, variable: Variable, dims: Iterable[str]) -> tuple[str, ...]:
    return f"`{name}`", ", ".join(dims), symbol_text(variable.units) or "–", variable.long_name


class ResultVariables(Written):
    """Variables that a result may hold, of one kind."""

    required_arguments = 1
    KINDS: ClassVar[dict[str, dict[str, Variable]]] = {
        "coordinates": schema.COORDINATES,
        "fields": {name: v for name, v in schema.FIELDS.items() if name not in schema.HISTORIES},
        "histories": schema.HISTORIES,
    }

    def write(self) -> Iterator[str]:
        """A table with symbols, units and dimensions."""
        for verb in known_verbs.summaries():
            known_verbs.find(verb)  # declares results of its own
        kind = self.arguments[0]
        chosen = self.KINDS.get(kind) or {n: v for n, v in schema.SCALARS.items() if v.role.value == kind}
        rows = [
            (f"`{name}`", symbol_text(v.symbol), symbol_text(v.units) or "–", ", ".join(v.dims), v.long_name)
            for name, v in chosen.items()
        ]
        yield from table(("name", "symbol", "unit", "dimensions", "meaning"), rows)


# ---------------------------------------------------------------------------------------------- Python


class PythonFunctions(Written):
    """The analyses as Python functions."""

    def write(self) -> Iterator[str]:
        """A description of each, by autodoc."""
        for verb in known_verbs.summaries():
            analysis = known_verbs.find(verb)
            assert analysis is not None
            yield from ("```{eval-rst}", f".. autofunction:: petalfoil.{verb}{_call(analysis)}", "```", "")
        for study in STUDY_FUNCTIONS:
            yield from ("```{eval-rst}", f".. autofunction:: petalfoil.{study}", "```", "")


def _call(analysis: Analysis) -> str:
    """The signature without types: units and ranges stand in the text."""
    parameters = [one.replace(annotation=one.empty) for one in analysis.signature.parameters.values()]
    return str(analysis.signature.replace(parameters=parameters, return_annotation=inspect.Signature.empty))


# ---------------------------------------------------------------------------------------------- formulas


def number_equations(site: Sphinx, doctree: nodes.document) -> None:
    """Let formulas with rows keep their label: Sphinx would wrap them in `split`, which takes none."""
    for formula in doctree.findall(nodes.math_block):
        text = formula.astext()
        if r"\tag" in text and r"\\" in text:
            formula["no-wrap"] = True
            formula.children = [nodes.Text(f"\\begin{{equation}}\n{text}\n\\end{{equation}}")]


def setup(site: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    site.connect("doctree-read", number_equations)
    site.add_directive("case-keys", CaseKeys)
    site.add_directive("commands", Commands)
    site.add_directive("result-variables", ResultVariables)
    site.add_directive("python-functions", PythonFunctions)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
