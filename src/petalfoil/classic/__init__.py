"""The method of the paper on the same grid and equations. The benchmarks compare against it.

=====================  ================================================================================
`relaxation.py`        the algorithm of Figure 5: film and pack in turn, with under-relaxation (60), (61)
`film_march.py`        explicit time steps of the film to its steady state (51)-(59)
`film_cells.py`        the coefficients of the film's cells at given deflections
`descent.py`           projected gradient descent of the pack (45)-(50)
`columns.py`           the constraints (18)-(22): the petals in order between journal and bushing
`kernels.py`           choice of the inner loops: numba where it is installed, otherwise NumPy
`numpy_kernels.py`     the inner loops in NumPy, to be read
`compiled_kernels.py`  the same loops for numba; a test compares both
`method_options.py`    all parameters of the method
=====================  ================================================================================

The code follows the paper and shares no solver with the rest of the package. The film equations are (51)-(59) with the
face flux (F2), so that both methods have the same solution. A run that reaches a limit of steps raises an error with
its history.
"""

from petalfoil.classic.method_options import ClassicOptions
from petalfoil.classic.relaxation import ClassicRun, ClassicState, assembled, relax

__all__ = ["ClassicOptions", "ClassicRun", "ClassicState", "assembled", "relax"]
