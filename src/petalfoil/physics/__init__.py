"""THE LAWS, each residual beside its derivative. Arrays only; nothing here solves.

==============  ===================================================================
`shell.py`      bending energy of a petal (33)-(39): stiffness, curvatures, stress
`film.py`       Reynolds' equation (51)-(57): face fluxes and their derivatives
`balance.py`    the control volumes that add the fluxes up, and their sparse tangent
`contact.py`    one-sided gaps (18)-(22), linear in the deflections
`forces.py`     forces on the journal, friction, leakage (62)-(64)
==============  ===================================================================

Film quantities are dimensionless here: `P = p / p_a`, `H = h / h_ref`, angles, `Z = z / R_j`.
"""
