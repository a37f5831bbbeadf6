"""
Stiffness, damping and whirl
============================

When does a rotor in a gas film become unstable, which coefficients tell it, and what do petals change?

A gas film turns with about half the speed of the journal. A rotor that whirls so is not resisted by the film: its
whirl grows. Coefficients that are taken at the speed itself (synchronous whirl) do not show this.
"""

import math

import petalfoil
from petalfoil import plot

RPM = 30.0 / math.pi

# %%
# A plain bearing
# ---------------
#
# Stiffness and damping of a gas film depend on the whirl frequency.

plain = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.cells_per_pitch": 32, "model.axial_cells": 8})
speed = plain.operation.speed
whirl = petalfoil.coefficients(plain, [ratio * speed for ratio in (0.1, 0.3, 0.5, 0.7, 1.0, 1.5)], load="30 N")
coefficients = plot.coefficients(whirl)

# %%
# The critical mass is the largest mass of a rigid rotor that is stable; above it, the rotor whirls at ``whirl_ratio``
# times the speed.

stability = petalfoil.stability(plain, load="30 N", mass="3 kg")
print(f"critical mass    {float(stability['critical_mass']):.2f} kg")
print(f"whirl ratio      {float(stability['whirl_ratio']):.3f}")
print(f"threshold speed  {float(stability['threshold_speed']) * RPM:.0f} rpm for 3 kg")

# %%
# Which modes has a rotor of 3 kg at the speed of the case? One with a positive growth rate is unstable.

modes = plot.stability(stability)

# %%
# More load, more stable: the journal is displaced farther, and the film is stiffer on one side.

for load in ("10 N", "30 N", "60 N"):
    mass = float(petalfoil.stability(plain, load=load)["critical_mass"])
    print(f"{load}: critical mass {mass:.2f} kg")

# %%
# Petals
# ------
#
# Petals deflect with the film. Their wedges keep the journal centred, and cross stiffness nearly vanishes.

petals = petalfoil.Case.load("../paper_n6.toml").replace(**{"model.cells_per_pitch": 32})
result = petalfoil.coefficients(petals, [0.5 * petals.operation.speed, petals.operation.speed], load="20 N")
direct, cross = (float(result["stiffness"][0, 1, column]) for column in (1, 0))
print(f"direct stiffness {direct:9.0f} N/m")
print(f"cross stiffness  {cross:9.0f} N/m")

# %%
# Stable for any mass does not mean calm: without friction the petals hardly damp, and resonances are sharp. Look at the
# damping ratios.

modes_on_petals = petalfoil.stability(petals, load="20 N", mass="2 kg")
for frequency, ratio in zip(
    modes_on_petals["natural_frequency"].values, modes_on_petals["damping_ratio"].values, strict=True
):
    print(f"{frequency / (2.0 * math.pi):6.1f} Hz   damping ratio {ratio:.1e}")

# %%
# What to take along
# ------------------
#
# - Give a rotordynamics program the coefficients over whirl frequency, not at the speed alone
#   (``petalfoil coefficients --ross``).
# - Ask for the threshold speed at every load that occurs; the lightest is the most dangerous one for a plain bearing.
# - Dry friction between petals damps more than any number here says. Measure the damping of real petal bearings.
