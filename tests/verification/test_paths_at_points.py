"""Paths of packs at rest with friction at contact points (M13): grids, Coulomb's law, energy, limits, lost points."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.equilibrium import friction_history, point_friction_path
from petalfoil.equilibrium.contact_sets import listed, packed, revised, without_loose
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.element_contacts import with_elements
from petalfoil.equilibrium.friction_handover import at_nodes
from petalfoil.equilibrium.friction_history import assembled, led
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.pack_at_rest import unloaded
from petalfoil.equilibrium.point_friction_path import RubbingPoints, slide_at_points
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS, HELD_AT_NODES
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of
from petalfoil.system.pack_at_points import PackAtPoints
from petalfoil.system.point_equations import PointState, same_contacts
from petalfoil.system.point_friction import PointFriction, stretching_energy
from petalfoil.system.sinking_points import SinkingPoints
from tests.cases import case
from tests.contract.taylor import assert_tangent

Array = NDArray[np.float64]


def rubbing(name: str, mu: float, cells: int, **changes: object) -> Case:
    """One of the examples with friction."""
    return case(name, **{"model.cells_per_pitch": cells, "surface.petal_friction": mu, **changes})


@dataclass(frozen=True)
class Path:
    """States of a pack, each from the one before, and where the journal is in each [1]."""

    problem: CoupledProblem
    coefficient: float
    states: list[RubbingPoints]
    places: Array

    def law(self, number: int) -> PointFriction:
        """Friction of the step to a state."""
        return self.states[number - 1].law(self.coefficient)


@cache
def followed(name: str, mu: float, cells: int, way: tuple[float, ...], steps: int) -> Path:
    """The assembled pack, its journal led down through `way` [m] in so many equal steps from turn to turn."""
    bearing = rubbing(name, mu, cells)
    problem = build_problem(bearing).at(bearing_number=0.0)
    friction, down = friction_of(bearing, problem.layout), np.array([0.0, -1.0]) / problem.layout.scales.length
    assert friction is not None
    with running():
        start = assembled(friction, problem.at(displacement=0.0 * down))
        assert start is not None
        states, places = [start.state], [0.0 * down]
        for a, b in zip((0.0, *way[:-1]), way, strict=True):
            for e in np.linspace(a, b, steps + 1)[1:]:
                there = unloaded(problem.at(displacement=e * down), still=True)
                end = led(friction, states[-1], lambda _, pack=there: pack, 1)  # type: ignore[misc]
                assert end is not None
                assert end.steps == 1
                states.append(end.state)
                places.append(e * down)
    points = [state for state in states if isinstance(state, RubbingPoints)]
    assert len(points) == len(states)
    return Path(problem, mu, points, np.array(places))


def stored(state: RubbingPoints) -> float:
    """Energy of bending, of elements that points bend further (K11), of stretching [1]."""
    equations, points = state.equations, state.state.points
    curvature = equations.whole.bending @ state.state.w
    bent = 0.5 * float(curvature @ curvature + points.reaction @ equations.gaps.bending)
    return bent + stretching_energy(equations.whole, points, state.force)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "deep", "grids"), [("rig", 10e-6, (24, 48)), ("paper_n8", 50e-6, (12, 24))])
def test_a_loop_is_the_same_on_two_grids(name: str, deep: float, grids: tuple[int, int]) -> None:
    """Forces in steps of the same length to 5e-4 of the largest; contacts at nodes are fifty times as far apart."""
    away = []
    for contacts in ("points", "nodes"):
        forces = []
        for cells in grids:
            bearing = rubbing(name, 0.3, cells, **{"model.contacts": contacts})
            records = list(static.records(bearing, np.linspace(0.0, deep, 5), loop=True))
            expected = AT_POINTS if contacts == "points" else HELD_AT_NODES
            assert {record.scalars["contact_model"] for record in records} == {expected}
            assert {record.scalars["point_share"] for record in records} == {float(contacts == "points")}
            assert all(float(record.scalars["residual"]) <= 1e-8 for record in records)
            forces.append([float(record.scalars["force_y"]) for record in records])
        away.append(np.max(np.abs(np.diff(forces, axis=0))) / np.max(forces))
    assert away[0] < 5e-4
    assert away[1] > 50.0 * away[0]


@pytest.mark.slow
def test_contacts_keep_coulombs_law() -> None:
    """Friction within its limit, slip only at the limit and forward; contacts of both kinds, and slips both ways."""
    path = followed("paper_n8", 0.1, 12, (20e-6, 5e-6), 4)
    sliding, sticking = set(), 0
    for number in range(1, len(path.states)):
        law, state = path.law(number), path.states[number]
        after = law.state(state.state, state.force)
        rubs = law.rubs(state.state.points)
        limit, force, slip = (values[rubs] for values in (after.limit, after.force, after.slip))
        assert np.all(np.abs(force) <= limit + 1e-9 * np.max(limit))
        slides = np.abs(slip) > 1e-8
        assert_allclose(force[slides], (np.sign(slip) * limit)[slides], rtol=1e-9, atol=1e-9 * np.max(limit))
        assert np.all(after.force[np.setdiff1d(np.arange(len(after.force)), rubs)] == 0.0)
        sliding |= {float(sign) for sign in np.sign(slip[slides & (limit > 0.0)])}
        sticking += int(np.sum(~slides & (limit > 1e-3 * np.max(limit))))
        assert law.broken(after) <= 1e-8
        twice = law.state(state.state, 2.0 * state.force)
        assert law.broken(twice) > 1e-3  # it can tell
    assert sliding == {-1.0, 1.0}
    assert sticking


@pytest.mark.slow
def test_energy_is_stored_or_lost_to_the_order_of_the_steps() -> None:
    """Down and back up: work of the journal against energies of petals and what friction took; steps halved twice."""
    errors = []
    for steps in (4, 8, 16):
        path = followed("paper_n8", 0.1, 12, (20e-6, 5e-6), steps)
        force = np.array([state.equations.journal_force for state in path.states])
        work = -float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(path.places, axis=0)))
        lost = sum(state.lost for state in path.states[1:])
        assert all(state.lost >= 0.0 for state in path.states[1:])
        errors.append(abs(work - lost - stored(path.states[-1]) + stored(path.states[0])) / lost)
    assert errors[0] < 5e-2
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


@pytest.mark.slow
def test_little_friction_is_the_pack_without_and_loses_its_limit_times_the_slip() -> None:
    """Force of an equilibrium without friction; loss of a cycle `mu N |s|` of its contacts, in proportion to `mu`."""
    ends, losses = [], []
    for mu in (2e-5, 1e-5):
        path = followed("rig", mu, 12, (3e-6, 1e-6, 3e-6), 4)
        cycle = range(5, 13)
        losses.append(sum(path.states[number].lost for number in cycle))
        of_slips = 0.0
        for number in cycle:
            law, state = path.law(number), path.states[number]
            points, before = state.state.points, path.states[number - 1].state.points
            slip = np.abs(law.slip(state.state, state.force).value)
            mean = 0.5 * (points.reaction + before.reaction)  # the same contacts in this cycle
            of_slips += mu * float(np.sum((mean * slip)[law.rubs(points)]))
        assert losses[-1] == pytest.approx(of_slips, rel=1e-6)
        ends.append(path.states[-1].equations.journal_force[1])
    assert losses[0] == pytest.approx(2.0 * losses[1], rel=1e-3)
    down = np.array([0.0, -3e-6]) / path.problem.layout.scales.length
    with running():
        answer = rest(path.problem.at(displacement=down))
        assert answer is not None
        free = with_elements(answer).elements
    assert free is not None
    assert ends[0] - free.equations.force[1] == pytest.approx(2.0 * (ends[1] - free.equations.force[1]), rel=0.02)
    assert ends[0] == pytest.approx(free.equations.force[1], rel=1e-3)


@pytest.mark.slow
def test_much_friction_loses_nothing_and_leads_back() -> None:
    """A pack without friction forces whose contacts then stick is elastic: the way back is the way there."""
    free = followed("paper_n8", 1e-9, 12, (1e-6, 0.0), 2)
    state = free.states[0]
    force, energy, lost = [state.equations.journal_force[1]], [stored(state)], 0.0
    with running() as run:
        for place in free.places[1:]:
            ahead = PackAtPoints.of(state.whole, free.problem.at(displacement=place), state.state, state.force)
            found = slide_at_points(ahead, state.law(5.0), run.pack_solver)
            assert found is not None
            state = found
            force.append(state.equations.journal_force[1])
            energy.append(stored(state))
            lost += state.lost
    assert lost < 1e-6 * (energy[2] - energy[0])
    assert_allclose([force[3], energy[3] - energy[0]], [force[1], energy[1] - energy[0]], rtol=1e-4)
    assert abs(force[4]) < 1e-4 * force[2]
    softer = free.states[2].equations.journal_force[1]
    assert force[2] > 3.0 * softer


@pytest.mark.slow
def test_a_state_goes_to_nodes_and_comes_back() -> None:
    """Force and friction forces of the way to nodes and back again are within what the two grids differ by."""
    path = followed("paper_n8", 0.1, 24, (20e-6,), 4)
    state = path.states[-1]
    friction = friction_of(path.problem.layout.case, path.problem.layout)
    assert friction is not None
    pack = unloaded(path.problem.at(displacement=path.places[-1]), still=True)
    with running():
        handed = at_nodes(friction, state, pack)
        assert handed is not None
        nodal = friction_history.slid_to(pack, friction, handed)
        assert isinstance(nodal, FrictionResult)
        back = friction_history.with_points(friction, pack, nodal)
    assert back is not None
    ahead_force, back_force = (one.equations.journal_force[1] for one in (state, back))
    assert back_force == pytest.approx(ahead_force, rel=0.02)
    assert nodal.lost < 0.05 * sum(one.lost for one in path.states)
    assert np.sum(np.abs(back.force)) == pytest.approx(np.sum(np.abs(state.force)), rel=0.05)
    assert np.sum(back.state.points.reaction) == pytest.approx(np.sum(state.state.points.reaction), rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("halved", [0, friction_history.MOST_HALVED])
def test_points_that_are_lost_come_back_and_it_is_told(monkeypatch: pytest.MonkeyPatch, halved: int) -> None:
    """No points are found in the fourth step, however short: nodes carry the friction over it, or to its way's end."""
    monkeypatch.setattr(friction_history, "MOST_HALVED", halved)
    calls: list[float] = []

    def sometimes(ahead: PackAtPoints, *others: object) -> RubbingPoints | None:
        calls.append(float(ahead.problem.displacement[1]))
        lost = ahead.withdrawn == 0.0 and -14e-6 < calls[-1] * length < -6e-6
        return None if lost else slide_at_points(ahead, *others)  # type: ignore[arg-type]

    bearing = rubbing("paper_n8", 0.1, 24)
    length = build_problem(bearing).layout.scales.length
    way = np.linspace(0.0, 20e-6, 5)
    expected = list(static.records(bearing, way))
    monkeypatch.setattr(friction_history, "slide_at_points", sometimes)
    records: list[Record] = list(static.records(bearing, way))
    assert [record.scalars["contact_model"] for record in records] == [
        AT_POINTS, AT_POINTS, HELD_AT_NODES, AT_POINTS, AT_POINTS,
    ]  # fmt: skip
    share = [float(record.scalars["point_share"]) for record in records]
    assert share[:2] == [1.0, 1.0]
    assert share[2] < share[4] < 1.0
    for one, other in zip(records, expected, strict=True):
        assert float(one.scalars["force_y"]) == pytest.approx(float(other.scalars["force_y"]), rel=0.05, abs=0.05)


def halved(points: ContactPoints) -> ContactPoints:
    """The contacts with the first isolated point inside an element of its curve as two, near enough to meet again."""
    contacts = listed(points)
    number = next(k for k, one in enumerate(contacts) if not one.inner and 0.1 < one.position % 1.0 < 0.9)
    one = contacts[number]
    parts = [replace(one, position=one.position + way, reaction=0.5 * one.reaction) for way in (-0.02, 0.02)]
    return packed([*contacts[:number], *parts, *contacts[number + 1 :]])


@pytest.mark.slow
def test_a_point_that_meets_again_after_it_was_split_stays_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gaps that ask for a split whenever they may: they may once, and the step ends with the contacts it began with."""
    path, asked = followed("paper_n8", 0.1, 12, (20e-6, 5e-6), 4), []

    def always_split(ahead: PackAtPoints, *, splitting: bool) -> ContactPoints | None:
        asked.append(splitting)
        return halved(ahead.state.points) if splitting else revised(ahead, splitting=False)

    begin, there = path.states[-2], path.problem.at(displacement=path.places[-1])
    ahead = PackAtPoints.of(begin.whole, there, begin.state, begin.force)
    with running() as run:
        expected = slide_at_points(ahead, path.law(len(path.states) - 1), run.pack_solver)
        monkeypatch.setattr(point_friction_path, "revised", always_split)
        found = slide_at_points(ahead, path.law(len(path.states) - 1), run.pack_solver)
    assert expected is not None
    assert found is not None
    assert asked == [True, False]
    assert same_contacts(found.state, expected.state)
    assert_allclose(found.state.points.reaction, expected.state.points.reaction, rtol=1e-6, atol=1e-9)


def test_points_that_pull_by_themselves_are_given_up_and_stretches_but_by_what_opens() -> None:
    """Points of a stretch may pull by rounding; one by itself may not, as nothing but its own gap says where it is."""
    problem = build_problem(rubbing("paper_n8", 0.1, 12)).at(bearing_number=0.0)
    whole = problem.layout.elements
    assert whole is not None
    places, stretch = np.array([1.2, 3.0, 5.0]), np.array([0, 2, 0])

    def left(*reactions: float) -> ContactPoints | None:
        points = ContactPoints(np.full(3, 9), places, stretch, np.array(reactions))
        state = PointState(np.zeros(whole.n_wall), np.ones(whole.n_film), points)
        return without_loose(PackAtPoints.of(whole, problem, state, np.zeros(len(reactions))))

    assert left(1.0, 1.0, 1.0, 1.0, 1.0) is None
    assert left(1.0, 1.0, -1e-12, 1.0, 1.0) is None
    alone, torn = left(-1e-12, 1.0, -1e-12, 1.0, 1.0), left(1.0, 1.0, -1.0, 1.0, 1.0)
    assert alone is not None
    assert torn is not None
    assert_allclose(alone.position, places[1:])
    assert_allclose(alone.reaction, [1.0, 0.0, 1.0, 1.0])
    assert len(torn.reaction) == 4


@pytest.mark.slow
def test_a_step_costs_as_many_factorisations_on_every_grid() -> None:
    """Eight petals moved by 10 um in steps of 5 um, contacts at points: three each, whatever the number of cells."""
    for cells in (12, 48):
        bearing = rubbing("paper_n8", 0.1, cells)
        problem = build_problem(bearing).at(bearing_number=0.0)
        friction, down = friction_of(bearing, problem.layout), np.array([0.0, -1e-5]) / problem.layout.scales.length
        assert friction is not None
        with running():
            start = assembled(friction, problem.at(displacement=0.0 * down))
        assert start is not None
        with running() as run:
            centred = problem.at(displacement=0.0 * down)
            end = friction_history.moved(friction, (centred, start.state), problem.at(displacement=down))
        assert end is not None
        assert end.at_points == end.steps == 2
        assert run.pack_solver.counter.factorizations <= 3 * end.steps


@pytest.mark.slow
def test_tangent_of_a_step_in_a_medium() -> None:
    """Taylor's test in petals, pressures, reactions, places and position, friction forces held: rows and force."""
    path = followed("paper_n8", 0.1, 12, (20e-6, 5e-6), 4)
    state, rng = path.states[-1], np.random.default_rng(5)
    assert np.any(state.force)
    whole, problem = state.whole, path.problem.at(displacement=path.places[-1], bearing_number=2.0)
    points, n = state.state.points, whole.n_wall
    film = 1.0 + 0.05 * rng.uniform(-1.0, 1.0, whole.n_film)
    base = SinkingPoints(
        whole, problem, replace(state.state, P=film), friction_force=state.force,
        journal=2.0, petals=3.0, place=np.array([0.1, -0.2]), before=np.zeros(n),
    )  # fmt: skip
    change, move = 0.1 * rng.uniform(-1.0, 1.0, base.n), np.array([0.02, -0.03])
    change[:n] *= 0.1
    first, last = n + whole.n_film, base.n - len(points.position)
    change[first:last] *= 1.0 - base.idle
    change[last:] *= base.travels

    def at(t: float) -> SinkingPoints:
        dw, dP, dlam, dt = np.split(t * change, np.cumsum([n, whole.n_film, len(points.reaction)]))
        there = replace(points, position=points.position + dt, reaction=points.reaction + dlam)
        moved = base.problem.at(displacement=problem.displacement + t * move)
        return replace(base, problem=moved, state=PointState(state.state.w + dw, film + dP, there))

    assert_tangent(lambda t: at(t).newton_residual, base.steady @ change + base.forcing() @ move, largest=2.0**-8)
    assert_tangent(lambda t: at(t).force, base.force_rows @ change + base.force_direct @ move, largest=2.0**-8)
