"""Questions about a case. An analysis stands in the file of its name, which declares arguments, results and layout.

=====================  ===================================================================
`solve.py`             one position of the journal
`curve.py`             the load characteristic along a displacement
`static.py`            the foil pack at zero speed: preload, static characteristic, starting torque
`balance.py`           the position of the journal under a load
`capacity.py`          the largest load within limits of film, contact or stress
`liftoff.py`           speeds of lift-off and touchdown
`runup.py`             from rest to speed under a load, and back
`coefficient_tables.py` tables of stiffness and damping, of a journal that tilts too
`coefficients.py`      stiffness and damping over whirl frequency
`stability.py`         critical mass, threshold speed, damped natural frequencies
`orbit.py`             a rigid rotor through time
`sensitivity.py`       how far a small change of each parameter moves a result
`converge.py`          one position on finer and finer grids
`check.py`             what follows from a case without a run
=====================  ===================================================================

How they are declared:

=====================  ===================================================================
`declaration.py`       the decorator, and what follows from a declaration
`file_exports.py`      files for other programs that an analysis can write
`rotor_files.py`       those of `coefficients`: tables, XLTRC2, ROSS
`arguments.py`         kinds of arguments with unit, range and help; those that are shared
`words.py`             arguments that are words: one of several, lists of names
`known_verbs.py`       the analyses by name
`runs.py`              an analysis under way
`resume.py`            a series that goes on from the points that it wrote
`session.py`           one BLAS thread, clock, progress
`progress_bar.py`      the bar at a terminal or in a notebook
=====================  ===================================================================

What they share:

=====================  ===================================================================
`operating_point.py`   the equilibrium that an analysis is about
`branch_choice.py`     which of several equilibria that is
`by_coarse_film.py`    a 2-D equilibrium by way of a coarse film
`neighbours.py`        equilibria that begin at the solution of a similar case of a study
`displacements.py`     the journal displaced point by point
`hysteresis.py`        the same at rest, with friction between petals
`speeds.py`            a load followed over speed
`capacity_search.py`   the largest loads over direction and speed
`load_limit.py`        the largest load in one direction that keeps to limits
`load_ray.py`          balances of loads of one direction, and how far they are from limits
`foretold_balance.py`  balances a little farther, by a tangent alone
`crossings.py`         speeds at which the contact fraction crosses a limit
`varied_case.py`         a case at values of one of its parameters
`derivatives.py`       exact derivatives of the results of an equilibrium
`smooth_equilibrium.py` how an equilibrium with contacts between nodes follows such values
`heated_derivatives.py` the same where temperatures follow
`crossing_derivatives.py`  the same of a quantity that keeps a result at its limit
`liftoff_derivatives.py`  lift-off and touchdown speed as such quantities
`capacity_derivatives.py`  the load capacity as one
`adjoint.py`           the same from one solve for each result
`result_gradients.py`  derivatives of results by the state
`response_derivatives.py` stiffness, damping, critical mass, threshold speed
`mode_derivatives.py`     frequency, growth rate and damping of natural modes
`differentiable.py`       questions that have derivatives, and what they need
`derivatives_in_series.py` those at each point of a load characteristic or a run-up
`derivative_sources.py` where the results of each question have them
`sensitivity_table.py` the rows of `sensitivity`
`impedance.py`         small motions of the journal
`rotor_balance.py`     a rotor in two bearings that do not share its load evenly
`support.py`           one of these bearings, where the shaft moves its journal
`other_bearing.py`     what results tell of the second of them
`rotor_on_bearings.py` a rigid rotor on its bearing, or in two of them
`tilt_coefficients.py` stiffness and damping of a journal that tilts
`tilted_journal.py`   one equilibrium, its journal free to tilt or held
`campbell.py`          branches of natural modes over speed
`threshold.py`         the speed at which a rotor becomes unstable
`rotor_verdict.py`     whether a rotor is stable, in words
`past_jump.py`         equilibria beside a branch that a jump of a curve has led to
`parameter_change.py`  changes of parameters whose effects are told
`film_force.py`        film and petals for another program's integrator
`release.py`           where a large motion begins
`release_at_nodes.py`  an instant with contacts at nodes
`release_at_points.py`   the same with contact points
`release_on_lines.py`  the same with contact lines
`film_figures.py`      film, contacts and friction of one bearing in it
`orbit_motion.py`      a large motion, step by step
`restart.py`           a motion that goes on from a result
`restart_on_lines.py`  its contact lines as numbers
`trace.py`             what a motion leaves behind
`steps_ahead.py`       what a motion costs, told before it begins
`grid_study.py`        nested grids; error bars of arrays such as stiffness
`error_bars.py`        the error bars of any answer, from nested grids
`harmonics_bars.py`    the part of them that comes from harmonics of slips
`accuracy.py`          whether they are below an accuracy, and the next finer grid or more harmonics
`richardson.py`        values on a sequence of grids: limit, order, error bar
`classic_method.py`    the paper's own method
`friction_told.py`     which friction forces between petals an equilibrium has
`contact_model.py`     where contacts are, and the equilibrium that results are taken from
`evaluation.py`        results of a solution, such as `min_film_thickness`, as typed parts
`closest_gap.py`       where petals with continuous slopes are closest to the journal
`extremes.py`          extremes between nodes
`extremes_of_many.py`  the same of many fields at once
`heat_results.py`      temperatures and where the heat goes
`thermal_limit.py`     the speed above which no temperature is steady
`adapted_stations.py`  stations along the shaft where a coarse solution bends most
`side_stations.py`     stations along the shaft at the sides of petals that stretch
`balances.py`          balances of a solution
`fields.py`            its fields on the mesh
`records.py`           typed parts to a record
=====================  ===================================================================
"""
