"""Results to figures: free functions of a dataset, no solver behind them.

In the order data flows:

- ``reading``   what figures take from a dataset: one converged point, strips of the film, contacts
- ``style``     colours, sizes, axes and titles all figures share
- ``around``    pressure and film against the bushing angle (`pressure_and_film`)
- ``profiles``  pressure and film over one petal, for a family (`petal_profiles`)
- ``unrolled``  pressure and film over angle and length (`maps`)
- ``curves``    characteristics against displacement (`load_characteristic`, `static`)
- ``speeds``    over the speed under a load (`runup`), lift-off over the load (`liftoff`)
- ``impedance`` stiffness and damping over whirl frequency (`coefficients`)
- ``whirl``     stability of a rigid rotor over speed and load (`stability`)
- ``section``   the loaded bearing, cut across (`cross_section`)
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
    from petalfoil.plot.around import pressure_and_film
    from petalfoil.plot.assembly import package
    from petalfoil.plot.curves import load_characteristic, static
    from petalfoil.plot.files import save
    from petalfoil.plot.impedance import coefficients
    from petalfoil.plot.overview import summary
    from petalfoil.plot.profiles import petal_profiles
    from petalfoil.plot.refinement import convergence
    from petalfoil.plot.section import cross_section
    from petalfoil.plot.speeds import liftoff, runup
    from petalfoil.plot.unrolled import maps
    from petalfoil.plot.whirl import stability

__all__ = [
    "coefficients",
    "convergence",
    "cross_section",
    "liftoff",
    "load_characteristic",
    "maps",
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
    "coefficients": "impedance",
    "convergence": "refinement",
    "cross_section": "section",
    "liftoff": "speeds",
    "load_characteristic": "curves",
    "maps": "unrolled",
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
