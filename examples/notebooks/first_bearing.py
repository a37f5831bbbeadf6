# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A bearing in a notebook
#
# A case, a figure and a result show themselves: the last line of a cell is enough.

# %%
import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 32})
case

# %% [markdown]
# The foil pack at rest. Petals must lie as they do in the drawing.

# %%
plot.pack(petalfoil.check(case))

# %% [markdown]
# Film, petals and contacts at the operating point under a load of 20 N, with error bars from two more grids.

# %%
point = petalfoil.balance(case, load="20 N", error=True)
point.petalfoil

# %%
plot.operating_point(point)

# %% [markdown]
# A result is an `xarray.Dataset` in SI units.

# %%
film = point["min_film_thickness"]
print(f"minimum film thickness {film.item() * 1e6:.2f} ± {film.attrs['grid_error'] * 1e6:.2f} µm")

# %% [markdown]
# How does the film depend on the thickness of the petals?

# %%
thicknesses = ("0.16 mm", "0.18 mm", "0.20 mm")
films = {}
for thickness in thicknesses:
    changed = case.replace(**{"petals.thickness": thickness})
    films[thickness] = petalfoil.balance(changed, load="20 N")["min_film_thickness"].item() * 1e6
films
