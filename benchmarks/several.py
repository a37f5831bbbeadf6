"""Random packs that have several equilibria, and what tells them: `python benchmarks/several.py 200 2024`.

Every pack is answered by the first barrier that leads somewhere, and the coarse grid is asked for others whatever that
answer says. A line for each with several equilibria; at the end, for how many the answer says that there may be some.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.branches import coarse, longest_contact, may_have_others, probe
from petalfoil.equilibrium.cold_start import by_barriers
from petalfoil.equilibrium.run_context import running
from petalfoil.system.build import build_problem

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.random_packs import random_case


def main() -> None:
    """Ask the packs."""
    count, seed = int(sys.argv[1]), int(sys.argv[2])
    rng, asked, rates = np.random.default_rng(seed), 0, []
    for number in range(count):
        case = random_case(rng, **{"model.contacts": "nodes"})
        with running():
            answer, others = by_barriers(build_problem(case)), probe(build_problem(coarse(case)))
            rate = complex(np.nan) if answer is None else leading_eigenvalue(answer)
        told = answer is None or may_have_others(answer, rate)
        asked += told
        rates.append(rate.real)
        if others > 1 and answer is not None:
            step = float(answer.shortest_step or 0.0)
            values = f"decay {-rate.real:.3g}, longest contact {longest_contact(answer):.3f}, shortest step {step:.3g}"
            print(f"pack {number}: {others} equilibria, {values}, {'looked for' if told else 'MISSED'}")
    print(f"{count} packs of seed {seed}: looked for in {asked}; median decay {-np.nanmedian(rates):.2f}")


if __name__ == "__main__":
    main()
