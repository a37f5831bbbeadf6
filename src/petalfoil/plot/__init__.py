"""Results to figures: free functions of a dataset, no solver behind them.

In the order data flows:

- ``reading``   what figures take from a dataset: one converged point, strips of the film, contacts
- ``style``     colours, sizes, axes and titles all figures share
- ``around``    pressure and film against the bushing angle (`pressure_and_film`)
- ``profiles``  pressure and film over one petal, for a family (`petal_profiles`)
- ``unrolled``  pressure and film over angle and length (`maps`)
- ``curves``    characteristics against displacement (`load_characteristic`, `static`)
- ``loops``     hysteresis of a package with friction (`hysteresis`)
- ``speeds``    over the speed under a load (`runup`), lift-off over the load (`liftoff`)
- ``impedance`` stiffness and damping over whirl frequency (`coefficients`)
- ``whirl``     stability of a rigid rotor over speed and load (`stability`)
- ``motion``    what figures take from a motion: path, axis, circle of contact
- ``paths``     path of the journal's centre (`orbit_path`)
- ``histories`` a motion over time (`orbit_histories`), audit of its energy (`orbit_energy`)
- ``spectra``   spectrum of the whirl (`orbit_spectrum`), over speed or time (`orbit_waterfall`)
- ``orbits``    a motion in one figure (`orbit`)
- ``section``   the loaded bearing, cut across (`cross_section`)
- ``animation`` the section in motion, as a page or a GIF (`animate`)
- ``assembly``  the package as it is put together (`package`)
- ``refinement`` figures against the grid (`convergence`)
- ``overview``  the figure that suits a result (`summary`)
- ``files``     figures to files (`save`)

Conventions: a function takes a dataset and returns a ``matplotlib`` figure with its own canvas (no pyplot, no global
state); a state that did not converge is never drawn. matplotlib is loaded when the first of these names is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from petalfoil.plot.animation import animate
    from petalfoil.plot.around import pressure_and_film
    from petalfoil.plot.assembly import package
    from petalfoil.plot.curves import load_characteristic, static
    from petalfoil.plot.files import save
    from petalfoil.plot.histories import orbit_energy, orbit_histories
    from petalfoil.plot.impedance import coefficients
    from petalfoil.plot.loops import hysteresis
    from petalfoil.plot.orbits import orbit
    from petalfoil.plot.overview import summary
    from petalfoil.plot.paths import orbit_path
    from petalfoil.plot.profiles import petal_profiles
    from petalfoil.plot.refinement import convergence
    from petalfoil.plot.section import cross_section
    from petalfoil.plot.spectra import orbit_spectrum, orbit_waterfall
    from petalfoil.plot.speeds import liftoff, runup
    from petalfoil.plot.unrolled import maps
    from petalfoil.plot.whirl import stability

__all__ = [
    "animate",
    "coefficients",
    "convergence",
    "cross_section",
    "hysteresis",
    "liftoff",
    "load_characteristic",
    "maps",
    "orbit",
    "orbit_energy",
    "orbit_histories",
    "orbit_path",
    "orbit_spectrum",
    "orbit_waterfall",
    "package",
    "petal_profiles",
    "pressure_and_film",
    "runup",
    "save",
    "stability",
    "static",
    "summary",
]

_HOME = {
    "animate": "animation",
    "coefficients": "impedance",
    "convergence": "refinement",
    "cross_section": "section",
    "hysteresis": "loops",
    "liftoff": "speeds",
    "load_characteristic": "curves",
    "maps": "unrolled",
    "orbit": "orbits",
    "orbit_energy": "histories",
    "orbit_histories": "histories",
    "orbit_path": "paths",
    "orbit_spectrum": "spectra",
    "orbit_waterfall": "spectra",
    "package": "assembly",
    "petal_profiles": "profiles",
    "pressure_and_film": "around",
    "runup": "speeds",
    "save": "files",
    "stability": "whirl",
    "static": "curves",
    "summary": "overview",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
