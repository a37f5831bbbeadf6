"""Equilibria with contact points as unknowns: their tangent, and slopes that converge with both grids."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import accumulate

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.signal import savgol_filter

import petalfoil
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic, elastic_and_sliding, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.equilibrium.asperity_contacts import AsperityContacts, with_asperities
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.element_contacts import near_nodes, start_at, with_elements
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_points import evenly_divided, followed
from petalfoil.equilibrium.led_points import led, with_nodal_contacts
from petalfoil.equilibrium.point_contacts import PointContacts, stepped, with_points
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_ASPERITIES, AT_POINTS, ON_LINES
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.asperity_equations import AsperityEquations
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointState
from tests.cases import case
from tests.contract.taylor import assert_tangent, taylor_slopes
from tests.random_packs import random_case
from tests.verification.test_contact_slopes import BEARINGS, apart, walk

Array = NDArray[np.float64]

STRETCHES = "ten petals"
"""Of its contacts 39 lie within stretches."""


@cache
def answer_of(name: str) -> Solution:
    """The equilibrium with contacts at nodes."""
    with running():
        return operating_point(BEARINGS[name], None).answer


def contacts_of(name: str) -> PointContacts:
    """That with contact points."""
    found = near_nodes(answer_of(name))
    assert isinstance(found, PointContacts)
    return found


def test_points_followed_to_another_speed_are_those_found_there() -> None:
    """Unknowns and position together in few factorisations; the force carries the load."""
    with running() as run:
        found, load = contacts_of("turbocharger"), answer_of("turbocharger").load
        assert load is not None
        faster = found.equations.problem.at(bearing_number=1.3 * found.equations.problem.bearing_number)
        before = run.film.factorizations
        there = followed(found, faster, load)
        assert run.film.factorizations - before <= 4
        anew = found.at(there.equations.problem)
    assert_allclose(there.equations.force, -load, atol=1e-7 * np.linalg.norm(load))
    assert_allclose(there.equations.state.P, anew.equations.state.P, rtol=1e-7)
    assert np.linalg.norm(there.equations.problem.displacement - found.equations.problem.displacement) > 1e-3
    with running(), pytest.raises(NoPointsError):
        followed(found, faster, 40.0 * load)


def beside(answer: Solution, down: float) -> CoupledProblem:
    """The problem of an answer with the journal further down [m]."""
    problem = answer.problem
    return problem.at(displacement=problem.displacement - np.array([0.0, down / problem.layout.scales.length]))


def through_the_film(equations: PointEquations) -> CoupledProblem:
    """The problem with the journal moved until the film is exactly or hardly closed where it was thinnest."""
    thin = int(np.argmin(equations.film_thickness))
    toward = equations.whole.film_by_e[thin]
    way = -equations.film_thickness.ravel()[thin] * toward / (toward @ toward)
    return equations.problem.at(displacement=equations.problem.displacement + way)


def test_a_closed_film_is_no_start() -> None:
    """The equations divide by the film: every search says so before a factorisation."""
    found = contacts_of("turbocharger")
    closed = through_the_film(found.equations)
    near = replace(found, equations=replace(found.equations, problem=closed))
    whole, state = found.equations.whole, found.equations.state
    with running() as run:
        for search in (
            lambda: with_points(whole, closed, state),
            lambda: followed(near, closed, np.zeros(2)),
            lambda: with_asperities(whole, closed, state),
        ):
            with pytest.raises(NoPointsError, match="the film closes"):
                search()
        assert run.film.factorizations == 0


def test_steps_that_close_the_film_end() -> None:
    """Each takes four fifths of what is left, to zero by rounding: bearing 352 of the random runs of `capacity`."""
    equations = contacts_of("turbocharger").equations
    thin = int(np.argmin(equations.film_thickness))
    toward = equations.whole.film_by_e[thin]
    change = np.zeros(equations.n), -1e3 * toward / (toward @ toward)
    steps = accumulate(range(12), lambda at, _: stepped(at, change, None, whole_step=True), initial=equations)
    with pytest.raises(NoPointsError, match="the film closes"):
        assert all(np.min(at.film_thickness) > 0.0 for at in steps)


@pytest.mark.parametrize("name", ["paper_n6", "paper_n8", "paper_n10"])
def test_points_led_to_the_next_position_are_those_found_from_nodes(name: str) -> None:
    """With the same stretches; two factorisations at most, and contacts at nodes are found beside them where asked."""
    bearing = case(name, **{"model.cells_per_pitch": 32, "operation.eccentricity": (0.0, -140e-6)})
    with running():
        start = with_elements(operating_point(bearing, None).answer)
    there = beside(start, 20e-6)
    with running() as run:
        ahead = led(start, there)
    assert ahead is not None
    assert run.film.factorizations <= 2
    with running():
        nodal, jump = advance(start, there)
        anew, again = with_elements(nodal), with_nodal_contacts(ahead)
    assert not jump
    assert isinstance(ahead.elements, PointContacts)
    assert isinstance(anew.elements, PointContacts)
    assert_allclose(ahead.elements.equations.force, anew.elements.equations.force, rtol=1e-9, atol=1e-7)
    assert_allclose(ahead.elements.points.inner, anew.elements.points.inner)
    assert_allclose(ahead.elements.equations.state.P, anew.elements.equations.state.P, rtol=1e-8)
    assert again.contacts is not None
    assert again.elements is ahead.elements
    assert_allclose(again.x, nodal.x, rtol=1e-8, atol=1e-8)


def test_points_led_to_a_far_speed_in_two_parts_are_those_balanced_from_nothing() -> None:
    """Eight petals under 15 N, from 444 to 1778 rad/s: at once the points do not lead there."""
    bearing, speed = case("paper_n8", **{"model.cells_per_pitch": 16}), 16000.0 / 9.0
    with running():
        start, anew = (SpeedLine(bearing, (0.0, -15.0)).at(at) for at in (speed / 4.0, speed))
    there = start.problem.at(bearing_number=start.problem.layout.bearing_number(speed))
    with running() as run:
        ahead = led(start, there, start.load)
    assert ahead is not None
    assert [row["parts"] for row in run.history if row["phase"] == "followed"] == [1]
    assert_allclose(ahead.position, anew.position, rtol=0.0, atol=1e-7)
    assert ahead.force_residual < 1e-8


def test_points_do_not_lead_across_a_jump() -> None:
    """What is much farther than the tangent foretold is refused; a bearing of another grid leads nowhere."""
    found, load = contacts_of("turbocharger"), answer_of("turbocharger").load
    assert load is not None
    none_foretold = replace(found, tangent=replace(found.tangent, factor=Nothing())) if found.tangent else found
    with running(), pytest.raises(NoPointsError, match="foretold"):
        followed(none_foretold, beside(answer_of("turbocharger"), 1e-6), None)
    other = build_problem(case("paper_n8", **{"model.cells_per_pitch": 32}))
    with running():
        assert led(answer_of("turbocharger"), other) is None


class Nothing:
    """A factor whose solutions vanish."""

    def solve(self, rhs: Array) -> Array:
        """No change."""
        return np.zeros_like(rhs)

    solve_transposed = solve


def test_a_stretch_that_grows_is_divided_anew() -> None:
    """By a point in each element; the sum of its reactions stays, and an isolated point is none."""
    points = ContactPoints(
        np.array([0, 0, 1]), np.array([2.0, 7.2, 3.0]), np.array([2, 0, 0]), np.array([5.0, 1.0, 3.0, 6.0, 7.0])
    )
    divided = evenly_divided(points)
    assert divided.inner.tolist() == [4, 0, 0]
    assert divided.reaction.tolist() == [5.0, 1.0, 1.0, 1.0, 1.0, 6.0, 7.0]
    assert evenly_divided(divided).reaction.tolist() == divided.reaction.tolist()


def shifted(equations: PointEquations, step: Array) -> PointEquations:
    """The equations at other unknowns."""
    state, n_w, n_P = equations.state, equations.whole.n_wall, equations.whole.n_film
    dw, dP, dlam, dt = np.split(step, [n_w, n_w + n_P, n_w + n_P + len(state.points.reaction)])
    points = replace(state.points, position=state.points.position + dt, reaction=state.points.reaction + dlam)
    return replace(equations, state=PointState(state.w + dw, state.P + dP, points))


@pytest.mark.parametrize("name", ["turbocharger", STRETCHES])
def test_tangent(name: str) -> None:
    """Remainder of second order in all unknowns at once, places included; and away from the solution."""
    equations, rng = contacts_of(name).equations, np.random.default_rng(1)
    points, sizes = equations.state.points, (equations.whole.n_wall, equations.whole.n_film)
    direction = np.concatenate([
        rng.uniform(-0.02, 0.02, sizes[0]),
        rng.uniform(-0.1, 0.1, sizes[1]),
        rng.uniform(-1.0, 1.0, len(points.reaction)) * points.reaction,
        rng.uniform(-0.5, 0.5, len(points.position)) * np.minimum(points.position % 1.0, 1.0 - points.position % 1.0),
    ])  # fmt: skip
    away = shifted(equations, 0.01 * direction)
    assert_tangent(lambda t: np.concatenate(shifted(away, t * direction).residual), away.steady @ direction)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_tangent_on_both_sides_of_the_nodes_of_elements(side: float) -> None:
    """Curvatures of gaps jump there: points at their nearest nodes have a tangent for either side."""
    equations, rng = contacts_of("turbocharger").equations, np.random.default_rng(3)
    points = equations.state.points
    assert len(points.inner) == np.count_nonzero(points.inner == 0)  # points that travel by themselves
    node = np.clip(np.rint(points.position), 1.0, equations.whole.curves.elements[points.curve] - 1.0)
    assert len(np.unique(np.column_stack([points.curve, node]), axis=0)) == len(node)
    at = np.nextafter(node, node + side) if side < 0.0 else node
    bent = rng.uniform(-0.02, 0.02, equations.whole.n_wall)
    moved = np.concatenate([bent, np.zeros(equations.n - len(bent) - len(node)), at - points.position])
    there = shifted(equations, moved)
    assert np.array_equal(np.floor(there.state.points.position), node - (side < 0.0))
    direction = np.concatenate([
        rng.uniform(-0.02, 0.02, equations.whole.n_wall),
        rng.uniform(-0.1, 0.1, equations.whole.n_film),
        rng.uniform(-1.0, 1.0, len(node)) * points.reaction,
        side * rng.uniform(0.1, 0.5, len(node)),
    ])  # fmt: skip

    def along(t: float) -> Array:
        return np.concatenate(shifted(there, t * direction).residual)

    change, slopes = there.steady @ direction, slice(-len(node), None)
    assert_tangent(along, change)
    beyond = taylor_slopes(lambda t: along(-t)[slopes], -change[slopes])
    assert np.max(beyond) < 1.5  # the other side has another tangent


@pytest.mark.parametrize("name", ["turbocharger", STRETCHES])
def test_stiffness_is_the_slope_of_equilibria_with_contact_points(name: str) -> None:
    """Central differences over 0.02 um, within 5e-6 of the largest entry."""
    found = contacts_of(name).equations
    scales, step, columns = found.problem.layout.scales, 1e-3, []
    for axis in np.eye(2):
        forces = []
        for side in (-step, step):
            moved = found.problem.at(displacement=found.problem.displacement + side * axis)
            with running():
                forces.append(with_points(found.whole, moved, found.state).equations.force)
        columns.append(-(forces[1] - forces[0]) / (2.0 * step))
    slope = np.column_stack(columns) * scales.force / scales.length
    with running():
        K, _ = impedance(ElementMotion(contacts_of(name)), 0.0, BEARINGS[name].operation.speed)
    assert apart(K, slope) <= 5e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["turbocharger", STRETCHES, "rig"])
def test_slopes_do_not_depend_on_the_elements(name: str) -> None:
    """On 32 and 48 elements per pitch: stiffness within 0.15 %, damping within 0.4 %."""
    speed, found = BEARINGS[name].operation.speed, []
    for elements in (32, 48):
        bearing = BEARINGS[name].replace(**{"model.petal_cells": elements})
        with running():
            found.append(impedance(elastic(bearing, operating_point(bearing, None).answer), 0.0, speed))
    assert apart(found[0][0], found[1][0]) <= 1.5e-3
    assert apart(found[0][1], found[1][1]) <= 4e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", BEARINGS)
def test_slopes_on_the_default_grid_are_those_on_a_finer_one(name: str) -> None:
    """Stiffness within 0.1 % of its largest entry, damping within 0.5 %."""
    found = []
    for finer in (1, 2):
        bearing = BEARINGS[name].replace(**{"model.cells_per_pitch": finer * BEARINGS[name].cells_per_pitch})
        with running():
            motion = elastic(bearing, operating_point(bearing, None).answer)
            found.append(impedance(motion, 0.0, bearing.operation.speed))
    assert apart(found[0][0], found[1][0]) <= 1e-3
    assert apart(found[0][1], found[1][1]) <= 5e-3


@pytest.mark.slow
def test_a_film_finer_than_the_elements_ends_where_petals_touch_the_journal() -> None:
    """A stiff pack, 64 cells on 32 elements: no film below the contact film, and the force of 64 elements within 1 %.

    Its contacts fell to nodes, 15 % away, while reactions bent elements under gaps and not under the film.
    """
    rng, forces = np.random.default_rng(2024), []
    pack = [random_case(rng) for _ in range(37)][-1]
    for elements in (32, 64):
        found = petalfoil.solve(pack.replace(**{"model.cells_per_pitch": 64, "model.petal_cells": elements}))
        assert found["contact_model"].item() == AT_POINTS
        assert float(found["contact_normal_force"]) > 0.0
        assert float(found["film_thickness"].min()) > pack.surface.contact_film_thickness - 5e-9
        forces.append(np.array([float(found["force_x"]), float(found["force_y"])]))
    assert np.linalg.norm(forces[1] - forces[0]) <= 1e-2 * np.linalg.norm(forces[1])


@pytest.mark.slow
def test_stiffness_under_a_load_converges_at_second_order() -> None:
    """Eight petals under 20 N on 32, 64, 128 cells per pitch: 85.71, 85.91, 85.96 kN/m; before, 85.73, 85.90, 85.98."""
    found = []
    for cells in (32, 64, 128):
        bearing = case("paper_n8", **{"model.cells_per_pitch": cells})
        with running():
            answer = operating_point(bearing, (0.0, -20.0)).answer
            motion = elastic(bearing, answer)
            assert isinstance(motion, ElementMotion)
            assert_allclose(motion.contacts.equations.force, -answer.load, rtol=0.0, atol=1e-6 * abs(answer.load[1]))
            found.append(impedance(motion, 0.0, bearing.operation.speed)[0])
    coarse, fine = apart(found[0], found[1]), apart(found[1], found[2])
    assert fine <= 6e-4
    assert np.log2(coarse / fine) >= 1.5


@pytest.mark.slow
@pytest.mark.parametrize("name", ["turbocharger", STRETCHES])
def test_stiffness_is_smooth_along_a_sweep(name: str) -> None:
    """In 40 steps of 0.1 um it strays by less than 1e-5 from a quintic."""
    _, *found = walk(BEARINGS[name], 40, 0.1e-6)  # slopes of the first, a balance, are where points carry its load
    speed = BEARINGS[name].operation.speed
    with running():
        K = np.array([impedance(elastic(BEARINGS[name], answer), 0.0, speed)[0][1, 1] for answer in found])
    place = np.linspace(-1.0, 1.0, len(K))
    assert np.max(np.abs(K - np.polyval(np.polyfit(place, K, 5), place))) <= 1e-5 * np.mean(K)


@pytest.mark.parametrize(
    "name", [pytest.param("turbocharger", marks=pytest.mark.slow), pytest.param(STRETCHES, marks=pytest.mark.long)]
)
def test_stiffness_is_smooth_over_two_hundred_steps(name: str) -> None:
    """In steps of 0.1 um, from contact to contact: no entry strays by 1 % of the largest from cubics through 21 steps.

    The most was 0.12 % when this was written, where a contact begins.
    """
    _, *found = walk(BEARINGS[name], 200, 0.1e-6)
    with running():
        K = np.array([impedance(elastic(BEARINGS[name], one), 0.0, BEARINGS[name].operation.speed)[0] for one in found])
    noise = np.abs(K - savgol_filter(K, 21, 3, axis=0))[10:-10]
    assert np.max(noise) <= 1e-2 * np.max(np.abs(K))


def test_a_result_says_where_its_contacts_are() -> None:
    coarse = {"model.cells_per_pitch": 32, "operation.load": (0.0, -20.0)}
    assert coefficients.record(case("paper_n8", **coarse)).scalars["contact_model"] == AT_POINTS
    spatial = {"model.kind": "3d", "model.cells_per_pitch": 16, "model.axial_cells": 4, "operation.load": (0.0, -20.0)}
    assert coefficients.record(case("paper_n8", **spatial)).scalars["contact_model"] == ON_LINES
    assert "contact_model" not in coefficients.record(case("plain_journal")).scalars


@pytest.mark.slow
def test_petals_that_stick_stiffen_contact_points() -> None:
    """As much on grids of 64 and 128 cells: within 1 % of the largest entry. At nodes they differ by 2 %."""
    found = []
    for cells in (64, 128):
        rubs = case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": cells})
        with running():
            answer = operating_point(rubs, (0.0, -20.0)).answer
            motion, sliding = elastic_and_sliding(rubs, answer)
            assert isinstance(motion, ElementMotion)
            assert sliding is not None
            found.append([impedance(one, 0.0, rubs.operation.speed)[0] for one in (motion, motion.frictionless)])
    (stuck, free), (stuck_fine, _) = found
    assert stuck[0, 0] > 1.5 * free[0, 0]
    assert apart(stuck, stuck_fine) <= 1e-2


def test_the_limit_of_the_turbocharger_bearing() -> None:
    """33.46, -0.95, -1.60, 147.88 kN/m at the eccentricity of an independent prototype, on 128 cells within 0.05 %."""
    bearing = BEARINGS["turbocharger"].replace(**{"operation.load": None, "operation.eccentricity": (2.3e-6, -235e-6)})
    with running():
        K, _ = impedance(elastic(bearing, operating_point(bearing, None).answer), 0.0, bearing.operation.speed)
    assert_allclose(K.ravel(), [33.461e3, -0.951e3, -1.599e3, 147.876e3], rtol=0.0, atol=0.07e3)


# ------------------------------------------------------------------------------------------ asperities


def pressed_at(answer: Solution) -> AsperityContacts:
    """The equilibrium with contact pressures over asperities, near one with contacts at nodes."""
    whole = answer.problem.layout.elements
    assert whole is not None
    with running():
        return with_asperities(whole, answer.problem, start_at(whole, answer))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["turbocharger", STRETCHES])
def test_slopes_with_asperities_are_those_of_contact_points(name: str) -> None:
    """Stiffness within 0.2 % of its largest entry, damping within 0.5 %, reactions within 0.3 %."""
    speed = BEARINGS[name].operation.speed
    answer = replace(answer_of(name), load=None, elements=None, elements_sought=False)  # both at one position
    pressed, points = pressed_at(answer), near_nodes(answer)
    assert points is not None
    with running():
        rough, smooth = (impedance(ElementMotion(one), 0.0, speed) for one in (pressed, points))
    assert apart(rough[0], smooth[0]) <= 2e-3
    assert apart(rough[1], smooth[1]) <= 5e-3
    assert_allclose(pressed.points.reaction.sum(), points.points.reaction.sum(), rtol=3e-3)


def moved_by(equations: AsperityEquations, step: Array, de: Array) -> AsperityEquations:
    """The equations at other unknowns and another position, their pressures those of the law."""
    smooth, n_w = equations.smooth, equations.smooth.whole.n_wall
    state = PointState(smooth.state.w + step[:n_w], smooth.state.P + step[n_w:], smooth.state.points)
    problem = smooth.problem.at(displacement=smooth.problem.displacement + de)
    pressure, samples = equations.pressure, equations.samples
    there = replace(equations, smooth=replace(smooth, problem=problem, state=state))
    for _ in range(6):  # reactions bend their own element: the law by Newton's method
        there = replace(there, pressure=pressure)
        change = there.contact.change(np.zeros(len(samples.curves.rest)))
        pressure = pressure * np.exp(np.where(there.bears, change / (samples.weight * pressure), 0.0))
    return there


def assert_tangents(found: AsperityEquations) -> None:
    """Remainders of second order of rows and force, in deflections, film pressures and the journal's position."""
    rng, de = np.random.default_rng(2), np.array([3e-3, -2e-3])
    direction = np.concatenate([
        rng.uniform(-1e-3, 1e-3, found.smooth.whole.n_wall), rng.uniform(-0.1, 0.1, found.smooth.whole.n_film)
    ])  # fmt: skip
    change = found.steady @ direction + found.forcing() @ de
    assert_tangent(lambda t: np.concatenate(moved_by(found, t * direction, t * de).residual), change, 2.0**-5)
    force = found.force_rows @ direction + found.force_direct @ de
    assert_tangent(lambda t: moved_by(found, t * direction, t * de).force, force, 2.0**-6)


@pytest.mark.slow
def test_tangent_with_asperities() -> None:
    """Remainder of second order in deflections, film pressures and the journal's position; of the force on it too."""
    slow = {"model.cells_per_pitch": 24, "operation.speed": 200.0, "operation.eccentricity": (0.0, -250e-6)}
    with running():
        found = pressed_at(operating_point(case("paper_n8", **slow), None).answer).equations
    assert np.any(found.points.every_curve < found.smooth.whole.pack.mesh.count), "the journal touches"
    assert_tangents(found)


@pytest.mark.slow
def test_a_stiff_clamped_pack_has_slopes_with_asperities() -> None:
    """Random pack 2, in which sets of contact points keep changing; within 1 % between 64 and 128 cells per pitch."""
    found = []
    for cells in (64, 128):
        bearing = random_case(np.random.default_rng(2), **{"model.cells_per_pitch": cells})
        record = coefficients.record(bearing)
        assert record.scalars["contact_model"] == AT_ASPERITIES
        found.append(record.fields["stiffness"][0])
    assert apart(found[0], found[1]) <= 1e-2
