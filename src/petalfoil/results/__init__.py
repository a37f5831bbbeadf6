"""What a run leaves behind: labelled data that explains itself.

In the order data flows:

- ``variable`` what a result is: dimensions, SI unit, long name, symbol, type, label in tables
- ``schema``   every variable a result may hold
- ``record``   one answer as plain arrays (no xarray), checked against the schema
- ``parts``    typed parts that a record is put together from
- ``estimate`` what a sequence of grids tells about a result: limit, order, error bar
- ``places``   where film and pressure have their extremes: one place, or several alike
- ``rounding`` what tables and figures show as 0
- ``summary``  a record as the object of ``--json`` and as the rows of the printed table
- ``layout``   what an analysis returns: a point or a series
- ``answer``   the records of an analysis in their layout, as JSON and as labelled data
- ``grid``     the same over load and speed
- ``study``    the same of a grid study, with its estimates
- ``tables``   an answer as tables of text
- ``view``     a result as a notebook shows it: ``result.petalfoil``
- ``dataset``  records to ``xarray.Dataset``: one point, or a curve of points
- ``motion``   what the histories of a motion tell: positions once per revolution, spectra of the whirl
- ``spreadsheet`` any result for other programs: CSV, Excel
- ``export``   coefficients for other programs: CSV, XLTRC2
- ``ross``     coefficients as bearing elements of ROSS
- ``atomic``   a file is replaced whole or left alone
- ``seal``     proof that a file is what was written
- ``store``    datasets to NetCDF and back

Conventions: SI units inside; a result of a state that did not converge is NaN; ``dataset`` and
``store`` load xarray and are therefore imported by whoever needs them, never from here.
"""

from petalfoil.results.record import Record, Scalar
from petalfoil.results.schema import VARIABLES
from petalfoil.results.variable import DataType, Variable

__all__ = ["VARIABLES", "DataType", "Record", "Scalar", "Variable"]
