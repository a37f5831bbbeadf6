"""Film, petals, contacts and rotor through time.

In the order data flows:

- `schedule`: speed and angle of the shaft over time.
- `rotor`: mass, loads and unbalance in the units of the problem.
- `state`: what is known at an instant.
- `tangent`: the factorised system, and how it follows contacts that change.
- `stage`: one implicit stage: film, wall, contacts and rotor in one Newton.
- `scheme`: a step of second order from two stages, with an error estimate.
- `march`: steps that adapt, from start to end.
"""
