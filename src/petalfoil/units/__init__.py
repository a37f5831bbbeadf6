"""Quantities at the border: ``"25 um"`` comes in as 2.5e-05, and 2.5e-05 goes out as ``"25 µm"``.

Inside the package every number is a float in SI units; text is read here and nowhere else.

- `reading`: text or number → float in SI units; pairs and ranges of the command line.
- `usual`: units of most cases → exact factors.
- `grammar`: the text of any other unit → a pint unit; the only file that knows pint, imported when the first is read.
- `mistyped`: what is meant by a unit that is none, or that measures something else.
- `ramp`: the text of a speed that changes → instants and speeds.
- `writing`: float → text for a reader.
"""

from petalfoil.units.ramp import parse_ramp
from petalfoil.units.reading import parse_pair, parse_quantity, parse_range
from petalfoil.units.writing import format_percent, format_quantity

__all__ = ["format_percent", "format_quantity", "parse_pair", "parse_quantity", "parse_ramp", "parse_range"]
