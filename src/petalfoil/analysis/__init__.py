"""One question a file: a case in, records out.

====================  ====================================================================
`equilibrium.py`      one position of the journal (`solve`)
`load_curve.py`       the load characteristic along a displacement (`curve`)
`static.py`           the package at rest: preload, static characteristic, starting torque
`balance.py`          where the journal sits under a load (`balance`)
`speeds.py`           that balance followed over speed
`liftoff.py`          speeds of lift-off and touch-down (`liftoff`)
`runup.py`            from rest to speed under a load, and back (`runup`)
`coefficients.py`     stiffness and damping over whirl frequency (`coefficients`)
`whirl.py`            the smallest rotor that whirls at an operating point
`stability.py`        that over speed and load, and the threshold speed (`stability`)
`grid_study.py`       the same answer on finer and finer grids (`converge`, error bars)
`richardson.py`       values on a sequence of grids -> limit, order, error bar
`check.py`            what follows from a case without a run
`classic_method.py`   the paper's own method behind `solve`, `curve`, `static`
`figures.py`          an answer -> its figures
`fields.py`           an answer -> its fields on the mesh
`checks.py`           an answer -> its balances
`session.py`          one BLAS thread, progress, wall time
====================  ====================================================================
"""
