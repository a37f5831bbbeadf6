"""The report of a case as a page: what each part shows, the headline, inputs, and what to compute it again."""

from __future__ import annotations

import math
import platform
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version

import xarray as xr

from petalfoil import __version__, plot
from petalfoil.case import ModelKind
from petalfoil.case.keys import entries
from petalfoil.report import html
from petalfoil.report.case_results import LOAD_FACTORS, Part, Request, load_of, load_text
from petalfoil.report.page_tables import PageTable, of_answer
from petalfoil.results.rounding import without_rounding
from petalfoil.results.schema import VARIABLES
from petalfoil.results.seal import digest_of_data
from petalfoil.results.summary import cell, in_order
from petalfoil.results.variable import Role
from petalfoil.units.writing import format_quantity
from petalfoil.walls import Capability, wall_kind

LIBRARIES = ("numpy", "scipy", "xarray", "netCDF4", "pydantic")
"""Libraries whose version may change a last digit."""

MARGINS = (
    "load_y", "eccentricity_x", "eccentricity_y", "attitude_angle", "min_film_thickness", "peak_pressure",
    "contact_fraction", "max_bending_stress", "friction_torque", "stable",
)  # fmt: skip
"""Results beside each other for several loads."""

HEADLINE = (
    ("operating_point", "min_film_thickness"), ("operating_point", "contact_fraction"),
    ("operating_point", "max_bending_stress"), ("operating_point", "power_loss"), ("liftoff", "liftoff_speed"),
    ("stability", "critical_mass"), ("stability", "threshold_speed"),
)  # fmt: skip
"""Results at the top of the page: part and name."""


@dataclass(frozen=True)
class Picture:
    """A figure and what it shows."""

    image: str
    caption: str


@dataclass(frozen=True, kw_only=True)
class PageSection:
    """One part of the page."""

    name: str
    title: str
    refusal: str = ""
    failed: bool = False
    notes: tuple[str, ...] = ()
    figures: tuple[Picture, ...] = ()
    tables: tuple[PageTable, ...] = ()


def render(request: Request, parts: Sequence[Part], seconds: float, date: str) -> str:
    """The page as HTML."""
    by_name = {part.name: part for part in parts}
    sections = tuple(_sections(request, by_name))
    warnings = _warnings(parts)
    named = [(one.name, one.title) for one in sections]
    first = [("warnings", "Warnings")] if warnings else []
    last = [("inputs", "Inputs and assumptions"), ("accuracy", "Accuracy"), ("again", "To compute it again")]
    return (
        html.templates()
        .get_template("case.html")
        .render(
            title=request.case.title or "Bearing without a title",
            version=__version__,
            date=date,
            seconds=format_quantity(seconds, "s", digits=2),
            sections=[*first, *named, *last],
            headline=[row for part, name in HEADLINE for row in _headline(by_name.get(part), name)],
            warnings=warnings,
            parts=sections,
            entries=list(entries(request.case)),
            limits=list(_limits(request)),
            accuracy=list(_accuracy(request, parts)),
            files=[_file(part, part.dataset) for part in parts if part.dataset is not None],
            environment=[("Python", platform.python_version()), ("system", platform.platform()), *_versions()],
            toml=request.case.to_toml(),
        )
    )


# ---------------------------------------------------------------------------------------------- sections


def _sections(request: Request, parts: dict[str, Part]) -> Iterator[PageSection]:
    """The parts of the page in order; loads around the asked one stand together."""
    for name, part in parts.items():
        if name == "pack":
            yield _section(part, "The assembled foil pack at zero speed, and what follows from the case.")
        elif name == "operating_point":
            yield _operating_point(request, part)
            others = [parts[other] for other in parts if other.startswith("load_")]
            if others:
                yield _margins(part, others)
        elif name == "coefficients":
            whole = _section(part, "Stiffness and damping over whirl frequency, linearised about the operating point.")
            yield replace(whole, tables=tuple(one for one in whole.tables if one.head))  # the state stands above
        elif not name.startswith("load_"):
            yield _section(part, f"{part.title} of the operating point.")


def _section(part: Part, caption: str, notes: tuple[str, ...] = ()) -> PageSection:
    if part.dataset is None or part.answer is None:
        return PageSection(name=part.name, title=part.title, refusal=_reason(part), failed=part.is_failed)
    failures = " ".join(part.answer.failures())
    figures = () if failures else (Picture(html.image(plot.summary(part.dataset)), caption),)
    return PageSection(
        name=part.name,
        title=part.title,
        refusal=failures,
        failed=part.is_failed,
        notes=notes,
        figures=figures,
        tables=of_answer(part.answer),
    )


def _operating_point(request: Request, part: Part) -> PageSection:
    load, speed = load_of(request), request.case.operation.speed
    turning = f"Speed {cell('speed', speed).value} rpm"
    where = "position of the case" if load is None else f"load {load_text(load)}"
    return _section(part, f"{turning}, {where}: film, petals and contacts.", (f"{turning}, {where}.",))


def _margins(asked: Part, others: Sequence[Part]) -> PageSection:
    """Results under several loads beside each other."""
    ordered = sorted([*zip(LOAD_FACTORS, others, strict=True), (1.0, asked)], key=lambda one: one[0])
    heads, columns = [], []
    for factor, part in ordered:
        scalars = without_rounding(part.answer.records[-1]) if part.answer else {}
        heads.append(f"{factor:g} ×")
        columns.append({name: cell(name, scalars[name]).value for name in MARGINS if name in scalars})
    names = in_order(set().union(*columns))
    lines = [(cell(n, 0.0).label, *(column.get(n, "–") for column in columns), cell(n, 0.0).unit) for n in names]
    refusals = [f"{part.title}: {_reason(part)}" for part in others if part.refusal is not None]
    return PageSection(
        name="loads",
        title="Operating points under other loads",
        refusal=" ".join(refusals),
        failed=any(part.is_failed for part in others),
        notes=("Without error bars, on the grid of the case.",),
        tables=(PageTable(("load over the load above", *heads, ""), tuple(lines), left=(0, -1)),),
    )


def _reason(part: Part) -> str:
    """Why a part has no result, with what to do."""
    advice = getattr(part.refusal, "advice", "")
    return f"{part.refusal}" + (f" To try: {advice}." if advice else "")


# ---------------------------------------------------------------------------------------------- top and bottom


@dataclass(frozen=True)
class Headline:
    """A result at the top of the page."""

    label: str
    value: str


def _headline(part: Part | None, name: str) -> Iterator[Headline]:
    if part is None or part.answer is None or not part.answer.records[-1].converged:
        return
    scalars = without_rounding(part.answer.records[-1])
    if name not in scalars or math.isnan(float(scalars[name])):
        return
    row, why = cell(name, scalars[name]), str(scalars["status"]).removeprefix("converged; ").partition("; ")[0]
    is_bounded = math.isfinite(float(scalars[name]))
    yield Headline(row.label, f"{row.value} {row.unit}" if is_bounded else f"none: {why}")


def _warnings(parts: Iterable[Part]) -> list[str]:
    """Every warning once, in the order in which they came."""
    told = [text for part in parts if part.answer for text in (*part.answer.warnings, *part.remarks)]
    return list(dict.fromkeys(told))


def _limits(request: Request) -> Iterator[str]:
    """What the model leaves out, as far as it concerns this case."""
    case = request.case
    if case.model.kind is ModelKind.TWO_D:
        yield (
            "The film is that of an infinitely long bearing, without side leakage: bearing forces are upper bounds, "
            'far above those of a bearing shorter than its diameter. `model.kind = "3d"` computes the finite length.'
        )
    known = "the gas temperature that the case states" if case.heat is None else "a temperature from the heat network"
    yield f"The gas is ideal, the film isothermal at {known}, the flow laminar and without inertia."
    if not case.model.slip:
        yield "The gas does not slip at the walls (model.slip)."
    if wall_kind(case).can(Capability.RUBBING):
        yield (
            "Petals are thin elastic shells without mass. Sliding along each other dissipates nothing beyond what "
            "surface.petal_friction and petals.theory say, and no measurement has confirmed damping by dry friction."
        )
        yield "Petals are as the case describes them; the scatter of manufacture is not in these numbers."
    yield "Surfaces are smooth down to the contact film thickness; journal rubbing contributes torque only."
    yield "The rotor is rigid."


def _accuracy(request: Request, parts: Sequence[Part]) -> Iterator[str]:
    """What the error bars are, and the largest residuals."""
    if request.error:
        yield (
            "Error bars (±) are the estimated distance from the grid-converged value, from the grid of the case and "
            "two more. They do not contain errors of the model or of the inputs."
        )
    else:
        yield "These results have no error bars: leave --no-error out to get them, or run petalfoil converge."
    for name, meaning in (("residual", "residual"), ("mass_balance_error", "mass-balance error")):
        found = [float(ds[name].max()) for ds in _datasets(parts) if name in ds]
        if found:
            yield f"Largest {meaning} of all results: {max(found):.1e}."


def _datasets(parts: Iterable[Part]) -> list[xr.Dataset]:
    return [part.dataset for part in parts if part.dataset is not None]


def _file(part: Part, dataset: xr.Dataset) -> dict[str, str]:
    """A file, what computes it, and the checksum of its answers: times and counts of the run are no part of it."""
    names = [name for name in dataset.variables if (known := VARIABLES.get(str(name))) and known.role is Role.ANSWER]
    answers = xr.Dataset({name: (dataset[name].dims, dataset[name].values) for name in names})
    return {"name": f"{part.name}.nc", "command": part.command, "digest": digest_of_data(answers)[:16]}


def _versions() -> list[tuple[str, str]]:
    return [(name, version(name)) for name in LIBRARIES]
