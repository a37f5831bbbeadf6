"""A flexible rotor of ROSS (https://github.com/petrobras/ross) on two petal bearings, in time and nonlinear.

    python examples/ross_rotor.py FIGURE.png

ROSS gives the matrices of a hollow shaft of 0.4 m with a disk off its middle; its bearings are left out. The lowest
modes of the free rotor are integrated by SciPy, and each journal has the film of a petal bearing of its own, with its
nonlinear force and its state. The unbalance turns at 8000 rad/s, a tenth below the first bending frequency.

What `run` needs of the rotor is `M q'' + speed G q' + K q = f` and the degrees of freedom of its journals: matrices of
any other program do. Needs ross-rotordynamics 3 (Python 3.12 or newer).
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.linalg
from scipy.integrate import solve_ivp

import petalfoil

GRAVITY = 9.80665  # m/s^2, along -y
HIGHEST = 5.0  # modes are kept up to this multiple of the speed: beyond it they follow the forces
TURNS, STEPS = 4, 40  # turns, and steps of a turn


@dataclass
class FreeRotor:
    """A rotor without bearings, `M q'' + speed G q' + K q = f` with matrices (n, n).

    `journals` and `unbalanced` are the degrees of freedom (x, y) of its journals and its `unbalance` [kg m]; `upward`
    (n,) is 1 at displacements along y, else 0.
    """

    M: np.ndarray
    K: np.ndarray
    G: np.ndarray
    journals: list[tuple[int, int]]
    unbalanced: tuple[int, int]
    unbalance: float
    upward: np.ndarray


class Modes:
    """The lowest lateral modes of a free rotor, up to a frequency [rad/s]; k of them."""

    def __init__(self, rotor: FreeRotor, highest: float) -> None:
        squared, shapes = scipy.linalg.eigh(rotor.K, rotor.M)
        lateral = np.abs(shapes[np.ravel(rotor.journals)]).max(axis=0) > 1e-6
        kept = lateral & (squared <= highest**2)
        shapes = shapes[:, kept]  # normalised: shapes^T M shapes = 1
        self.rigid = np.abs(squared[kept]) < 1e-6 * highest**2
        self.stiffness = np.where(self.rigid, 0.0, squared[kept])
        self.gyroscopic = shapes.T @ rotor.G @ shapes
        self.weight = -GRAVITY * shapes.T @ (rotor.M @ rotor.upward)
        self.journals = [shapes[list(dofs)] for dofs in rotor.journals]  # (axis, mode) each
        self.unbalanced = rotor.unbalance * shapes[list(rotor.unbalanced)]
        self.places = shapes[[*np.ravel(rotor.journals), *rotor.unbalanced]]

    def loads(self) -> np.ndarray:
        """Load on each bearing, downward [N]: the films must hold the rigid modes."""
        upward = np.stack([place[1, self.rigid] for place in self.journals], axis=1)
        return -np.linalg.lstsq(upward, self.weight[self.rigid], rcond=None)[0]

    def begun(self, positions: list[np.ndarray], speed: float) -> np.ndarray:
        """Modal coordinates and velocities (2 k,) of the rotor, its journals at `positions`, bent by its weight.

        It turns about its mass centre, as a free rotor does: the unbalance begins without a blow.
        """
        whirl = speed**2 * self.unbalanced / (self.stiffness - speed**2)
        force = self.weight + sum(load * place[1] for load, place in zip(self.loads(), self.journals, strict=True))
        bent = np.divide(force, self.stiffness, out=np.zeros_like(force), where=~self.rigid) + whirl[0]
        bent[self.rigid] = 0.0
        places, there = np.concatenate(self.journals), np.concatenate(positions)
        bent[self.rigid] = np.linalg.lstsq(places[:, self.rigid], there - places @ bent, rcond=None)[0]
        return np.concatenate([bent, speed * whirl[1]])


def from_ross() -> FreeRotor:
    """A hollow shaft of eight elements with a disk, from ROSS."""
    import ross as rs  # loads for seconds

    steel = rs.Material("steel", rho=7850.0, E=2.02e11, Poisson=0.29)
    shaft = [rs.ShaftElement(L=0.05, idl=0.042, odl=0.05, material=steel) for _ in range(8)]
    disk = rs.DiskElement(n=5, m=1.2, Ip=1.5e-3, Id=0.8e-3)
    rotor = rs.Rotor(shaft, [disk])
    per_node = rotor.number_dof
    one, two, at_disk = ((per_node * node, per_node * node + 1) for node in (1, 7, 5))
    upward = np.tile(np.arange(per_node) == 1, len(rotor.M()) // per_node).astype(float)
    return FreeRotor(rotor.M(), rotor.K(0.0), rotor.G(), [one, two], at_disk, disk.m * 2e-6, upward)


def loaded(modes: Modes, case: petalfoil.Case) -> list[petalfoil.Film]:
    """The films in equilibrium under the weight of the rotor: contacts of a film in motion are at nodes."""
    films, at_nodes = [], case.replace(**{"model.contacts": "nodes"})
    for load in modes.loads():
        placed = petalfoil.balance(at_nodes, float(load))
        e = tuple(float(placed[f"eccentricity_{axis}"]) for axis in "xy")
        films.append(petalfoil.Film(case.replace(**{"operation.eccentricity": e})))
    return films


def run(rotor: FreeRotor, case: petalfoil.Case, turns: float = TURNS) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and positions (time, journal or unbalance, axis) [m]; a film goes on where a step is accepted."""
    speed = case.operation.speed
    modes = Modes(rotor, HIGHEST * speed)
    films = loaded(modes, case)
    state = modes.begun([film.position for film in films], speed)

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        eta, velocity = np.split(state, 2)
        turning = speed**2 * np.array([np.cos(speed * t), np.sin(speed * t)])
        force = modes.weight + turning @ modes.unbalanced - speed * modes.gyroscopic @ velocity - modes.stiffness * eta
        for film, place in zip(films, modes.journals, strict=True):
            force = force + film.force(*(place @ eta), *(place @ velocity), speed, time=t) @ place
        return np.concatenate([velocity, force])

    step = 2.0 * np.pi / speed / STEPS
    times, states = [0.0], [state]
    for _ in range(round(turns * STEPS)):
        t = times[-1]
        # one step, whatever its error: the step is chosen above
        one = solve_ivp(
            lambda after, y, t=t: rates(t + after, y),
            (0.0, step),
            state,
            method="RK23",
            first_step=step,
            max_step=step,
            rtol=1.0,
            atol=1.0,
        )
        state = one.y[:, -1]
        eta, velocity = np.split(state, 2)
        for film, place in zip(films, modes.journals, strict=True):
            film.advance(*(place @ eta), *(place @ velocity), speed, time=t + step)
        times.append(t + step)
        states.append(state)
    positions = np.array(states)[:, : len(eta)] @ modes.places.T
    return np.array(times), positions.reshape(len(times), -1, 2)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(f"usage: python examples/{Path(__file__).name} FIGURE.png")
    from matplotlib.figure import Figure

    example = petalfoil.Case.load(Path(__file__).parent / "paper_n8.toml").replace(**{"model.cells_per_pitch": 32})
    free = from_ross()
    modes = Modes(free, HIGHEST * example.operation.speed)
    print(f"bending modes at {', '.join(f'{np.sqrt(value):.0f}' for value in modes.stiffness[~modes.rigid])} rad/s")
    print(f"loads on the bearings: {modes.loads()[0]:.2f} and {modes.loads()[1]:.2f} N")
    _, path = run(free, example)
    last = path[-2 * STEPS :]
    for column, name in enumerate(("first journal", "second journal", "disk")):
        swing = np.ptp(last[:, column], axis=0) / 2.0
        print(f"{name}: swings {1e6 * swing[0]:.3f} µm in x, {1e6 * swing[1]:.3f} µm in y over the last two turns")
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    axes = figure.subplots()
    for column, name in enumerate(("first journal", "second journal", "disk")):
        axes.plot(*(1e6 * path[:, column].T), label=name)
    axes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal", title="A flexible rotor of ROSS on two petal bearings")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(sys.argv[1], dpi=120)
