"""The command line: reads the declarations of `petalfoil.analysis` and gives answers out.

In the order a call runs through them:

- ``app``        the verbs under one name; ``main`` is the entry point
- ``commands``   the declaration of an analysis as a command with its options, and the run of one
- ``keeping``    follows a run, rewrites its result file as it grows, keeps what is finished when it is stopped
- ``printed_tables``     an answer as printed tables
- ``outputs``    where an answer goes: checked before the run, written after it
- ``signals``    interrupts by the terminal or the system, all alike
- ``streams``    standard output and standard error
- ``failures``   exit codes and what a user reads when something goes wrong
- ``exports``    options of files for other programs
- ``show``       a stored result once more
- ``study_commands``    the commands of studies, with the options of the analysis that they ask
- ``study_outputs`` a study on standard output
- ``study_folder`` ``petalfoil study``: a stored study shown, gone on with, exported
- ``new``        a case to begin with
- ``report``     what a design review asks about a bearing, on one page
- ``reproduce``  the paper's figures and claims: a page and data
- ``studio``     the page on which a bearing is changed and answers
- ``docs``       the documentation in a browser

Conventions: standard output carries the answer and nothing else; all that is said about the run goes to standard
error. Exit codes: 0 done, 1 a fault of petalfoil, 2 bad case or bad usage, 3 no converged answer, 130 interrupted,
141 the reader of the output went away. ``petalfoil --help`` must stay fast: what loads NumPy, xarray, matplotlib or
pint is imported when a verb runs.
"""

from petalfoil.cli.app import main

__all__ = ["main"]
