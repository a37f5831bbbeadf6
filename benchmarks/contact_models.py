"""Contacts that random packs are found with on a grid: `python benchmarks/contact_models.py CELLS [EVERY]`.

The 200 packs of `tests/verification/test_random_bearings.py`, each or every few. A line for each pack; at the end how
many have contact points, contact pressures over asperities and contacts at nodes, and the factorisations of pack, film
and probe.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np

from petalfoil.analysis.solve import solve

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.random_packs import random_case
from tests.verification.test_random_bearings import SEED

PACKS = 200


def main() -> None:
    """Solve the packs."""
    cells, every = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    rng, models, counts = np.random.default_rng(SEED), Counter[str](), []
    for number in range(PACKS):
        case = random_case(rng, **{"model.cells_per_pitch": cells})
        if number % every:
            continue
        found = solve.record(case).scalars
        model = str(found["contact_model"]).split(" on ")[0].split(" of ")[0]
        parts = [int(str(found[name])) for name in ("pack_iterations", "factorizations", "probe_factorizations")]
        models[model] += 1
        counts.append(sum(parts))
        print(f"{number:4d}  {model:40s} {found['bearing_force']:12.6g} N  pack, film, probe {parts}", flush=True)
    print(dict(models), f"factorisations: median {np.median(counts):g}, mean {np.mean(counts):.1f}")


if __name__ == "__main__":
    main()
