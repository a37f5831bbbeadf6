"""A flexible rotor of your own on eight petals, integrated by SciPy: what `orbit` does for a rigid one.

    python examples/own_rotor.py FIGURE.png

A symmetric rotor, seen as its half on one bearing: a disk of 2 kg whose mass centre is 2 µm off the axis, an elastic
shaft of 4 MN/m, a journal of 0.5 kg. Any rotor model with forces at its journals takes the place of `rates`: only
`film.force` and `film.advance` are petalfoil's.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import petalfoil

DISK, JOURNAL, SHAFT, UNBALANCE = 2.0, 0.5, 4e6, 2e-6  # kg, kg, N/m, m
GRAVITY = np.array([0.0, -9.80665])
TURNS, STEPS = 6, 40  # turns, and steps of a turn


def rates(film: petalfoil.Film, speed: float, t: float, state: np.ndarray) -> np.ndarray:
    """Velocities and accelerations of disk and journal, `state` being their positions and velocities."""
    disk, journal, v_disk, v_journal = state.reshape(4, 2)
    turning = DISK * UNBALANCE * speed**2 * np.array([np.cos(speed * t), np.sin(speed * t)])
    pulled = SHAFT * (disk - journal)
    pushed = film.force(*journal, *v_journal, speed, time=t)
    a_disk = (turning - pulled) / DISK + GRAVITY
    a_journal = (pulled + pushed) / JOURNAL + GRAVITY
    return np.concatenate([v_disk, v_journal, a_disk, a_journal])


def run(case: petalfoil.Case, turns: float = TURNS) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and states along the way; the film goes on where a step of the integrator is accepted."""
    film, speed = petalfoil.Film(case), case.operation.speed
    step = 2.0 * np.pi / speed / STEPS
    # the disk hangs from the journal by its weight, and turns about its mass centre: a start without a blow
    disk = film.position + DISK * GRAVITY / SHAFT - np.array([UNBALANCE, 0.0])
    state = np.concatenate([disk, film.position, [0.0, -UNBALANCE * speed], np.zeros(2)])
    times, states = [0.0], [state]
    for _ in range(round(turns * STEPS)):
        t = times[-1]
        one = solve_ivp(
            lambda after, y, t=t: rates(film, speed, t + after, y),
            (0.0, step),
            state,
            method="RK23",
            first_step=step,
            max_step=step,
            rtol=1.0,
            atol=1.0,  # one step, whatever its error: the step is chosen above
        )
        state = one.y[:, -1]
        film.advance(*state[2:4], *state[6:8], speed, time=t + step)
        times.append(t + step)
        states.append(state)
    return np.array(times), np.array(states)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(f"usage: python examples/{Path(__file__).name} FIGURE.png")
    from matplotlib.figure import Figure

    example = petalfoil.Case.load(Path(__file__).parent / "paper_n8.toml")
    load = (DISK + JOURNAL) * float(-GRAVITY[1])
    # contacts of a film in motion are at nodes: it is at rest where a balance with contacts there is
    placed = petalfoil.balance(example.replace(**{"model.cells_per_pitch": 32, "model.contacts": "nodes"}), load)
    start = tuple(float(placed[f"eccentricity_{axis}"]) for axis in "xy")
    _, path = run(example.replace(**{"model.cells_per_pitch": 32, "operation.eccentricity": start}))
    figure = Figure(figsize=(6.0, 5.0), layout="constrained")
    axes = figure.subplots()
    for name, column in (("disk", 0), ("journal", 2)):
        axes.plot(1e6 * path[:, column], 1e6 * path[:, column + 1], label=name)
    axes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal", title="A flexible rotor on eight petals")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(sys.argv[1], dpi=120)
    print(f"largest swing of the disk against the journal: {1e6 * np.ptp(path[:, 1] - path[:, 3]) / 2.0:.3g} µm")
