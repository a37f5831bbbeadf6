"""Numerical methods, in arrays alone: nothing here knows what a bearing is.

========================  ===================================================================
`problem.py`              what the solvers ask of a problem with one-sided gaps; its tolerance
`sparse_lu.py`            sparse factorisation: equilibrated, counted, one thread
`near_factor.py`          solution with a matrix near a factorised one
`secants.py`              steps with the factor of another state, bettered by those before
`constraints.py`          active contacts as constraints that eliminate unknowns
`point_constraints.py`    the same for contact points between nodes
`tangent.py`              the factorised tangent, with a few bordered unknowns
`interior_point.py`       primal-dual interior point: cold starts, on any grid
`central_path.py`         its central path, followed through folds by arc length
`contact_equations.py`    what Newton's method on active contacts solves; when a contact closes or is released
`contact_newton.py`       Newton's method on active contacts: its loop
`contact_search.py`       the active contacts of the linearised equations, found at once
`lcp.py`                  small dense complementarity problems
`coulomb.py`              contact with Coulomb friction as a small dense problem
`coulomb_disk.py`         the same where contacts slip in a plane
`contact_space.py`        linearised equations as seen by the contacts of that
`eigenvalues.py`          rightmost eigenvalue of a singular pencil
`reduced_model.py`        a large linear system with few inputs as a small one
========================  ===================================================================
"""
