"""HOW, in arrays alone: nothing here knows what a bearing is.

====================  =======================================================================
`cone.py`             the protocol of a problem with one-sided gaps, and a point of it
`linear.py`           sparse factorisation: equilibrated, counted, one thread
`interior_point.py`   primal-dual interior point: cold starts, on any grid
`active_set.py`       Newton on a known set of closed gaps: exact zeros, warm starts
`ties.py`             closed gaps as eliminated unknowns
`set_search.py`       the contact set of the linearised equations, found at once
`complementarity.py`  small dense complementarity problems
`eigen.py`            rightmost eigenvalue of a singular pencil: is an equilibrium stable?
====================  =======================================================================
"""
