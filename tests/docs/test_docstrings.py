"""Docstrings name what the signature names and quote equations that exist. Ruff's D rules see that there are any."""

from __future__ import annotations

import ast
import re

from tests.docs.texts import DOCS, definitions, docstrings, labels_in, modules, name_of, text, theory_labels, tree

# ---------------------------------------------------------------------------------------------- equations


def test_the_labels_of_the_theory_are_unique_and_numbered_in_order() -> None:
    labels = theory_labels()
    assert len(labels) > 20
    assert len(set(labels)) == len(labels)
    for letter in {label[0] for label in labels}:
        numbers = [int(label[1:]) for label in labels if label[0] == letter]
        assert numbers == list(range(1, len(numbers) + 1)), letter


def test_every_equation_a_docstring_quotes_is_in_the_theory() -> None:
    known = set(theory_labels())
    quoted = {name_of(path): set().union(*map(labels_in, docstrings(path))) for path in modules()}
    assert {name: labels - known for name, labels in quoted.items() if labels - known} == {}


def test_the_code_quotes_the_equations_of_the_film_the_shell_and_the_coupled_system() -> None:
    quoted = {label for path in modules() for words in docstrings(path) for label in labels_in(words)}
    wanted = {"F1", "F2", "F3", "F4", "F5", "S4", "C1", "C2", "C3", "C4", "P2", "T1", "R1", "E2", "K1", "J1", "G3"}
    assert wanted - quoted == set()


def test_every_work_the_code_cites_is_among_the_references() -> None:
    references = text(DOCS / "theory.md").partition("## References")[2].lower()
    cited = {doi.rstrip(".") for path in modules() for doi in re.findall(r"doi:(10\.\d+/[^\s)\]\"`:;,]+)", text(path))}
    assert cited
    assert {doi for doi in cited if doi.lower() not in references} == set()


# ---------------------------------------------------------------------------------------------- parameters


def documented_parameters(words: str) -> list[str]:
    """Names under the heading "Parameters" of a docstring, as `inspect.cleandoc` leaves it."""
    heading = re.search(r"^Parameters\n-+\n", words, re.MULTILINE)
    if heading is None:
        return []
    section = re.split(r"^\S.*\n-{3,}$", words[heading.end() :], maxsplit=1, flags=re.MULTILINE)[0]
    entries = re.findall(r"^(\*{0,2}\w[\w, *]*?)(?: : .*)?$", section, re.MULTILINE)
    return [name.strip() for entry in entries for name in entry.split(",")]


def signature(node: ast.ClassDef | ast.FunctionDef) -> set[str]:
    """Names that a caller may give: arguments of a function, or of a class's `__init__`; else its annotated fields."""
    if isinstance(node, ast.ClassDef):
        made = [child for child in node.body if isinstance(child, ast.FunctionDef) and child.name == "__init__"]
        if made:
            return signature(made[0])
        return {item.target.id for item in node.body if isinstance(item, ast.AnnAssign) and is_name(item.target)}
    every = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    names = {argument.arg for argument in every} - {"self", "cls"}
    names |= {f"*{node.args.vararg.arg}"} if node.args.vararg else set()
    return names | ({f"**{node.args.kwarg.arg}"} if node.args.kwarg else set())


def is_name(node: ast.expr) -> bool:
    """A plain name: `field: float`, not `self.field: float`."""
    return isinstance(node, ast.Name)


def test_documented_parameters_are_those_of_the_signature() -> None:
    unknown = {
        (name_of(path), name): surplus
        for path in modules()
        for name, node in definitions(tree(path))
        if (surplus := set(documented_parameters(ast.get_docstring(node) or "")) - signature(node))
    }
    assert unknown == {}


def test_the_reader_of_parameters_reads() -> None:
    parameters = "Parameters\n----------\na, b : (n,) array\n    Two.\n**more\n    Rest."
    words = f"Do.\n\n{parameters}\n\nReturns\n-------\nfloat\n    One."
    assert documented_parameters(words) == ["a", "b", "**more"]
    (node,) = ast.parse("def f(self, a, *, b, **more): ...").body
    assert isinstance(node, ast.FunctionDef)
    assert signature(node) == {"a", "b", "**more"}
