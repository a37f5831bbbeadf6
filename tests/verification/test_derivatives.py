"""Derivatives of an equilibrium by the parameters of its case: exact ones, and those of equilibria solved again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.derivatives import DerivativesOf, Results, equilibrium_results, results_with_growth
from petalfoil.analysis.liftoff_derivatives import fraction_of, refined, speed_derivatives
from petalfoil.analysis.operating_point import at_position, under_load
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.case.parameters import with_values
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.dynamics.leading_mode import LeadingMode
from petalfoil.equilibrium.run_context import RunContext
from petalfoil.equilibrium.small_motion import AT_ASPERITIES, AT_POINTS, ON_LINES
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, DefinitionError, UsageError
from petalfoil.walls import register, unregister
from tests.cases import case
from tests.random_packs import random_case, wide_case
from tests.verification.film_helpers import table
from tests.verification.resolved import compared, parameters_with_effect, solved_again
from tests.walls.slider import Slider

EXACT = 1e-6
"""Agreement of a derivative with the difference quotient of equilibria solved again."""

SMOOTH_SHARE = 0.4
"""Least share of the parameters that no contact keeps from being compared."""


def derivatives_of(of: Case) -> DerivativesOf:
    """Derivatives at the position of a case, or under its load."""
    load = of.operation.load
    solution = at_position(of).answer if load is None else under_load(of, load)[0]
    return DerivativesOf(of, solution, equilibrium_results)


def loaded(of: Case, load: float) -> Case:
    """The case under a load along -y [N]."""
    return of.replace(**{"operation.load": (0.0, -load), "operation.eccentricity": (0.0, 0.0)})


FEW = ("bearing.bushing_radius", "petals.thickness", "petals.bend_radius", "gas.ambient_pressure", "operation.speed")
"""Parameters that change films, petals, forces at rest, the units of the unknowns, and the film alone."""


def assert_exact(derivatives: DerivativesOf, paths: Sequence[str] = ()) -> None:
    """Where no contact opens or closes within the quotient, it agrees with the derivative; by default by all paths."""
    paths = paths or parameters_with_effect(derivatives.case, under_load=derivatives.solution.load is not None)
    comparisons = [compared(derivatives, path) for path in paths]
    clear = [comparison for comparison in comparisons if comparison.clear]
    assert len(clear) >= SMOOTH_SHARE * len(paths)
    assert [comparison for comparison in clear if comparison.error > EXACT] == []


# ---------------------------------------------------------------------------------------------- exact derivatives


@pytest.fixture(scope="module")
def slider() -> Iterator[Case]:
    """A taper slider as long as its journal's radius, on a grid from which second order is extrapolated."""
    kind = Slider()
    register(kind)
    yield Case.load(Path(__file__).parents[1] / "walls" / "slider.toml")
    unregister(kind)


def slider_load(case: Case, solution: Solution) -> Results:
    """`W / (p_a B)` under the name of a force that no film of one strip has."""
    problem = solution.problem
    excess = problem.pressure(solution.x) - 1.0
    return {"bearing_force": float(np.sum(excess[0, :, 0] * problem.layout.wall.film.arc_weight))}


def slider_derivatives(of: Case, ratio: float, number: float) -> np.ndarray:
    """Load of a slider, its derivatives by the film ratio and by the bearing number (through the speed)."""
    film, radius = of.wall.outlet_film, of.bearing.journal_radius
    speed = number * of.gas.ambient_pressure * film**2 / (6.0 * of.gas.viscosity * radius**2)
    there = of.replace(**{"slider.film_ratio": ratio, "operation.speed": speed})
    derivatives = DerivativesOf(there, at_position(there).answer, slider_load)
    by_speed = derivatives.by("operation.speed").above["bearing_force"] * speed / number
    by_ratio = derivatives.by("slider.film_ratio").above["bearing_force"]
    return np.array([derivatives.values["bearing_force"], by_ratio, by_speed])


@pytest.mark.parametrize("row", [1, 3, 6], ids=["a 1.5", "a 2", "a 3"])
def test_derivatives_of_a_sliders_load(slider: Case, row: int) -> None:
    exact = {name: float(value) for name, value in table("r5a_slider_derivatives.csv")[row].items()}
    coarse, fine = (
        slider_derivatives(slider.replace(**{"model.cells_per_pitch": cells}), exact["a"], exact["Lam"])
        for cells in (400, 800)
    )
    found = fine + (fine - coarse) / 3.0
    assert_allclose(found, [exact["W/(pa B)"], exact["dW/da"], exact["dW/dLam"]], rtol=2e-5, atol=1e-8)


# ---------------------------------------------------------------------------------------------- equilibria solved again


@pytest.mark.slow
def test_a_journal_at_a_position_in_petals() -> None:
    assert_exact(derivatives_of(case(**{"model.cells_per_pitch": 8})), FEW)


@pytest.mark.slow
def test_a_journal_under_a_load_in_petals() -> None:
    assert_exact(derivatives_of(loaded(case(**{"model.cells_per_pitch": 8}), 20.0)), FEW)


def test_a_plain_journal_under_a_load() -> None:
    plain = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
    assert_exact(derivatives_of(loaded(plain, 15.0)))


@pytest.mark.slow
@pytest.mark.parametrize("bearing", ["paper_n8", "paper_n8_spatial"])
@pytest.mark.parametrize("load", [None, 20.0])
def test_all_parameters_of_the_papers_bearings(bearing: str, load: float | None) -> None:
    of = case(bearing, **{"model.cells_per_pitch": 8, "model.axial_cells": 4})
    assert_exact(derivatives_of(of if load is None else loaded(of, load)))


@pytest.mark.slow
@pytest.mark.parametrize("load", [None, 20.0])
def test_contact_lines_follow_the_parameters(load: float | None) -> None:
    """In 3-D lines of contact cross the stations between nodes, and travel."""
    of = case("paper_n8_spatial", **{"model.cells_per_pitch": 8, "model.axial_cells": 4})
    derivatives = derivatives_of(of if load is None else loaded(of, load))
    found = reported(derivatives.case, derivatives.solution)
    assert found.contact_model == ON_LINES
    assert_exact(replace(derivatives, solution=found, as_points=True), FEW)


PAIR = {"mass": "2 kg", "span": "0.1 m", "transverse_inertia": 0.01, "polar_inertia": 0.002}
OTHERS: dict[str, Case] = {
    "bump foil": case("bump_foil", **{"model.cells_per_pitch": 12, "model.axial_cells": 4}),
    "two bearings": case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4}, rotor=PAIR),
    "moment": case(
        "plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4, "operation.moment": (0.0, 0.01)}
    ),
    "continuous edges": case(**{"model.cells_per_pitch": 8, "model.edges": "continuous"}),
}
"""Bearings beside the paper's, each with equations of its own."""


@pytest.mark.slow
@pytest.mark.parametrize("name", OTHERS)
def test_other_walls_and_shafts_under_a_load(name: str) -> None:
    derivatives = derivatives_of(loaded(OTHERS[name], 20.0))
    paths = parameters_with_effect(derivatives.case, under_load=True)
    assert_exact(derivatives, [path for path in paths if path != "bump_foil.top_foil_thickness"])


@pytest.mark.slow
@pytest.mark.parametrize("number", range(30))
def test_thirty_random_bearings(number: int) -> None:
    draw = wide_case if number % 2 else random_case
    assert_exact(derivatives_of(draw(np.random.default_rng(number), **{"model.cells_per_pitch": 8})))


WITH_POINTS = (
    *(1, 3, 6, 8, 16, 18, 20, 22, 26, 32, 36, 37, 38, 39, 41),
    *(42, 43, 48, 50, 55, 56, 60, 62, 63, 64, 65, 68, 70, 72, 77),
)
"""The first thirty of the random bearings above that have contact points on 16 cells per pitch."""

OFTEN = (3, 16, 38, 50)
"""Some of them: of the whole domain, with a factor that loses digits, with a force that cancels, with stretches on
every petal."""


@pytest.mark.parametrize(
    "number",
    [pytest.param(number, marks=pytest.mark.slow if number in OFTEN else pytest.mark.long) for number in WITH_POINTS],
)
def test_thirty_random_bearings_with_contact_points(number: int) -> None:
    draw = wide_case if number % 2 else random_case
    derivatives = derivatives_of(draw(np.random.default_rng(number), **{"model.cells_per_pitch": 16}))
    found = reported(derivatives.case, derivatives.solution)
    assert found.contact_model == AT_POINTS
    assert_exact(replace(derivatives, solution=found, as_points=True))


@pytest.mark.parametrize(
    "number",
    [pytest.param(number, marks=pytest.mark.slow if number == 2 else pytest.mark.long) for number in (2, 10, 23)],
)
def test_random_bearings_with_contact_pressures_over_asperities(number: int) -> None:
    draw = wide_case if number % 2 else random_case
    derivatives = derivatives_of(draw(np.random.default_rng(number), **{"model.cells_per_pitch": 16}))
    found = reported(derivatives.case, derivatives.solution)
    assert found.contact_model == AT_ASPERITIES
    assert_exact(replace(derivatives, solution=found, as_points=True), FEW if number == 2 else ())


def test_one_factorisation_serves_all_parameters(run: RunContext) -> None:
    derivatives = derivatives_of(case(**{"model.cells_per_pitch": 8}))
    before = run.probes.factorizations + run.film.factorizations
    for path in ("petals.thickness", "gas.viscosity", "operation.speed"):
        derivatives.by(path)
    assert run.probes.factorizations + run.film.factorizations == before + 1


@pytest.mark.slow
def test_at_a_contact_that_just_touches_both_sides_differ() -> None:
    """A journal that is moved until a petal just leaves it: solid contact carries on one side alone."""
    near = case(**{"model.cells_per_pitch": 16, "operation.eccentricity": (0.0, -330e-6)})
    derivatives = derivatives_of(near)
    for _ in range(4):  # onto the kink: how far the nearest contact is follows from the rates
        step = derivatives.by("operation.eccentricity.y")
        x, y = near.operation.eccentricity
        near = near.replace(**{"operation.eccentricity": (x, y + step.reach[1])})
        derivatives = derivatives_of(near)
        found = derivatives.by("operation.eccentricity.y")
        if found.at_kink:
            break
    assert found.at_kink
    change = 2e-9
    for sign, side in ((-1.0, found.below), (1.0, found.above)):
        path = "operation.eccentricity.y"
        there = derivatives_of(with_values(near, {path: near.operation.eccentricity[1] + sign * change}))
        rate = there.by(path).above
        assert_allclose(side["bearing_force"], rate["bearing_force"], rtol=1e-3)
    assert abs(found.below["bearing_force"] / found.above["bearing_force"] - 1.0) > 1e-2


@pytest.mark.parametrize("path", ["petals.thickness", pytest.param("petals.bend_radius", marks=pytest.mark.slow)])
def test_contacts_as_points_foretell_a_change_of_one_per_cent(path: str) -> None:
    """Contacts at nodes, exact for tiny changes, are several times farther from the change between two equilibria."""
    of = loaded(case(**{"model.cells_per_pitch": 32}), 20.0)
    at_nodes = derivatives_of(of)
    as_points = replace(at_nodes, as_points=True)
    value = at_nodes.variation(path).value
    films = [
        derivatives_of(with_values(of, {path: share * value})).values["min_film_thickness"] for share in (0.99, 1.01)
    ]
    change = films[1] - films[0]
    off_points, off_nodes = (
        abs(derivatives.by(path).above["min_film_thickness"] * 0.02 * value / change - 1.0)
        for derivatives in (as_points, at_nodes)
    )
    assert off_points < 0.02
    assert off_nodes > 3.0 * off_points


def test_contacts_that_are_all_at_nodes_give_the_same_either_way() -> None:
    plain = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
    at_nodes = derivatives_of(plain)
    as_points = replace(at_nodes, as_points=True)
    assert as_points.with_points is None
    assert as_points.by("gas.viscosity") == at_nodes.by("gas.viscosity")


@pytest.mark.parametrize("path", ["operation.speed", "petals.thickness"])
def test_the_growth_rate_follows_to_first_order(path: str) -> None:
    of = case(**{"model.cells_per_pitch": 8})
    solution = at_position(of).answer
    derivatives = DerivativesOf(of, solution, results_with_growth(solution))
    variation = derivatives.variation(path)
    found = derivatives.along(variation)
    variation = variation.finer(found.fineness)
    rates = []
    for steps, weight in variation.stencil:
        there_case, there = variation.at(steps)
        again_solved = solved_again(derivatives, there)
        rate = LeadingMode.of(again_solved).eigenvalue(again_solved)
        rates.append(weight * rate.real * there_case.operation.speed / variation.step)
    size = max(abs(found.above["growth_rate"]), abs(derivatives.values["growth_rate"]) / variation.size)
    assert_allclose(found.above["growth_rate"], sum(rates), atol=1e-5 * size)
    eigenvalue = leading_eigenvalue(solution)
    assert_allclose(derivatives.values["growth_rate"], eigenvalue.real * of.operation.speed, rtol=1e-5)


# ---------------------------------------------------------------------------------------------- lift-off


@pytest.mark.slow
def test_the_lift_off_speed_is_inverse_to_the_viscosity_and_follows_its_thickness() -> None:
    of = case(**{"model.cells_per_pitch": 16})
    lift_off = speed_derivatives(of, 30.0, 0.01, as_points=True)[0]
    speed = lift_off.values["liftoff_speed"]
    by_viscosity = lift_off.by("gas.viscosity").above["liftoff_speed"] * of.gas.viscosity / speed
    assert_allclose(by_viscosity, -1.0, rtol=1e-8)  # the film knows their product alone
    found = lift_off.by("petals.thickness")
    change = min(0.2 * min(found.reach), 5e-8)
    speeds = [
        again(lift_off.balance, {"petals.thickness": of.petals.thickness + sign * change}, speed) for sign in (-1, 1)
    ]
    # with contact points differences of equilibria agree to some 1e-5 (V9)
    assert_allclose(found.above["liftoff_speed"], (speeds[1] - speeds[0]) / (2.0 * change), rtol=3e-5)


def again(balance: DerivativesOf, values: dict[str, float], near: float, limit: float = 0.01) -> float:
    """Lift-off speed of another bearing, found from that of the first."""
    there = with_values(balance.case, values)
    line = SpeedLine(there, there.operation.load, leads=False)
    line.known = balance.solution
    return refined("liftoff_speed", line, (near, limit), as_points=balance.as_points).values["liftoff_speed"]


# ---------------------------------------------------------------------------------------------- refusals


def test_a_state_of_another_case_is_refused() -> None:
    derivatives = derivatives_of(case("plain_journal", **{"model.cells_per_pitch": 8, "model.axial_cells": 4}))
    other = derivatives.case.replace(**{"gas.viscosity": 2e-5})
    with pytest.raises(ConvergenceError, match="the equations of the case hold at this state to"):
        replace(derivatives, case=other).by("gas.viscosity")


def test_what_has_no_derivative_is_refused() -> None:
    derivatives = derivatives_of(case("plain_journal", **{"model.cells_per_pitch": 8, "model.axial_cells": 4}))
    with pytest.raises(UsageError, match=r"by model\.cells_per_pitch: it is a whole number"):
        derivatives.by("model.cells_per_pitch")
    with pytest.raises(DefinitionError, match=r"gas\.viscosity"):
        derivatives.by("gas.viscosty")


def test_a_parameter_at_the_end_of_its_range_is_differentiated_inside() -> None:
    derivatives = derivatives_of(case(**{"model.cells_per_pitch": 8}))
    by_coating = derivatives.by("petals.coating")
    assert derivatives.variation("petals.coating").stencil[0][0] == 0
    assert math.isfinite(by_coating.above["bearing_force"])


@pytest.mark.slow
def test_at_a_contact_that_opens_at_the_lift_off_speed_both_sides_are_told() -> None:
    """The limit of the contact fraction is put where a contact ends; speeds found again on either side agree."""
    of = loaded(case("rig", **{"model.cells_per_pitch": 12}), 46.4)
    line, speed = SpeedLine(of, (0.0, -46.4), leads=False), 5000.0 * math.pi / 30.0
    for _ in range(6):  # onto the kink: how far the next contact is follows from the rates
        there = with_values(of, {"operation.speed": speed})
        balance = DerivativesOf(there, line.at(speed), fraction_of)
        by_speed = balance.by("operation.speed")
        if by_speed.at_kink:
            break
        speed += by_speed.reach[1]
    assert by_speed.at_kink
    limit = balance.values["contact_fraction"]
    lift_off = refined("liftoff_speed", line, (speed, limit), as_points=False)
    found = lift_off.by("petals.thickness")
    assert found.at_kink
    change = 2e-9
    for side, sign in ((found.below, -1.0), (found.above, 1.0)):
        ends = [
            again(lift_off.balance, {"petals.thickness": of.petals.thickness + sign * part * change}, speed, limit)
            for part in (1.0, 2.0)
        ]
        assert_allclose(side["liftoff_speed"], sign * (ends[1] - ends[0]) / change, rtol=2e-3)
    assert abs(found.below["liftoff_speed"] / found.above["liftoff_speed"] - 1.0) > 1e-3
