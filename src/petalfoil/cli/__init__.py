"""The command line: every verb is a page that reads its options, calls one analysis and gives the answer out.

In the order a call runs through them:

- ``app``        the verbs under one name; ``main`` is the entry point
- ``options``    the options the verbs share, declared once
- ``solve`` ``curve`` ``static`` ``balance`` ``liftoff`` ``runup`` ``coefficients`` ``stability`` ``check`` ``converge``
  ``show``       one verb each
- ``reproduce``  the paper's figures and claims: a page and data
- ``parsing``    text of the options to SI numbers
- ``progress``   the bar on standard error
- ``series``     runs through the points of a curve and keeps what is finished
- ``autosave``   rewrites the result file of a curve as its points finish
- ``answer``     what a verb has to give out: one record or the points of a curve; as JSON and as labelled data
- ``kinds``      answers laid out in their own way: over loads, legs, frequencies, load and speed
- ``study``      the grids of `converge` and what they tell, as JSON and as labelled data
- ``stored``     a result read from a file as the answer it was
- ``tables``     an answer as the printed table
- ``outputs``    where an answer goes: checked before the run, written after it
- ``streams``    the two doors to the outside: standard output and standard error
- ``failures``   exit codes and what a user reads when something goes wrong

Conventions: standard output carries the answer and nothing else; all that is said about the run goes to standard
error. Exit codes: 0 done, 1 a fault of petalfoil, 2 bad case or bad usage, 3 no converged answer, 130 interrupted,
141 the reader of the output went away. ``petalfoil --help`` must stay fast: what loads NumPy, xarray, matplotlib or
pint is imported inside the verb that needs it.
"""

from petalfoil.cli.app import main

__all__ = ["main"]
