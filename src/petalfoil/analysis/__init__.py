"""One question a file: a case in, records out.

=================  =======================================================================
`equilibrium.py`   one position of the journal (`solve`)
`load_curve.py`    the load characteristic along a displacement (`curve`)
`static.py`        the package at rest: preload, static characteristic, starting torque
`grid_study.py`    the same answer on finer and finer grids (`converge`, error bars)
`richardson.py`    values on a sequence of grids -> limit, order, error bar
`check.py`         what follows from a case without a run
`figures.py`       an answer -> its figures
`fields.py`        an answer -> its fields on the mesh
`checks.py`        an answer -> its balances
`session.py`       one BLAS thread, progress, wall time
=================  =======================================================================
"""
