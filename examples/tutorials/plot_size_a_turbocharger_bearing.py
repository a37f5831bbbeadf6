"""
Size a turbocharger bearing
===========================

From requirements to a choice, with the mistakes that people make on the way.

A rotor of 2.4 kg runs at 90 000 rpm in two equal bearings on a shaft of 30 mm, in air of 150 °C. Each bearing carries
12 N. Required are

- a minimum film thickness of 2 µm at speed, and no solid contact,
- lift-off below 40 000 rpm,
- a bending stress below 600 MPa, for the spring steel yields at 1 GPa.

Grids are coarse here so that this page is computed in seconds; the choice is checked on a finer one.
"""

import math

import petalfoil
from petalfoil import plot

# %%
# A first guess
# -------------
#
# Eight petals of 0.12 mm in a bushing that leaves 0.6 mm: each petal is as long as two pitches and a bit, so that two
# to three layers lie on each other. The roots are hinged.

first = petalfoil.Case.from_toml("""
title = "Turbocharger, 30 mm"

[bearing]
journal_radius = "15 mm"
bushing_radius = "15.6 mm"
length = "30 mm"

[petals]
count = 8
arc_length = "27 mm"
thickness = "0.12 mm"
coating = "15 um"
bend_radius = "24 mm"
mount = "hinged"
youngs_modulus = "214 GPa"
poisson_ratio = 0.29
yield_strength = "1 GPa"

[gas]
name = "air"
temperature = "150 degC"
ambient_pressure = "1 bar"

[surface]
contact_film_thickness = "1.5 um"
friction_coefficient = 0.15

[operation]
speed = "90000 rpm"
load = "12 N"

[model]
kind = "3d"
cells_per_pitch = 16
axial_cells = 8
""")
pack = plot.pack(petalfoil.check(first))

# %%
# Mistake 1: to believe the 2-D model
# -----------------------------------
#
# The 2-D model is fast, and flatters: no gas leaves at the ends. This bearing is as long as its diameter.


def describe(name: str, case: petalfoil.Case) -> None:
    """One line about the operating point."""
    point = petalfoil.balance(case)
    film, stress = 1e6 * float(point["min_film_thickness"]), 1e-6 * float(point["max_bending_stress"])
    contact, loss = 100.0 * float(point["contact_fraction"]), float(point["power_loss"])
    print(f"{name:24} film {film:5.2f} um   contact {contact:4.1f} %   stress {stress:6.0f} MPa   loss {loss:6.0f} W")


describe("2-D", first.replace(**{"model.kind": "2d"}))
describe("3-D", first)

# %%
# In 3-D the film is 40 % thinner, and below the 2 µm that are required.
#
# Mistake 2: to clamp petals that were shaped to be hinged
# --------------------------------------------------------
#
# A clamped root keeps the angle of the drawing. At the tilt of a hinged petal (``root_tilt = "chordal"``) it presses
# the petals onto the journal with many times the force. Warnings name a stress above the yield strength. Clamped along
# the bore it is another bearing, and a good one.

describe("clamped, chordal", first.replace(**{"petals.mount": "clamped"}))
describe("clamped, along the bore", first.replace(**{"petals.mount": "clamped", "petals.root_tilt": "0 deg"}))

# %%
# Mistake 3: to make it stronger
# ------------------------------
#
# Thicker and more petals seem to carry more. Before they carry anything, they press on the journal by their own
# bending, and this preload rubs.

for count, thickness in ((8, 0.15), (10, 0.12), (8, 0.10), (6, 0.12)):
    describe(
        f"{count} petals of {thickness:g} mm",
        first.replace(**{"petals.count": count, "petals.thickness": f"{thickness} mm"}),
    )

# %%
# The choice
# ----------
#
# Fewer petals have less preload. Six of 0.12 mm keep the film; lift-off decides.

chosen = first.replace(**{"petals.count": 6, "title": "Turbocharger, six petals"})
liftoff = petalfoil.liftoff(chosen)
print(f"lift-off at {float(liftoff['liftoff_speed'][0]) * 30.0 / math.pi:.0f} rpm")

# %%
# Before anybody builds it, the grid: twice as many cells. A minimum film thickness at a free edge in 3-D needs the
# finest grid of all results, and ``petalfoil.balance(case, error=True)`` gives its error bar.

fine = chosen.replace(**{"model.cells_per_pitch": 32, "model.axial_cells": 16})
describe("six petals, 16 x 8 cells", chosen)
describe("six petals, 32 x 16 cells", fine)
result = petalfoil.balance(fine)
film = plot.summary(result)

# %%
# What remains to be asked: is the rotor stable (``petalfoil stability``), how far do tolerances move these numbers
# (``petalfoil tolerance``), what does the design review get (``petalfoil report``)? And above all: are mount, tilt and
# free shape of your petals those of the case? No result depends on anything as much.
