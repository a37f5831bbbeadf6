"""Motions play their section in the browser, and a search shows its designs and opens the one that is clicked."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.errors import UsageError
from petalfoil.studio.charts import optimum_axes, optimum_chart
from petalfoil.studio.design import Design
from petalfoil.studio.motion_chart import motion_chart
from petalfoil.studio.parameter_choice import as_typed, entries
from petalfoil.studio.protocol import FoundAnswer, Searched, Work, WorkerTask
from petalfoil.studio.study_tasks import MOST_CASES
from petalfoil.studio.tasks import perform
from petalfoil.studio.themes import LIGHT

COARSE = Design.starting().with_value("model.cells_per_pitch", 12)


def moving(pictures: int = 3) -> FoundAnswer:
    """A journal that moves along x in a bearing of two strips, with a picture of each instant."""
    shape, places = (pictures, 2, 5), np.linspace(0.0, 1e-4, pictures)
    rng = np.random.default_rng(1)
    arrays = {
        "time": np.linspace(0.0, 1e-2, 11), "x": np.linspace(0.0, 1e-4, 11), "y": np.zeros(11),
        "min_film_thickness": np.full(11, 5e-6), "contact_fraction": np.zeros(11),
        "frame": np.linspace(0.0, 1e-2, pictures), "root_angle": np.array([0.0, np.pi]),
        "phi_exposed": np.linspace(0.0, np.pi, 5), "phi": np.linspace(0.0, np.pi, 5),
        "frame_pressure": 1e5 * rng.uniform(0.9, 2.0, shape), "frame_film_thickness": np.full(shape, 5e-6),
        "frame_radius": np.full(shape, 25.5e-3), "frame_x": places, "frame_y": 0.0 * places,
    }  # fmt: skip
    arrays["frame_film_thickness"][1] = 1e-6
    scalars = {"bushing_radius": 26e-3, "journal_radius": 25e-3, "petal_thickness": 2e-4, "ambient_pressure": 1e5}
    return FoundAnswer(verb="orbit", tables=(), arrays=arrays, scalars=scalars | {"contact_film_thickness": 1e-6})


def test_every_picture_of_a_motion_moves_the_same_traces() -> None:
    chart = motion_chart(moving(), LIGHT)
    json.dumps(chart, allow_nan=False)
    played = chart["frames"][0]["traces"]
    assert played == list(range(len(chart["data"]) - len(played), len(chart["data"])))
    assert {len(frame["data"]) for frame in chart["frames"]} == {len(played)}
    journals = [np.array(frame["data"][0]["x"]) for frame in chart["frames"]]
    scale = (journals[2].max() - journals[0].max()) / 1e-4
    assert_allclose(journals[1].max() - journals[0].max(), 5e-5 * scale, rtol=0.02)
    assert scale > 1.0
    spots = [frame["data"][-2] for frame in chart["frames"]]
    assert_allclose([spot["x"][0] for spot in spots], [0.0, 50.0, 100.0], atol=1e-9)
    contacts = [len(frame["data"][-3]["x"]) for frame in chart["frames"]]
    assert contacts == [0, 10, 0]


def test_a_motion_without_pictures_moves_along_its_path() -> None:
    found = moving()
    bare = replace(found, arrays={name: v for name, v in found.arrays.items() if not name.startswith("frame")})
    chart = motion_chart(bare, LIGHT)
    assert "xaxis4" not in chart["layout"]
    assert [len(frame["data"]) for frame in chart["frames"]] == [2] * len(chart["frames"])


@pytest.mark.slow
def test_the_section_of_a_motion_is_that_of_its_result() -> None:
    design = COARSE.with_value("rotor", {"mass": "1.5 kg", "unbalance": "1 um"}).with_value("operation.load", None)
    asked = WorkerTask(
        number=1, work=Work.ANSWER, verb="orbit", case_toml=design.to_toml(), arguments={"revolutions": "2"}
    )
    found = perform(asked, lambda part, text: None)
    assert isinstance(found, FoundAnswer)
    record = found.records[-1]
    assert_allclose(found.arrays["frame_x"], record.fields["frame_x"])
    assert_allclose(
        found.arrays["frame_pressure"][-1], np.asarray(record.fields["frame_pressure"])[-1, :, :, 0], rtol=1e-6
    )
    chart = motion_chart(found, LIGHT)
    assert len(chart["frames"]) == len(record.coords["frame"]) > 20
    assert len(json.dumps(chart, allow_nan=False)) < 4e6


def tried(objectives: tuple[str, ...]) -> Searched:
    return Searched(
        parameters={"petals.thickness": (1.6e-4, 1.7e-4, 1.8e-4), "petals.count": (7.0, 8.0, 8.0)},
        units={"petals.thickness": "m", "petals.count": "1"},
        results={"min_film_thickness": np.array([6e-6, 7e-6, np.nan]), "friction_torque": np.array([0.02, 0.03, 0.01])},
        objectives=objectives,
        feasible=np.array([True, True, False]),
        on_front=np.array([False, True, False]),
        ended="the budget is spent",
        seconds=1.0,
    )


def test_a_search_shows_its_designs_in_the_plane_of_two_objectives() -> None:
    (across, x), (up, y) = optimum_axes(tried(("maximize min_film_thickness", "minimize friction_torque")))
    assert (across, up) == ("minimum film thickness [µm]", "friction torque [mN·m]")
    assert_allclose((x[1], y[1]), (7.0, 30.0))
    chart = optimum_chart(tried(("maximize min_film_thickness", "minimize friction_torque")), LIGHT)
    json.dumps(chart, allow_nan=False)
    assert [trace["name"] for trace in chart["data"]] == ["misses a limit", "keeps every limit", "best"]
    assert chart["data"][2]["text"] == ["design 2"]
    (over, numbers), _ = optimum_axes(tried(("maximize min_film_thickness",)))
    assert (over, list(numbers)) == ("design", [1.0, 2.0, 3.0])


def test_a_design_of_a_study_is_written_as_a_case_has_it() -> None:
    design = Design.starting()
    assert as_typed(design, "petals.thickness", 1.6e-4, "m") == "160 µm"
    assert as_typed(design, "petals.count", 7.0, "1") == 7
    assert {"petals.thickness", "operation.speed"} <= set(entries(design))
    assert "model.kind" not in entries(design)


def search(vary: dict[str, str], **goals: Any) -> Any:
    given = {"maximize": ["min_film_thickness"], "minimize": [], "subject": [], **goals}
    asked = WorkerTask(number=1, work=Work.OPTIMUM, verb="balance", case_toml=COARSE.to_toml(), vary=vary, goals=given)
    return perform(asked, lambda part, text: None)


def test_a_search_without_parameters_or_beyond_the_budget_is_refused() -> None:
    with pytest.raises(UsageError, match="nothing varies"):
        search({})
    with pytest.raises(UsageError, match=f"1 to {MOST_CASES} designs"):
        search({"petals.thickness": "0.16 mm : 0.19 mm"}, budget=10_000)
    with pytest.raises(UsageError, match="nothing to optimize"):
        search({"petals.thickness": "0.16 mm : 0.19 mm"}, maximize=[])


@pytest.mark.slow
def test_a_search_holds_designs_whose_best_is_the_best() -> None:
    found = search({"petals.thickness": "0.16 mm : 0.19 mm"}, subject=["friction_torque < 1 N m"], budget=8)
    assert isinstance(found, Searched)
    films = found.results["min_film_thickness"]
    (best,) = np.flatnonzero(found.on_front)
    assert films[best] == np.nanmax(films[found.feasible])
    assert films[best] > films[0]
    assert len(found.parameters["petals.thickness"]) == len(films) <= 8
