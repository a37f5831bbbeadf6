"""What a run leaves behind: labelled data that explains itself.

In the order data flows:

- ``schema``   every variable a result may hold: dimensions, SI unit, long name, symbol
- ``record``   one answer as plain arrays (no xarray), checked against the schema
- ``estimate`` what a sequence of grids tells about a figure: limit, order, error bar
- ``summary``  a record as the object of ``--json`` and as the rows of the printed table
- ``dataset``  records to ``xarray.Dataset``: one point, or a curve of points
- ``chart``    records over load and speed to ``xarray.Dataset``
- ``motion``   what the histories of a motion tell: places once a turn, spectra of the whirl
- ``export``   coefficients for other programs: CSV, ROSS
- ``study``    the records of a grid study and its estimates to ``xarray.Dataset``, and back
- ``atomic``   a file is replaced whole or left alone
- ``seal``     proof that a file is what was written
- ``store``    datasets to NetCDF and back

Conventions: SI units inside; a figure of a state that did not converge is NaN; ``dataset``, ``chart``, ``study`` and
``store`` load xarray and are therefore imported by whoever needs them, never from here.
"""

from petalfoil.results.record import Record, Scalar
from petalfoil.results.schema import VARIABLES, DataType, Variable

__all__ = ["VARIABLES", "DataType", "Record", "Scalar", "Variable"]
