"""Equilibria of film, wall and contacts, and small motions about them: the solvers applied to the system.

=========================  =====================================================================================
`run_context.py`           counts, history, clock, progress and solvers of a run
`solution.py`              an equilibrium, its operating state, how it was reached
`pack_at_rest.py`          the foil pack alone, at zero speed
`cold_start.py`            film and pack from nothing, through the interior point and beyond
`continuation.py`          from a known equilibrium to a neighbour; from rest up to speed
`lengthening.py`           a film without ends as the limit of ever longer bearings
`other_grids.py`           the same from its equilibrium on another grid
`branches.py`              whether there is more than one equilibrium at a position
`under_load.py`            the journal's position under a load
`whole_length.py`          a whole length from half of it: an aligned journal mirrored, and then tilted
`heated.py`                the temperatures of a heat network with film, contacts and position
`friction_path.py`         equilibria with friction between petals, one after another
`coulomb_path.py`          the same with petals that slide along themselves
`point_friction_path.py`   film, pack and journal with friction at contact points, a step further along a path
`friction_handover.py`     states of a path handed over from contact points to nodes, and back
`friction_history.py`      the pack assembled and moved so, without film
`sliding_newton.py`        film, pack and journal with such petals in one Newton
`sinking.py`               journal and petals in a medium that holds them back
`friction_under_load.py`   a loaded journal set down on such a pack, and run up
`parameter_response.py`    how an equilibrium follows a parameter of its case
`point_rates.py`           the same with isolated contacts as points between nodes
`small_motion.py`          what is asked of the response to a small motion of the journal
`linear_response.py`       that response, contacts at nodes
`travelling_contacts.py`   contacts of that response that move between nodes
`contact_runs.py`          contact points and stretches from runs of active nodes
`contact_sets.py`          the same corrected by the signs of reactions and gaps
`element_tangent.py`       a step of Newton's method for petals with continuous slopes, under a load or not
`rubbing_tangent.py`       the same with friction at contact points
`amended_factor.py`        one factor of the tangent for states with other contact points
`point_contacts.py`        equilibria with contact points as unknowns
`point_prospects.py`       when a search for these is given up
`followed_points.py`       these followed to a neighbouring position, speed or load
`settled_points.py`        these with the conditions of contact met along whole curves
`led_points.py`            from solution to solution so, contacts at nodes left out
`asperity_contacts.py`     equilibria with contact pressures over low asperities
`asperity_path.py`         these from nothing, along a central path
`at_limit.py`              the load at which a result reaches its limit, followed with these contacts
`largest_load.py`          the largest load of a branch, there or where the branch turns back
`element_contacts.py`      which of the two is near an equilibrium with contacts at nodes
`element_rates.py`         how such an equilibrium follows a parameter of its case
`line_contacts.py`         3-D equilibria whose contact lines cross stations between nodes: equations, Newton's step
`line_tangent.py`          the factorised tangent of these, as it serves later states
`line_exchange.py`         what has changed in their contacts since it was factorised
`line_chords.py`           steps with one factor
`rubbing_lines.py`         a state of a path with friction on such lines, under a film
`pack_on_lines.py`         the same of the pack alone
`sinking_lines.py`         the same in a medium that holds journal and petals back
`rubbing_line_tangent.py`  a step of Newton's method for these
`line_friction_path.py`    petals with friction on them, a step further along a path
`line_dips.py`             where gaps are below zero between nodes
`line_handover.py`         states of a path handed over from nodes to lines, and back
`line_sets.py`             these found from active nodes
`line_signs.py`            which contacts they have: corrected by signs
`line_stretches.py`        stretches of contacts at nodes among them, as they grow and recede in time
`followed_lines.py`        these followed to a neighbouring position, speed or load
`prolonged_lines.py`       these carried over from a coarse grid to a fine one
`coarse_start.py`          an equilibrium on a fine grid from that on a coarse one
`coarse_film.py`           2-D contact points under a fine film from those under a coarse one
`line_rates.py`            how such an equilibrium follows a parameter of its case
`nodal_state.py`           film, deflections and reactions at nodes, wherever contacts are
`element_response.py`      the response about these
=========================  =====================================================================================
"""
