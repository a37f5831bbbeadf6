"""Files of stiffness and damping for other programs: tables, XLTRC2, ROSS 2 and 3; and what they need to be asked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from petalfoil.analysis.arguments import Name, Whole
from petalfoil.analysis.file_exports import Export
from petalfoil.results.ross import check_axes, ross_frequencies


def check_ross(values: Mapping[str, Any], known_as: Mapping[str, str]) -> None:
    """Refuse speeds and frequencies that make no table for ROSS."""
    check_axes(values.get("speeds") or [], values.get("frequencies") or [], known_as=known_as)


def check_ross_synchronous(values: Mapping[str, Any], known_as: Mapping[str, str]) -> None:
    """Refuse speeds that make no table for ROSS 2, and frequencies without the speeds."""
    speeds = values.get("speeds") or []
    check_axes(speeds, values.get("frequencies", speeds), synchronous=True, known_as=known_as)


def fill_ross(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Whirl frequencies that tell the stability of a rotor in ROSS, where none are given."""
    speeds = values.get("speeds") or []
    if values.get("frequencies") is not None or not speeds or not min(speeds) > 0.0:
        return values
    return {**values, "frequencies": ross_frequencies(speeds)}


ROSS = {
    "node": Whole(
        metavar="NUMBER", help="Node of the rotor in ROSS that carries the bearing; 0 by default.", at_least=0
    ),
    "tag": Name(metavar="NAME", help="Name of the bearing in ROSS; that of the file by default."),
}
"""Settings of the exports for ROSS."""

EXPORTS = (
    Export(
        option="csv",
        metavar="FILE.csv",
        help="Write the coefficients as a table, units in its header.",
        suffixes=(".csv",),
        writer="petalfoil.results.export:write_csv",
    ),
    Export(
        option="xltrc",
        metavar="FILE.txt",
        help="Write the coefficients of synchronous whirl over speed for XLTRC2: for unbalance, not for stability.",
        suffixes=(".txt", ".csv"),
        writer="petalfoil.results.export:write_xltrc",
    ),
    Export(
        option="ross",
        metavar="FILE.toml",
        help="Write the coefficients for ROSS 3 over speed (5 or more) and whirl frequency: .toml or .json.",
        suffixes=(".toml", ".json"),
        writer="petalfoil.results.ross:write_ross",
        check=check_ross,
        fill=fill_ross,
        settings=ROSS,
    ),
    Export(
        option="ross2",
        metavar="FILE.toml",
        help="Write the coefficients of synchronous whirl for ROSS 2: for unbalance, not for stability.",
        suffixes=(".toml", ".json"),
        writer="petalfoil.results.ross:write_ross_synchronous",
        check=check_ross_synchronous,
        settings=ROSS,
    ),
)
