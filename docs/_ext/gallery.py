"""Figures of the gallery's scripts for sphinx-gallery, and what their results hold for the reference of commands."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

RESULTS = Path(__file__).parents[1] / "gallery" / "results"
"""Names of the results of each analysis, as its script in the gallery left them."""


def scraper(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any], **_: Any) -> str:
    """Write the figures that a block of a script has made, and the names of the results it holds.

    Figures of petalfoil are not those of pyplot, which sphinx-gallery looks for: they are the variables of a script.

    Raises
    ------
    ValueError
        The variable `result` of the script holds a state that did not converge: the build ends.
    """
    names = block_vars["example_globals"]
    result = names.get("result")
    if isinstance(result, xr.Dataset) and "converged" in result and not bool(result["converged"].all()):
        raise ValueError(f"{block_vars['src_file']}: a result that did not converge is not shown")
    seen = names.setdefault("__shown__", [])
    figures = [value for value in names.values() if isinstance(value, Figure) and value not in seen]
    seen.extend(figures)
    paths = []
    for figure, path in zip(figures, block_vars["image_path_iterator"], strict=False):
        figure.savefig(path, dpi=100)
        paths.append(path)
    for value in names.values():
        if isinstance(value, xr.Dataset):
            _remember(value)
    return str(figure_rst(paths, gallery_conf["src_dir"]))


def results_of(verb: str) -> dict[str, list[str]] | None:
    """Variables of a result of an analysis, each with its dimensions; None if no script of the gallery calls it."""
    path = RESULTS / f"{verb}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def _remember(result: xr.Dataset) -> None:
    RESULTS.mkdir(parents=True, exist_ok=True)
    variables = {str(name): [str(dim) for dim in variable.dims] for name, variable in result.variables.items()}
    path = RESULTS / f"{result.attrs['analysis']}.json"
    before = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    path.write_text(json.dumps(before | variables), encoding="utf-8")
