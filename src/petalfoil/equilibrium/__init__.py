"""HOW AN ANSWER IS REACHED: the solvers put to work on the coupled problem. No reports, no files.

================  ===========================================================================
`answer.py`       an equilibrium, how it was reached and at what cost
`work.py`         the solver of a run, its counts, its history, its progress
`package.py`      the package alone, from nothing: shaft at rest
`cold.py`         film and package from nothing, through the interior point
`warm.py`         from a known equilibrium to a neighbour: predictor and contact set
`ascent.py`       the branch from rest up to speed
`stability.py`    does an equilibrium return when it is disturbed?
`response.py`     what a small motion of the journal does to it
`harmonic.py`    the same where petals rub: stuck, or in cycles by harmonic balance
`loaded.py`       an equilibrium under a load, and the force left over
`balancing.py`    the position under a load, from nothing and from a neighbour
`solid.py`        a package that a load has pressed solid
================  ===========================================================================
"""
