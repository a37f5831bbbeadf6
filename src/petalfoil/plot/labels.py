"""What figures say: quantities with symbol and unit, and the facts of a title."""

from __future__ import annotations

import math
from dataclasses import dataclass

import xarray as xr

from petalfoil.plot.views import displacement, is_3d, mid_plane, number
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import shown_as
from petalfoil.text import for_figure

RPM = 30.0 / math.pi
HERTZ = 0.5 / math.pi
MICRO = 1e6


@dataclass(frozen=True)
class PlottedQuantity:
    """A quantity as figures show it.

    Parameters
    ----------
    name : str
        Name in words.
    unit : str
        Unit of the figure; empty for a pure number.
    factor : float
        From SI to that unit.
    symbol : str
        Symbol, in matplotlib's mathtext; empty where the name says enough.
    """

    name: str
    unit: str = ""
    factor: float = 1.0
    symbol: str = ""

    @property
    def axis(self) -> str:
        """Label of an axis: name, symbol and unit."""
        return self.name + (f"  {self.symbol}" if self.symbol else "") + (f" [{self.unit}]" if self.unit else "")


QUANTITIES = {
    "bearing_force": PlottedQuantity("bearing force", "N", 1.0, "|F|"),
    "min_film_thickness": PlottedQuantity("minimum film thickness", "µm", MICRO, "h$_{min}$"),
    "peak_pressure": PlottedQuantity("peak pressure", "kPa", 1e-3, "p$_{max}$"),
    "friction_torque": PlottedQuantity("friction torque", "mN·m", 1e3, "M"),
    "starting_torque": PlottedQuantity("starting torque", "mN·m", 1e3, "M$_0$"),
    "contact_fraction": PlottedQuantity("contact fraction", "%", 100.0),
    "contact_normal_force": PlottedQuantity("contact normal force", "N"),
    "max_bending_stress": PlottedQuantity("maximum bending stress", "MPa", 1e-6, "σ$_{max}$"),
    "power_loss": PlottedQuantity("power loss", "W"),
    "side_leakage": PlottedQuantity("side leakage", "mg/s", 1e6),
    "attitude_angle": PlottedQuantity("attitude angle", "deg", 180.0 / math.pi),
    "eccentricity": PlottedQuantity("eccentricity", "µm", MICRO, "e"),
    "eccentricity_x": PlottedQuantity("displacement along x", "µm", MICRO, "e$_x$"),
    "eccentricity_y": PlottedQuantity("displacement along y", "µm", MICRO, "e$_y$"),
    "shaft_temperature": PlottedQuantity("shaft temperature", "K", 1.0),
    "pack_temperature": PlottedQuantity("pack temperature", "K", 1.0),
    "speed": PlottedQuantity("speed", "rpm", RPM),
    "load": PlottedQuantity("load", "N"),
    "liftoff_speed": PlottedQuantity("lift-off speed", "rpm", RPM),
    "touchdown_speed": PlottedQuantity("touchdown speed", "rpm", RPM),
    "threshold_speed": PlottedQuantity("threshold speed", "rpm", RPM),
    "critical_mass": PlottedQuantity("critical rotor mass", "kg", 1.0, "m$_c$"),
    "rotor_mass": PlottedQuantity("rotor mass", "kg", 1.0, "m"),
    "whirl_ratio": PlottedQuantity("whirl ratio", "", 1.0, "Ω/ω"),
    "growth_rate": PlottedQuantity("growth rate", "1/s"),
    "growth_frequency": PlottedQuantity("growth frequency", "Hz", HERTZ),
    "whirl_frequency": PlottedQuantity("whirl frequency", "Hz", HERTZ, "Ω"),
}
_UNITS = {"1": ("", 1.0), "rad s-1": ("Hz", HERTZ), "rad": ("deg", 180.0 / math.pi)}
"""Units of the schema that figures show as others."""


def quantity(ds: xr.Dataset, name: str) -> PlottedQuantity:
    """How a variable of a dataset is shown: as the table says, else by its long name in the unit of printed tables."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    attributes = ds[name].attrs
    declared = for_figure(str(attributes.get("units", "")))
    unit, factor = ("rpm", RPM) if declared == "rad s-1" and "speed" in name else _UNITS.get(declared, (declared, 1.0))
    if name in SCALARS and (shown := shown_as(name)).factor != 1.0:
        unit, factor = shown.unit, shown.factor
    return PlottedQuantity(for_figure(str(attributes.get("long_name", name.replace("_", " ")))), unit, factor)


# ------------------------------------------------------------------------------------------ facts of a title


def state_facts(ds: xr.Dataset) -> tuple[str, ...]:
    """Speed, displacement and grid of one state, as a title tells them."""
    return speed_fact(number(ds, "speed")), displacement_fact(ds), grid_fact(ds)


def speed_fact(speed: float) -> str:
    """Speed in revolutions per minute."""
    if math.isnan(speed):
        return ""
    return "zero speed" if speed == 0.0 else f"{grouped(speed * RPM)} rpm"


def load_fact(ds: xr.Dataset) -> str:
    """Magnitude of the load on the journal; empty where there is none."""
    load = math.hypot(number(ds, "load_x"), number(ds, "load_y"))
    return "" if math.isnan(load) else f"load {load:.4g} N"


def displacement_fact(ds: xr.Dataset) -> str:
    """Displacement of the journal: its size and direction."""
    e_x, e_y = displacement(ds)
    if math.isnan(e_x + e_y):
        return ""
    size = math.hypot(e_x, e_y)
    if size == 0.0:
        return "centred journal"
    return f"e = {size * MICRO:.4g} µm at {signed(math.degrees(math.atan2(e_y, e_x)))}°"


def grid_fact(ds: xr.Dataset) -> str:
    """Size of the film's grid, in cells per pitch where there are petals."""
    if "phi_exposed" not in ds.sizes:
        return ""
    cells = f"{ds.sizes['phi_exposed'] - 1}" + (f" × {ds.sizes['z'] - 1}" if is_3d(ds) else "")
    return f"grid {cells} cells" + ("" if ds.sizes["petal"] == 1 else " per pitch")


def plane_fact(ds: xr.Dataset) -> str:
    """Which section a title should name."""
    return f"mid-plane, z = {float(mid_plane(ds)['z']) * 1e3:.4g} mm" if is_3d(ds) else ""


def grouped(value: float) -> str:
    """A whole number with thin spaces between its thousands."""
    return f"{value:,.0f}".replace(",", "\u2009")


def signed(value: float) -> str:
    """A whole number with a true minus sign."""
    return f"{round(value) + 0:d}".replace("-", "−")


def plain(value: float) -> str:
    """A number of four digits for a label, without a power of ten up to a million."""
    return grouped(value) if 1e4 <= abs(value) < 1e6 else f"{value:.4g}".replace("-", "−")
