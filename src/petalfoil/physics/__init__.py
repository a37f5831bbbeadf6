"""The equations. Each residual stands next to its derivative; nothing here solves.

=====================  ========================================================================================
`reynolds.py`          Reynolds' equation (F1)-(F3), the paper's (51)-(57): fluxes through faces of control volumes
`mass_balance.py`      mass balance of the control volumes of the film, and its sparse derivative
`gas_inventory.py`     the gas inventory of a 2-D film without ambient boundary (F6)
`shell.py`             bending of a petal (33)-(39): stiffness matrix, curvatures, stress
`petal_elements.py`    bending of a petal by cubic elements, 2-D
`contact.py`           gaps of the solid contacts (18)-(22), linear in the deflections
`contact_points.py`    contact at isolated points between nodes (K5)-(K9)
`line_points.py`       contact points of 3-D contact lines, between nodes (K15)-(K17)
`gap_curves.py`        gaps between petals with continuous slopes, and contact points anywhere on them
`asperity_contact.py`  contact pressures that decay with the gap
`lumped_pressure.py`   points at which friction acts in their place (K18)
`sprung_beam.py`       loads of a clamped beam on springs, in a step for each
`dry_friction.py`      Coulomb friction between petals and on the bushing (D1)-(D3)
`sampled_friction.py`  friction forces of slips to and fro, harmonic by harmonic (E20), (E21)
`sampled_disk.py`      the same of contacts that slip in a plane
`petal_membrane.py`    bending and stretching of a petal in 3-D (M8)-(M10)
`petal_sliding.py`     petals that slide along themselves and stretch, 2-D (M1)-(M4)
`bump_strip.py`        stiffness of one bump of a bump foil (B1)-(B3)
`heat.py`              friction power and conduction of the film (H2)
`forces.py`            force and friction torque on the journal (62)-(64)
=====================  ========================================================================================

Film quantities are dimensionless: `P = p / p_a`, `H = h / h_ref`, angles in radians, `Z = z / R_j`.
"""
