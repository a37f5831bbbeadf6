"""THE PAPER'S OWN METHOD on the same mesh and physics: the baseline that everything is measured against.

===================  =========================================================================
`relaxation.py`      the algorithm of its Figure 5: film and package in turn, relaxed (60), (61)
`film_march.py`      the film marched explicitly in time to steadiness (51)-(59)
`film_cells.py`      what a march needs to know of the film's cells, deflections frozen
`descent.py`         the package by gradient descent, projected onto its restrictions (45)-(50)
`columns.py`         the restrictions (18)-(22), layer upon layer at each angle
`kernels.py`         the inner loops: compiled where numba is installed, else in NumPy
`numpy_kernels.py`   their readable form
`numba_kernels.py`   their fast form, tested equal
`options.py`         every number of the method
===================  =========================================================================

It reads as the paper does and shares no solver with the rest. Equations of the film are its (51)-(59) with the face
flow (F2), so that both methods answer alike; steps are counted, and running out of them is an error with a history.
"""

from petalfoil.classic.options import ClassicOptions
from petalfoil.classic.relaxation import ClassicState, Run, assembled, relax

__all__ = ["ClassicOptions", "ClassicState", "Run", "assembled", "relax"]
