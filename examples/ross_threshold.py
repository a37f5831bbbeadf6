"""Threshold speed of a rotor in ROSS 3 (https://github.com/petrobras/ross) on two bearings of petalfoil.

    petalfoil coefficients examples/plain_journal.toml --load "20 N" --speeds "300 rad/s : 1500 rad/s : 13" \
        --out plain.nc --ross drive.toml --node 0
    petalfoil show plain.nc --ross free.toml --node 2
    python examples/ross_threshold.py drive.toml free.toml 4.079

The last number is the mass of the rotor [kg], here the load of both bearings over gravity. The rotor is a light, stiff
shaft with a disk between the bearings, so that `petalfoil stability examples/plain_journal.toml --load "20 N"` answers
the same question: 733 rad/s; ROSS 3.0.0 says 734. `matched_whirl` is what matters: without it ROSS takes every whirl to
be as fast as the shaft.
"""

import sys
from pathlib import Path

from scipy.optimize import brentq

if __name__ == "__main__":
    if len(sys.argv) != 4:
        raise SystemExit(f"usage: python examples/{Path(__file__).name} DRIVE.toml FREE.toml MASS")
    import ross as rs  # loads for seconds

    bearings = [rs.BearingElement.load(file) for file in sys.argv[1:3]]
    stiff = rs.Material("stiff", rho=1.0, E=2.0e13, Poisson=0.3)
    shaft = [rs.ShaftElement(L=0.1, idl=0.0, odl=0.05, material=stiff, n=node) for node in (0, 1)]
    disk = rs.DiskElement(n=1, m=float(sys.argv[3]), Id=1e-2, Ip=1e-3)
    rotor = rs.Rotor(shaft, [disk], bearings)

    def growth(speed: float) -> float:
        """Largest growth rate of a mode that whirls slower than the shaft [1/s]."""
        modes = rotor.run_modal(speed, num_modes=12, sparse=False, matched_whirl=True).evalues
        return max(value.real for value in modes if 0.1 * speed < value.imag < speed)

    low, high = bearings[0].speed[0], bearings[0].speed[-1]
    print(f"growth rate {growth(low):.1f} 1/s at {low:.0f} rad/s, {growth(high):.1f} 1/s at {high:.0f} rad/s")
    print(f"threshold speed: {brentq(growth, low, high, xtol=0.1):.0f} rad/s")
