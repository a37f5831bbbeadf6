"""ONE SYSTEM: film, wall and contacts as a residual, its tangent and its gaps. It does not solve.

===============  ====================================================================
`scales.py`      units of the unknowns: lengths, pressures, nodal forces
`coupled.py`     film and wall together, at one speed and journal position
`package.py`     the wall alone under a given pressure: a convex quadratic programme
===============  ====================================================================

Unknowns are dimensionless: deflections `w = W / h_ref`, pressures `P = p / p_a`, reactions over `p_a` times a
typical node's area. The vector is `x = [w, P]`; contacts enter as `G^T lam`.
"""
