"""Natural frequencies of a rotor in ROSS 3 (https://github.com/petrobras/ross) on two petal bearings of petalfoil.

    petalfoil coefficients examples/paper_n8.toml --load "20 N" --speeds "4000 rad/s : 8000 rad/s : 5" \
        --out petals.nc --ross drive.toml --node 0
    petalfoil show petals.nc --ross free.toml --node 2
    python examples/ross_petals.py drive.toml free.toml 4.079

The last number is the mass of the rotor [kg], the load of both bearings over gravity. The shaft is light and stiff, so
that `petalfoil stability examples/paper_n8.toml --load "20 N"` answers the same question for half the rotor.
"""

import sys
from pathlib import Path

if __name__ == "__main__":
    if len(sys.argv) != 4:
        raise SystemExit(f"usage: python examples/{Path(__file__).name} DRIVE.toml FREE.toml MASS")
    import ross as rs  # loads for seconds

    bearings = [rs.BearingElement.load(file) for file in sys.argv[1:3]]
    stiff = rs.Material("stiff", rho=1.0, E=2.0e13, Poisson=0.3)
    shaft = [rs.ShaftElement(L=0.1, idl=0.0, odl=0.05, material=stiff, n=node) for node in (0, 1)]
    disk = rs.DiskElement(n=1, m=float(sys.argv[3]), Id=1e-2, Ip=1e-3)
    rotor = rs.Rotor(shaft, [disk], bearings)
    speed = bearings[0].speed[-1]
    modes = rotor.run_modal(speed, num_modes=12, sparse=False, matched_whirl=True).evalues
    slow = sorted((mode for mode in modes if 0.0 < mode.imag < 0.1 * speed), key=lambda mode: mode.imag)
    print(f"natural frequencies at {speed:.0f} rad/s: {', '.join(f'{mode.imag:.1f}' for mode in slow)} rad/s")
    print(f"largest growth rate of these: {max(mode.real for mode in slow):.4f} 1/s")
