"""Forces of film and petals on a journal that another program moves.

The program owns the rotor and its integrator, and tells where the journal is and how it moves. The film has a state of
its own, the gas in it, at the time of the last `advance`. A `force` at a later time is the end of one step of TR-BDF2
(of second order, L-stable) from that state, along the cubic through both positions and velocities; the state itself
stays until `advance` moves it. Integrators may therefore ask as often as they like, and reject their own steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.evaluation import closed_film
from petalfoil.analysis.extremes import highest, lowest
from petalfoil.analysis.operating_point import at, at_position
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.dynamics.tr_bdf2 import GAMMA, IMPLICIT, WEIGHT
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.run_context import RunContext, new_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.physics.forces import contact_fraction, node_area
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.tangent import BorderedTangent
from petalfoil.system.build import build_tilting, lever_of
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEP = ContactOptions(tangents=24, steps=8, deepest=-np.inf, borrow=True)
"""The tangent of a step of the same length serves as long as its corrections contract."""

KEPT = 4
"""Step lengths whose tangents are kept: an explicit integrator asks at two or three fractions of each of its steps."""

SAME_TIME = 1e-12
"""Relative difference of two times that are one."""

SAME_PLACE = 1e-12
"""Displacement that counts as zero [m]."""


@dataclass(frozen=True)
class FilmInstant:
    """The film at a time.

    Attributes
    ----------
    time : float
        Time [s].
    x, lam : (n,), (m,) array
        Unknowns and reactions in the units of the problem [1].
    active : (m,) bool array
        Contacts that carry load.
    stored, rates : (n_stored,) array
        What film and wall store, and its rates [1].
    e, v : (d,) array
        Displacement over the reference length and its rate per unit of time [1].
    number : float
        Bearing number of the speed [1].
    """

    time: float
    x: Array
    lam: Array
    active: Mask
    stored: Array
    rates: Array
    e: Array
    v: Array
    number: float


class Film:
    """Film, petals and contacts as another program's integrator calls them.

    Parameters
    ----------
    case : Case
        The bearing; it begins in equilibrium at the case's speed and eccentricity, at time zero.
    tilts : bool
        Whether the journal tilts about the bearing's centre; forces then come with moments.

    Raises
    ------
    UsageError
        The case asks for what has a state of its own that is not followed here: friction between petals, heat.
    ConvergenceError
        There is no equilibrium to begin from.
    """

    def __init__(self, case: Case, *, tilts: bool = False) -> None:
        newton_only(case)
        if case.surface.petal_friction > 0.0 or case.heat is not None:
            raise UsageError(
                "forces for other programs are those of petals without friction and of a film without heat: set "
                "surface.petal_friction to 0 and leave [heat] out, or follow the rotor with `orbit`"
            )
        self.case, self.tilts = case, tilts
        self._run: RunContext = new_run()
        with self._run.active(), one_thread():
            start = self._equilibrium()
        layout = start.problem.layout
        radian = layout.bearing_number(1.0)
        self._rate = case.operation.speed or 1.0 / radian
        self._number_of_radian = radian
        self._still = StepProblem(layout, 0.0, start.problem.displacement, self._rate * radian)
        self._tangents: dict[str, BorderedTangent] = {}
        self._now = self._begun(start)

    # ------------------------------------------------------------------------------------------ what a program asks

    @property
    def time(self) -> float:
        """Time of the film's state [s]."""
        return self._now.time

    @property
    def position(self) -> Array:
        """Displacement (x, y) [m] at that time, with slopes (a_x, a_y) [rad] if the journal tilts."""
        return self._now.e * self._place

    def force(  # noqa: PLR0913 - what another program's integrator has at hand
        self,
        x: float,
        y: float,
        vx: float,
        vy: float,
        speed: float,
        *,
        time: float,
        tilt: tuple[float, float, float, float] | None = None,
    ) -> Array:
        """Force of film and contacts on the journal; the film's state stays as it is.

        Parameters
        ----------
        x, y : float
            Displacement of the journal's centre at `time` [m].
        vx, vy : float
            Its velocity [m/s].
        speed : float
            Angular speed of the shaft [rad/s].
        time : float
            Time [s], not before that of the film's state.
        tilt : (a_x, a_y, b_x, b_y), optional
            Slopes of the journal's axis [rad] and their rates [rad/s], of a film that tilts.

        Returns
        -------
        (2,) or (4,) array
            Force (F_x, F_y) [N], and the moment (M_x, M_y) about the bearing's centre [N m] if the journal tilts.

        Raises
        ------
        UsageError
            The time lies before the film's state.
        ConvergenceError
            The step is too long for the film to be found.
        """
        return self._force(self._reached((x, y), (vx, vy), speed, time, tilt))

    def advance(  # noqa: PLR0913 - as `force`
        self,
        x: float,
        y: float,
        vx: float,
        vy: float,
        speed: float,
        *,
        time: float,
        tilt: tuple[float, float, float, float] | None = None,
    ) -> Array:
        """Move the film's state to `time`, and return the force there; parameters and errors as of `force`."""
        self._now = self._reached((x, y), (vx, vy), speed, time, tilt)
        return self._force(self._now)

    def results(self) -> dict[str, float]:
        """What a result of `solve` tells of the film's state: minimum film thickness, peak pressure, contact fraction.

        Returns
        -------
        dict
            `min_film_thickness` [m], `peak_pressure` [Pa], `contact_fraction` [1], `gas` in the cells of
            the film between its edges [kg] and what of it leaves, `outflow` [kg/s].
        """
        now, layout, rows = self._now, self._still.layout, self._still.layout.film_rows
        problem, film, scales = self._still.at(displacement=now.e), layout.wall.film, layout.scales
        h, p = problem.film(now.x) * scales.length, problem.pressure(now.x) * scales.pressure
        gas, leaving = (
            self._gas * rows.total(part[: film.n_unknown]) for part in (now.stored, -now.rates * self._rate)
        )
        touching = float(now.lam[layout.wall.contacts.journal].sum()) * scales.force
        return {
            "min_film_thickness": closed_film(self.case, h, lowest(h, film.phi, film.axial.z).value),
            "peak_pressure": highest(p, film.phi, film.axial.z).value,
            "contact_fraction": contact_fraction(touching, p - scales.pressure, self._area),
            "gas": gas,
            "outflow": leaving,
        }

    # ------------------------------------------------------------------------------------------ the step

    @property
    def _gas(self) -> float:
        """Gas over what the rows of the film store [kg]."""
        layout, bearing = self._still.layout, self.case.bearing
        whole = 2.0 * np.pi * bearing.journal_radius * bearing.length / float(layout.balance.area.sum())
        strips = len(layout.wall.film.theta)
        return self.case.gas.ambient_density * layout.scales.length * whole / (2.0 * self._still.time_number * strips)

    @property
    def _area(self) -> Array:
        return node_area(self._still.layout.wall.film, self.case.bearing.journal_radius)

    @property
    def _place(self) -> Array:
        """Units of the coordinates: the reference length [m], over the lever for slopes [rad]."""
        length = self._still.layout.scales.length
        return length * np.array([1.0, 1.0, *(2 * [1.0 / lever_of(self.case)] if self.tilts else [])])

    def _equilibrium(self) -> Solution:
        return solve_cold(build_tilting(self.case)) if self.tilts else at_position(at(self.case)).answer

    def _begun(self, start: Solution) -> FilmInstant:
        problem, number = self._still, start.problem.bearing_number
        here = problem.at(bearing_number=number, displacement=start.problem.displacement)
        rates, e = here.storing(start.x, start.lam), start.problem.displacement
        return FilmInstant(
            0.0, start.x, start.lam, start.active, here.stored(start.x), rates, e, np.zeros_like(e), number
        )

    def _reached(
        self,
        place: tuple[float, float],
        velocity: tuple[float, float],
        speed: float,
        time: float,
        tilt: tuple[float, float, float, float] | None,
    ) -> FilmInstant:
        if (tilt is not None) != self.tilts:
            needs = "needs" if self.tilts else "takes no"
            raise UsageError(f"this film {needs} tilt: Film(case, tilts=True) is that of a journal that tilts")
        slopes = tilt or ()
        e = np.array([*place, *slopes[:2]]) / self._place
        v = np.array([*velocity, *slopes[2:]]) / self._place / self._rate
        now, number = self._now, speed * self._number_of_radian
        step = (time - now.time) * self._rate
        if step <= SAME_TIME * max(1.0, abs(time) * self._rate):
            still = float(np.max(np.abs(e - now.e))) * self._still.layout.scales.length <= SAME_PLACE
            if still and step >= -SAME_TIME * max(1.0, abs(time) * self._rate):
                return now
            raise UsageError(
                f"the film is at {now.time:.9g} s already: a force at {time:.9g} s would need a state that is gone; "
                "advance it only to times that the integrator has accepted"
            )
        with self._run.active(), one_thread():
            return self._stepped(now, (e, v, number), step, time)

    def _stepped(self, now: FilmInstant, end: tuple[Array, Array, float], step: float, time: float) -> FilmInstant:
        """One step of TR-BDF2 along a prescribed motion."""
        e, v, number = end
        rate = 1.0 / (IMPLICIT * step)
        start = now.stored + step * IMPLICIT * now.rates
        halfway = (1.0 - GAMMA) * now.number + GAMMA * number
        x, lam, active = self._solved((cubic(now, (e, v), step), halfway), (rate, start), (now.x, now.active))
        between = rate * (self._stored - start)
        start = now.stored + step * WEIGHT * (now.rates + between)
        x, lam, active = self._solved((e, number), (rate, start), (x, active))
        return FilmInstant(time, x, lam, active, self._stored, rate * (self._stored - start), e, v, number)

    def _solved(
        self, where: tuple[Array, float], implicit: tuple[float, Array], guess: tuple[Array, Mask]
    ) -> tuple[Array, Array, Mask]:
        """Film and wall of a stage at a position and bearing number; `_stored` is what they store then."""
        (e, number), (rate, start) = where, implicit
        still = self._still
        problem = StepProblem(still.layout, number, e, still.time_number, rate, start)
        length = f"{rate:.9e}"
        tangent = self._tangents.pop(length, None)
        found, outcome = solve_contacts(problem, guess, self._run.film_solver, STEP, tangent)
        if found is None:
            raise ConvergenceError(
                f"no film at ({1e6 * e[0] * still.layout.scales.length:.4g} µm, "
                f"{1e6 * e[1] * still.layout.scales.length:.4g} µm) after {self._now.time:.6g} s: {outcome.value}",
                history=list(self._run.history),
                advice="take shorter steps, or a position at which the journal is clear of the solid pack",
            )
        self._tangents = dict([*self._tangents.items(), (length, found.tangent)][-KEPT:])
        self._stored = problem.stored(found.x)
        return found.x, found.lam, found.active

    def _force(self, instant: FilmInstant) -> Array:
        layout = self._still.layout
        force = self._still.at(displacement=instant.e).journal_force(instant.x, instant.lam) * layout.scales.force
        if self.tilts:
            force[2:] *= lever_of(self.case)
        return force


def cubic(now: FilmInstant, end: tuple[Array, Array], step: float) -> Array:
    """Position at the inner instant of a step, on the cubic through positions and velocities of both ends, (d,) [1]."""
    s, (e, v) = GAMMA, end
    place = (1.0 + 2.0 * s) * (1.0 - s) ** 2 * now.e + s**2 * (3.0 - 2.0 * s) * e
    moving = s * (1.0 - s) ** 2 * now.v - s**2 * (1.0 - s) * v
    return np.asarray(place + step * moving)
