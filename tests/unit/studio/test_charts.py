"""Charts show the numbers of the result, as plain JSON, and only the view in space needs WebGL."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis import known_verbs
from petalfoil.case import Case, ModelKind
from petalfoil.case import toml as case_toml
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.studio.charts import chart_of, film_chart, is_drawn, map_chart, space_chart, unit_of, usual_axes
from petalfoil.studio.downloads import csv_of
from petalfoil.studio.protocol import FoundAnswer, Mapped, Work, WorkerTask
from petalfoil.studio.results_panel import rows_of
from petalfoil.studio.section_chart import has_section, section_chart
from petalfoil.studio.study_tasks import MOST_CASES
from petalfoil.studio.tasks import MOST_UNKNOWNS, coarse, found_analysis, perform, stored_answer
from petalfoil.studio.themes import DARK, LIGHT
from tests.cases import case, tables


def task(verb: str = "balance", arguments: dict[str, Any] | None = None, **changes: Any) -> WorkerTask:
    """A task on a small grid of the paper's eight petals under 15 N."""
    data = tables("paper_n8")
    data["operation"] = {"speed": "8000 rad/s", "load": "15 N"}
    data["model"] |= {"cells_per_pitch": 16}
    for path, value in changes.pop("keys", {}).items():
        section, _, key = path.partition(".")
        data[section][key] = value
    text = case_toml.write(data)
    return WorkerTask(number=1, work=Work.ANSWER, verb=verb, case_toml=text, arguments=arguments or {}, **changes)


def found(*given: Any, **named: Any) -> FoundAnswer:
    answer = perform(task(*given, **named), lambda part, text: None)
    assert isinstance(answer, FoundAnswer)
    return answer


@pytest.fixture(scope="module")
def state() -> FoundAnswer:
    return found()


def test_an_answer_agrees_with_the_analysis_itself(state: FoundAnswer) -> None:
    balance = known_verbs.find("balance")
    assert balance is not None
    record = balance.record(Case.from_toml(task().case_toml))
    assert_allclose(state.scalars["min_film_thickness"], record.scalars["min_film_thickness"], rtol=1e-12)
    assert state.records[0].scalars["peak_pressure"] == record.scalars["peak_pressure"]


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_the_section_is_plain_json_without_webgl(state: FoundAnswer, theme: Any) -> None:
    assert has_section(state)
    chart = section_chart(state, theme)
    assert len(json.dumps(chart, allow_nan=False)) < 250_000
    assert {trace["type"] for trace in chart["data"]} == {"scatter"}
    reach = max(abs(x) for trace in chart["data"] for x in trace["x"] if x is not None)
    assert_allclose(reach, 1.05 * state.scalars["bushing_radius"], rtol=1e-3)


def test_the_legend_of_the_section_names_roots_and_pressure_band(state: FoundAnswer) -> None:
    shown = {t["name"]: t for t in section_chart(state, LIGHT)["data"] if "name" in t and t.get("showlegend", True)}
    assert {"root of a petal", "pressure band, from p<sub>a</sub> inward"} <= shown.keys()
    roots = shown["root of a petal"]
    assert_allclose(np.hypot(roots["x"], roots["y"]), state.scalars["bushing_radius"], rtol=1e-12)
    assert_allclose(np.unwrap(np.arctan2(roots["y"], roots["x"])), state.arrays["root_angle"], atol=1e-12)


def test_the_film_chart_shows_peak_pressure_and_minimum_film_thickness(state: FoundAnswer) -> None:
    pressure, film = film_chart(state, None, LIGHT)["data"]
    ambient = state.scalars["ambient_pressure"]
    highest = max(value for value in pressure["y"] if value is not None)
    assert_allclose(highest, state.arrays["pressure"].max() / ambient, rtol=1e-4)
    assert_allclose(min(v for v in film["y"] if v is not None), 1e6 * state.arrays["film_thickness"].min(), rtol=1e-4)
    assert all(0.0 <= angle < 360.0 for angle in pressure["x"] if angle is not None)
    assert len(film_chart(state, state, LIGHT)["data"]) == 4


def test_the_view_in_space_of_a_flat_film_has_its_length(state: FoundAnswer) -> None:
    surfaces = space_chart(state, LIGHT)["data"]
    assert len(surfaces) == 8
    assert_allclose(np.max(surfaces[0]["x"]), 1e3 * state.scalars["length"])


def test_a_coarse_answer_is_flat_on_few_cells_and_keeps_no_records() -> None:
    case_3d = case("paper_n8_spatial")
    assert coarse(case_3d).model.kind is ModelKind.TWO_D
    assert coarse(case_3d).cells_per_pitch <= 32
    assert found(coarse=True).records == ()


def test_a_series_is_drawn_over_what_was_varied() -> None:
    curve = found("curve", {"eccentricities": "0 um : -100 um : 3"})
    assert curve.is_series
    x, y = usual_axes([name for name in curve.arrays if name != "leg"])
    chart = chart_of(curve, [x, y], LIGHT)
    assert len(chart["data"][0]["x"]) == 3
    assert csv_of(curve).count("\n") == 4


@pytest.mark.slow
def test_files_are_made_of_the_records(state: FoundAnswer) -> None:
    made = WorkerTask(number=2, work=Work.REPORT, verb="balance", case_toml="title = '<script>'", records=state.records)
    page = perform(made, lambda part, text: None)
    assert isinstance(page, bytes)
    assert b"<script>" not in page
    assert b"minimum film thickness" in page
    answer = stored_answer(state.records, found_analysis("balance"))
    assert answer.records == state.records


def test_the_difference_from_a_pinned_design_is_in_percent(state: FoundAnswer) -> None:
    scalars = dict(state.scalars) | {"min_film_thickness": 0.5 * float(state.scalars["min_film_thickness"])}
    pinned = FoundAnswer(verb="balance", tables=(), scalars=scalars)
    (row,) = (row for row in rows_of(state, pinned) if row["name"] == "min_film_thickness")
    assert row["difference"] == "+100 %"
    moved = dict(state.scalars) | {"force_x": 3e-9, "force_y": 10.0}
    rows = {
        row["name"]: row["difference"] for row in rows_of(state, FoundAnswer(verb="balance", tables=(), scalars=moved))
    }
    assert (rows["force_x"], rows["force_y"]) == ("", "+50 %")
    assert rows_of(state, None)[0]["pinned"] == ""


def test_the_difference_of_an_angle_is_an_angle(state: FoundAnswer) -> None:
    name = "min_film_thickness_angle"
    turned = dict(state.scalars) | {name: float(state.scalars[name]) - math.radians(2.0), "residual": 1.0}
    rows = {
        row["name"]: row["difference"] for row in rows_of(state, FoundAnswer(verb="balance", tables=(), scalars=turned))
    }
    assert (rows[name], rows["residual"]) == ("+2 deg", "")


def test_warnings_colour_their_rows() -> None:
    warned = FoundAnswer(
        verb="solve", tables=(), scalars={"max_bending_stress": 3e9}, warnings=("max_bending_stress: high",)
    )
    assert rows_of(warned, None)[0]["level"] == "warned"
    failed = FoundAnswer(verb="solve", tables=(), scalars={"status": "not converged: why"})
    assert rows_of(failed, None)[0]["level"] == "failed"


def test_a_huge_grid_a_file_and_an_unknown_question_are_refused() -> None:
    with pytest.raises(DefinitionError, match=f"{MOST_UNKNOWNS:,}"):
        found(keys={"model.kind": "3d", "model.cells_per_pitch": 4096, "model.axial_cells": 512})
    with pytest.raises(UsageError, match="reads no files"):
        found("orbit", {"restart": "/etc/passwd"})
    with pytest.raises(UsageError, match="known: balance"):
        found("explode")


def test_a_map_holds_the_answers_of_its_cases() -> None:
    asked = task(keys={"model.cells_per_pitch": 12})
    over = {"petals.thickness": "0.17 mm, 0.19 mm"}
    answer = perform(replace(asked, work=Work.STUDY, vary=over), lambda part, text: None)
    assert isinstance(answer, Mapped)
    assert_allclose(answer.parameters["petals.thickness"], (170e-6, 190e-6))
    assert (answer.units["petals.thickness"], answer.missing) == ("m", 0)
    alone = found(keys={"model.cells_per_pitch": 12, "petals.thickness": "0.19 mm"})
    assert_allclose(answer.results["min_film_thickness"][1], alone.scalars["min_film_thickness"], rtol=1e-9)
    (line,) = map_chart(answer, "min_film_thickness", LIGHT)["data"]
    assert_allclose(line["x"], [170.0, 190.0])
    with pytest.raises(UsageError, match=f"up to {MOST_CASES} cases"):
        perform(replace(asked, work=Work.STUDY, vary={"petals.thickness": "0.1 mm : 0.2 mm : 900"}), lambda p, t: None)


def test_a_map_over_two_parameters_has_a_point_for_each_case() -> None:
    parameters = {"petals.thickness": (1e-4, 2e-4), "petals.count": (6.0, 7.0, 8.0)}
    values = np.array([[1e-6, 2e-6, np.nan], [3e-6, 4e-6, 5e-6]])
    flat = Mapped(
        parameters=parameters,
        units={"petals.thickness": "m", "petals.count": "1"},
        results={"min_film_thickness": values},
        missing=1,
        seconds=1.0,
    )
    contour, cases = map_chart(flat, "min_film_thickness", DARK)["data"]
    assert (contour["x"], contour["y"]) == ([100.0, 200.0], [6.0, 7.0, 8.0])
    assert_allclose(contour["z"][1], [2.0, 4.0])
    assert contour["z"][2][0] is None
    assert list(zip(cases["x"], cases["y"], strict=True))[1] == (100.0, 7.0)


@pytest.mark.parametrize(
    ("values", "unit", "shown", "size"),
    [
        ((1e-4, 2e-4), "m", "µm", 1e-6),
        ((6.0, 8.0), "1", "", 1.0),
        ((0.1, 0.5), "rad", "°", np.pi / 180.0),
        ((4000.0, 8000.0), "rad/s", "rpm", np.pi / 30.0),
        ((0.0, 0.0), "m", "m", 1.0),
    ],
)
def test_axes_are_in_units_that_a_reader_likes(values: tuple[float, ...], unit: str, shown: str, size: float) -> None:
    words, found_size = unit_of(values, unit)
    assert words == shown
    assert_allclose(found_size, size, rtol=1e-9)


def test_a_foil_that_deflects_stands_inside_the_bushing() -> None:
    text = case("bump_foil").to_toml()
    asked = WorkerTask(number=1, work=Work.ANSWER, verb="solve", case_toml=text, coarse=True)
    answer = perform(asked, lambda part, text: None)
    assert isinstance(answer, FoundAnswer)
    shapes = {trace["name"]: trace for trace in section_chart(answer, LIGHT)["data"] if "name" in trace}

    def reach(name: str) -> float:
        return float(np.max(np.hypot(shapes[name]["x"], shapes[name]["y"])))

    assert answer.scalars["bushing_radius"] < reach("foil") < reach("bushing") / 1.05


def test_no_force_is_drawn_on_a_centred_journal(state: FoundAnswer) -> None:
    names = {trace["name"] for trace in section_chart(state, LIGHT)["data"] if "name" in trace}
    assert {"displacement of the journal", "force on it"} <= names
    centred = dict(state.scalars) | {"force_x": 1e-9, "force_y": 2e-9, "eccentricity_x": 0.0, "eccentricity_y": 0.0}
    names = {
        trace["name"] for trace in section_chart(replace(state, scalars=centred), LIGHT)["data"] if "name" in trace
    }
    assert not {"displacement of the journal", "force on it"} & names


def test_a_single_frequency_is_a_table() -> None:
    one = FoundAnswer(
        verb="coefficients", tables=(), scalars={}, arrays={"whirl_frequency": np.ones(1), "stiffness": np.ones(1)}
    )
    assert not is_drawn(one)
    assert is_drawn(replace(one, arrays={"whirl_frequency": np.ones(2)}))
    assert not is_drawn(replace(one, arrays={}))
