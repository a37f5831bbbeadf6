"""Film, petals, contacts and rotor in motion.

=========================  ====================================================================
`film_stability.py`        whether an equilibrium is stable at a fixed journal position
`leading_mode.py`          how the eigenvalue of that follows a changed equilibrium
`reduced_impedance.py`     impedance over frequency, from a reduced model
`joint_motion.py`          small motions of a shaft in two bearings that differ
`critical_mass.py`         smallest unstable mass of a rigid rotor
`natural_modes.py`         damped natural motions of a rigid rotor
`harmonic_balance.py`      friction between petals in a whirl of given amplitude, one harmonic of the slips
`friction_harmonics.py`    the same with several harmonics
`harmonic_tangent.py`      their steps of Newton
`rubbing_cycle.py`         force of either on the journal, with as many harmonics as it needs
`rubbing_whirl.py`         the bearing in such a whirl, on an ellipse of any shape
`eigenpairs.py`            a number and a shape that solve equations
`rubbing_modes.py`         natural modes and neutral whirls at that amplitude
`more_harmonics.py`        those with as many harmonics of the slips as they need
`speed_schedule.py`        speed and angle of the shaft over time
`rotor_motion.py`          mass, loads and unbalance in the units of the problem
`time_state.py`            state at an instant
`stage.py`                 one implicit stage: film, wall, contacts and rotor in one Newton
`travelling_stage.py`      the same with contacts between nodes: corrections, tangents, sets of contacts
`point_stage.py`           contact points that travel, in 2-D
`line_stage.py`            contact lines that travel, in 3-D
`compiled_stages.py`       which motions evaluate it in compiled loops
`point_path.py`            instants with contact points, at the nodes and extrapolated
`line_path.py`             instants with contact lines, placed from nodes and extrapolated
`tr_bdf2.py`               a step of second order from two stages, with an error estimate
`adaptive_steps.py`        steps that adapt to a tolerance, from start to end
=========================  ====================================================================
"""
