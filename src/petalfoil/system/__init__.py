"""Film, wall and contacts as one system: residual, tangent and gaps. Nothing here solves.

========================  ========================================================================
`scales.py`               units of the unknowns: lengths, pressures, nodal forces
`unknowns.py`             named blocks of the unknowns; further fields on the film
`bearing_layout.py`       what stays the same while speed and position change
`film_rows.py`            the film's equations
`coupled.py`              film and wall together, at one speed and journal position
`foil_pack.py`            the wall alone under a given pressure: a convex programme
`point_layout.py`         what stays the same of these: petals of Hermite elements
`point_equations.py`      film and petals with contact points as unknowns
`asperity_equations.py`   film and petals with contact pressures over asperities
`softened_asperities.py`  the same on a central path
`loaded.py`               the journal's position unknown, a load given
`friction.py`             residual of the friction forces between petals, and a problem with it
`time_step.py`            an implicit step in time: the film stores gas
`point_step.py`           the same with contact points; the journal has mass
`compiled_step.py`        the same in compiled loops: the class that serves in its place
`compiled_points.py`      these loops
`point_tables.py`         what they read and return, as plain arrays
`point_friction.py`       friction between petals at contact points that travel (M13)
`pack_at_points.py`       the pack without film with it, round a journal of its size or thinner
`sinking_points.py`       film, pack and journal with it in a medium that holds them back
`shaft_layout.py`         what stays the same of two bearings on one shaft
`on_shaft.py`             both side by side in a step in time
`temperatures.py`         temperatures of film, shaft, pack and bushing
`heat_network.py`         their heat balances (H3)
`heat_rows.py`            what film and contacts do to them, and its derivatives
`damped.py`               a march to rest: the wall resists motion, the film is steady
`leaking_film.py`         a film without ends that leaks through those of a bearing of finite length
`build.py`                from a case to its problem
========================  ========================================================================

Unknowns are dimensionless: deflections `w = W / h_ref`, pressures `P = p / p_a`, reactions over `p_a` times a
typical node's area. The vector is `x = [w, P]`; contacts enter as `G^T lam`.
"""
