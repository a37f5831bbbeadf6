"""Results to figures: free functions of a dataset, no solver behind them.

In the order data flows:

- ``views``        what figures take from a dataset: one converged point, strips of the film, contacts
- ``orbit_views``  what figures take from a motion: path, clearance circle
- ``labels``       quantities with their units, facts of a title, text made safe
- ``canvas``       the figure as a notebook shows it; figures to files (`save`)
- ``style``        colours, sizes, axes and titles of figures
- ``film_fields``  pressure and film: around (`pressure_and_film`), of one petal (`petal_profiles`), as `maps`
- ``stretch``      the radial map of a section
- ``section_walls`` petals, bumps and bushing in a section
- ``section``      the section of the loaded bearing (`cross_section`), with its film (`operating_point`)
- ``assembly``     the foil pack as it is assembled (`pack`)
- ``characteristics`` against displacement: `curve`, `load_characteristic`, `static`, `hysteresis`
- ``speed_sweeps`` over the speed under a load (`runup`), lift-off over the load (`liftoff`)
- ``load_capacity`` load capacity over speed and direction (`capacity`)
- ``dynamic_coefficients`` stiffness and damping over whirl frequency (`coefficients`)
- ``stability_maps`` stability of a rigid rotor (`stability`)
- ``campbell_diagram`` its natural modes over speed (`campbell`)
- ``parameter_effects`` how far a small change of each parameter moves a result (`tornado`)
- ``histories``    a motion over time (`orbit_histories`), its energy balance (`orbit_energy`)
- ``spectra``      spectrum of the whirl (`orbit_spectrum`), over speed or time (`orbit_waterfall`)
- ``journal_orbit`` path of the journal's centre (`orbit_path`), a motion in one figure (`orbit`)
- ``animation``    the section in motion, as a page or a GIF (`animate`)
- ``grid_convergence`` quantities against the grid (`convergence`)
- ``study_views``  what figures take from a study
- ``study_sweeps`` a study over its parameters (`sweep`, `parallel_coordinates`, `scatter_matrix`)
- ``study_tolerance`` scatter of results with limits (`tolerance`)
- ``study_optimum`` an optimisation and its front (`optimum`)
- ``study_sobol``  Sobol' indices (`sobol`)
- ``figures_of_study`` the figures of a study by name (`study`, `study_figures`)
- ``generic``      any other result (`quantities`)
- ``figure_registry`` the figure of each analysis (`summary`), and new ones (`register`)

Conventions: a function takes a dataset and returns a ``matplotlib`` figure with its own canvas (no pyplot, no global
state), which a notebook shows by itself; a state that did not converge is never drawn. matplotlib is loaded when a
figure is drawn.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from petalfoil.plot.animation import animate
    from petalfoil.plot.assembly import pack
    from petalfoil.plot.campbell_diagram import campbell
    from petalfoil.plot.canvas import save
    from petalfoil.plot.characteristics import curve, hysteresis, load_characteristic, static
    from petalfoil.plot.dynamic_coefficients import coefficients
    from petalfoil.plot.figure_registry import register, summary
    from petalfoil.plot.figures_of_study import study, study_figures
    from petalfoil.plot.film_fields import maps, petal_profiles, pressure_and_film
    from petalfoil.plot.generic import quantities
    from petalfoil.plot.grid_convergence import convergence
    from petalfoil.plot.histories import orbit_energy, orbit_histories
    from petalfoil.plot.journal_orbit import orbit, orbit_path
    from petalfoil.plot.load_capacity import capacity
    from petalfoil.plot.parameter_effects import tornado
    from petalfoil.plot.section import cross_section, operating_point
    from petalfoil.plot.spectra import orbit_spectrum, orbit_waterfall
    from petalfoil.plot.speed_sweeps import liftoff, runup
    from petalfoil.plot.stability_maps import stability
    from petalfoil.plot.study_optimum import optimum
    from petalfoil.plot.study_sobol import sobol
    from petalfoil.plot.study_sweeps import parallel_coordinates, scatter_matrix, sweep
    from petalfoil.plot.study_tolerance import tolerance

_MODULES = {
    "animation": ("animate",),
    "assembly": ("pack",),
    "campbell_diagram": ("campbell",),
    "canvas": ("save",),
    "characteristics": ("curve", "hysteresis", "load_characteristic", "static"),
    "dynamic_coefficients": ("coefficients",),
    "film_fields": ("maps", "petal_profiles", "pressure_and_film"),
    "generic": ("quantities",),
    "grid_convergence": ("convergence",),
    "histories": ("orbit_energy", "orbit_histories"),
    "load_capacity": ("capacity",),
    "journal_orbit": ("orbit", "orbit_path"),
    "figure_registry": ("register", "summary"),
    "section": ("cross_section", "operating_point"),
    "spectra": ("orbit_spectrum", "orbit_waterfall"),
    "speed_sweeps": ("liftoff", "runup"),
    "stability_maps": ("stability",),
    "figures_of_study": ("study", "study_figures"),
    "study_tolerance": ("tolerance",),
    "study_optimum": ("optimum",),
    "study_sobol": ("sobol",),
    "study_sweeps": ("parallel_coordinates", "scatter_matrix", "sweep"),
    "parameter_effects": ("tornado",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "animate",
    "campbell",
    "capacity",
    "coefficients",
    "convergence",
    "cross_section",
    "curve",
    "hysteresis",
    "liftoff",
    "load_characteristic",
    "maps",
    "operating_point",
    "optimum",
    "orbit",
    "orbit_energy",
    "orbit_histories",
    "orbit_path",
    "orbit_spectrum",
    "orbit_waterfall",
    "pack",
    "parallel_coordinates",
    "petal_profiles",
    "pressure_and_film",
    "quantities",
    "register",
    "runup",
    "save",
    "scatter_matrix",
    "sobol",
    "stability",
    "static",
    "study",
    "study_figures",
    "summary",
    "sweep",
    "tolerance",
    "tornado",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
