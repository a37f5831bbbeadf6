"""What the histories of a motion tell: places once a turn, spectra of the whirl, its dominant frequency.

The steps of a motion are not equally long. Between them the path is the cubic that has the positions and velocities of
both ends, so that it can be read at any instant. The whirl is the complex number `x + i y`: a circle of forward whirl
has a positive frequency, one of backward whirl a negative frequency of the same size.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

TURN = 2.0 * math.pi
SAMPLES_A_TURN = 64
"""Instants of a turn at the highest speed at which a spectrum reads the path."""
MOST_SAMPLES = 2**18
LEAST_TURNS = 4.0
"""Turns below which a spectrum cannot tell half the speed from the speed."""
SETTLED = 0.5
"""Part of a motion at its end that is taken for settled."""
SLOPES = {"x": "slope_x", "y": "slope_y", "velocity_x": "slope_rate_x", "velocity_y": "slope_rate_y"}
"""Histories of the shaft's slope beside those of the position."""


@dataclass(frozen=True)
class Path:
    """The path of the journal's centre, readable at any instant.

    Attributes
    ----------
    time : (n,) array
        Instants of the steps, increasing [s].
    x, y, velocity_x, velocity_y : (n,) arrays
        Positions [m] and velocities [m/s] there.
    angle : (n,) array
        Angle that the shaft has turned [rad].
    speed : (n,) array
        Angular speed of the shaft [rad/s].
    """

    time: Array
    x: Array
    y: Array
    velocity_x: Array
    velocity_y: Array
    angle: Array
    speed: Array

    @classmethod
    def of(cls, time: Array, over: Mapping[str, Array]) -> Path:
        """The path from histories by their names in the schema."""
        named = ("x", "y", "velocity_x", "velocity_y", "shaft_angle", "shaft_speed")
        return cls(time, *(over[name] for name in named))

    @classmethod
    def journals(cls, time: Array, over: Mapping[str, Array], places: tuple[float, ...]) -> tuple[Path, ...]:
        """The path of each journal; of a shaft that tilts, those at `places` [m] from the mass centre."""
        centre = cls.of(time, over)
        if len(places) == 1:
            return (centre,)
        return tuple(
            replace(centre, **{name: over[name] + place * over[slope] for name, slope in SLOPES.items()})
            for place in places
        )

    @property
    def turns(self) -> float:
        """Revolutions of the shaft from start to end."""
        return float(self.angle[-1] - self.angle[0]) / TURN

    @property
    def is_steady(self) -> bool:
        """Whether the shaft turns at one speed, and turns."""
        return bool(self.speed[0] > 0.0 and np.ptp(self.speed) <= 1e-9 * self.speed[0])

    def at(self, instants: Array) -> Complex:
        """Positions `x + i y` at instants between the steps [m]."""
        if len(self.time) < 2:
            return np.full(len(instants), self.x[0] + 1j * self.y[0])
        from scipy.interpolate import CubicHermiteSpline  # 0.3 s: only for those who read between steps

        x = CubicHermiteSpline(self.time, self.x, self.velocity_x)(instants)
        y = CubicHermiteSpline(self.time, self.y, self.velocity_y)(instants)
        return np.asarray(x + 1j * y, dtype=np.complex128)

    def once_a_turn(self) -> Complex:
        """Positions at every whole turn of the shaft (Poincaré's points) [m]; none where the shaft stands."""
        if self.turns < 1.0:
            return np.empty(0, dtype=np.complex128)
        first, last = math.ceil(self.angle[0] / TURN - 1e-9), math.floor(self.angle[-1] / TURN + 1e-9)
        moving = np.concatenate([[True], np.diff(self.angle) > 0.0])  # while the shaft stands no turn begins
        return self.at(np.interp(np.arange(first, last + 1) * TURN, self.angle[moving], self.time[moving]))

    def evenly(self, since: float) -> tuple[float, Complex]:
        """Time step [s] and positions [m] at equal steps from `since` [s] to the end."""
        lasts, top = float(self.time[-1]) - since, float(self.speed.max())
        wanted = SAMPLES_A_TURN * lasts * top / TURN if top > 0.0 else len(self.time)
        count = int(min(max(wanted, 16.0), MOST_SAMPLES))
        instants = np.linspace(since, float(self.time[-1]), count)
        return lasts / (count - 1), self.at(instants)

    def settled_since(self) -> float:
        """Instant after which the motion is taken for settled: its last half, but `LEAST_TURNS` if there are [s]."""
        enough = min(max(SETTLED * self.turns, LEAST_TURNS), self.turns)
        if enough <= 0.0:
            return float(self.time[-1] - SETTLED * (self.time[-1] - self.time[0]))
        return float(np.interp(self.angle[-1] - enough * TURN, self.angle, self.time))


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes of the circles that a whirl is made of.

    Attributes
    ----------
    frequency : (n,) array
        Angular frequency, negative for backward whirl, increasing [rad/s].
    amplitude : (n,) array
        Radius of the circle [m].
    resolution : float
        Distance of two frequencies that are told apart [rad/s].
    """

    frequency: Array
    amplitude: Array
    resolution: float

    def peak(self) -> tuple[float, float]:
        """Frequency [rad/s] and radius [m] of the largest circle, read between the lines; slow drift left out."""
        heights = np.where(np.abs(self.frequency) < 1.5 * self.resolution, 0.0, self.amplitude)
        top = int(np.clip(np.argmax(heights), 1, len(heights) - 2))
        low, mid, high = np.log(np.maximum(self.amplitude[top - 1 : top + 2], 1e-300))
        bend = low - 2.0 * mid + high
        shift = float(np.clip(0.5 * (low - high) / bend, -0.5, 0.5)) if bend < 0.0 else 0.0
        line = float(self.frequency[1] - self.frequency[0])
        return float(self.frequency[top]) + shift * line, float(np.exp(mid - 0.25 * (low - high) * shift))


def spectrum(path: Path, since: float | None = None) -> Spectrum:
    """Full spectrum of the whirl from `since` [s] to the end; by default of what is taken for settled.

    Mean and drift are taken out; Hann's window is corrected for, so that a circle of radius `a` is a peak of height
    `a`.
    """
    start = path.settled_since() if since is None else since
    step, z = path.evenly(start)
    return lines_of(step, z)


def lines_of(step: float, z: Complex) -> Spectrum:
    """Spectrum of positions at equal time steps."""
    count = len(z)
    window = np.hanning(count + 1)[:-1]
    padded = 4 * count  # lines four times as dense as the resolution: peaks are read off between them
    amplitude = np.abs(np.fft.fftshift(np.fft.fft(window * without_drift(z), padded))) / window.sum()
    frequency = TURN * np.fft.fftshift(np.fft.fftfreq(padded, step))
    return Spectrum(frequency, amplitude, TURN / (count * step))


def without_drift(z: Complex) -> Complex:
    """Positions less the straight line that fits them best."""
    place = np.linspace(-1.0, 1.0, len(z))
    slope = np.sum(place * z) / np.sum(place**2)
    return np.asarray(z - z.mean() - slope * place, dtype=np.complex128)


def dominant_whirl_ratio(path: Path) -> float:
    """Frequency of the largest circle over the speed, in the settled part; NaN where too few turns tell none."""
    if path.turns < LEAST_TURNS:
        return math.nan
    since = path.settled_since()
    turned = np.interp([since, path.time[-1]], path.time, path.angle)
    mean_speed = float(turned[1] - turned[0]) / (float(path.time[-1]) - since)
    frequency, radius = spectrum(path, since).peak()
    return frequency / mean_speed if radius > 0.0 else math.nan


def settled_amplitude(path: Path) -> float:
    """Largest distance from the mean position in the settled part [m]."""
    _, z = path.evenly(path.settled_since())
    return float(np.max(np.abs(z - z.mean())))


def figures_of(time: Array, over: Mapping[str, Array], places: tuple[float, ...] = (0.0,)) -> dict[str, float]:
    """Amplitude [m] and dominant frequency over the speed of a motion, from its histories.

    Of two journals, at `places` [m] from the mass centre, those of the one that swings more.
    """
    if len(time) < 2:
        return {"amplitude": 0.0, "dominant_whirl_ratio": math.nan}
    path = max(Path.journals(time, over, places), key=settled_amplitude)
    return {"amplitude": settled_amplitude(path), "dominant_whirl_ratio": dominant_whirl_ratio(path)}


def tilt_figures(time: Array, over: Mapping[str, Array]) -> dict[str, float]:
    """Largest slope of the shaft from its mean in the settled part of a motion [rad], and its dominant whirl ratio."""
    if len(time) < 2:
        return {"tilt_amplitude": 0.0, "tilt_whirl_ratio": math.nan}
    path = Path.of(time, {**over, **{name: over[slope] for name, slope in SLOPES.items()}})
    return {"tilt_amplitude": settled_amplitude(path), "tilt_whirl_ratio": dominant_whirl_ratio(path)}


@dataclass(frozen=True)
class Waterfall:
    """Spectra of short pieces of a motion.

    Attributes
    ----------
    time : (m,) array
        Middle of each piece [s].
    speed : (m,) array
        Speed of the shaft there [rad/s].
    frequency : (n,) array
        Angular frequency, negative for backward whirl [rad/s].
    amplitude : (m, n) array
        Radius of the circle of each frequency [m].
    resolution : float
        Distance of two frequencies that a piece tells apart [rad/s].
    """

    time: Array
    speed: Array
    frequency: Array
    amplitude: Array
    resolution: float


PIECES = 160
"""Spectra of a waterfall."""


def waterfall(path: Path) -> Waterfall:
    """Spectra of overlapping pieces of the whole motion.

    The pieces are so long that the speed changes over one of them by about the width of its lines: longer ones would
    smear a frequency that follows the speed, shorter ones could not tell it from its neighbours.
    """
    start, lasts = float(path.time[0]), float(path.time[-1] - path.time[0])
    step, z = path.evenly(start)
    sweep = float(np.max(np.abs(np.diff(path.speed) / np.diff(path.time)))) if len(path.time) > 1 else 0.0
    long = min(math.sqrt(2.0 * TURN / sweep), 0.25 * lasts) if sweep > 0.0 else 0.25 * lasts
    count = max(min(round(long / step), len(z)), 16)
    begins = np.unique(np.linspace(0, len(z) - count, min(PIECES, len(z) - count + 1)).astype(int))
    pieces = [lines_of(step, z[begin : begin + count]) for begin in begins]
    middle = start + (begins + 0.5 * (count - 1)) * step
    speed = np.interp(middle, path.time, path.speed)
    amplitude = np.array([piece.amplitude for piece in pieces])
    return Waterfall(middle, speed, pieces[0].frequency, amplitude, pieces[0].resolution)
