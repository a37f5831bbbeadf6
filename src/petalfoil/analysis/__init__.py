"""Questions about a case. An analysis stands in the file of its name, which declares arguments, results and layout.

====================  ====================================================================
`solve.py`            one position of the journal
`curve.py`            the load characteristic along a displacement
`static.py`           the package at rest: preload, static characteristic, starting torque
`balance.py`          the position of the journal under a load
`liftoff.py`          speeds of lift-off and touchdown
`runup.py`            from rest to speed under a load, and back
`coefficients.py`     stiffness and damping over whirl frequency
`stability.py`        critical mass, threshold speed, damped natural frequencies
`orbit.py`            a rigid rotor through time
`converge.py`         one position on finer and finer grids
`check.py`            what follows from a case without a run
====================  ====================================================================

How they are declared: `declaration.py`, `arguments.py`, `registry.py`, `runs.py`. What they share: `operating_point.py`
(the equilibrium they are about), `speeds.py` and `crossings.py` (a load followed over speed), `impedance.py` and
`threshold.py` (small motions), `motion.py` with `release.py`, `restart.py`, `trace.py` (large ones), `grid_study.py`
with `richardson.py`, `displacements.py` and `hysteresis.py` (the journal displaced), `classic_method.py` (the paper's
method). From a solution to a record: `evaluation.py`, `balances.py`, `extremes.py`, `fields.py`, `records.py`;
`session.py`: threads, clock, progress.
"""
