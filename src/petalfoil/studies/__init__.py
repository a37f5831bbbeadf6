"""Studies: one question asked of many cases, in a folder that survives whatever stops it.

In the order data flows:

- `question`: what is asked of every case, and its answer for one.
- `variation`: a parameter and the values that it takes.
- `plan`: which cases there are: a grid, or a sample.
- `definition`: all of it together, as the file of a study.
- `engine`: where cases are answered: in this process, or on the workers of a cluster.
- `store`: the folder of a study and its index.
- `dataset`: outcomes as labelled data.
- `run`: answers what is not answered yet, and lays it out.
- `sweep`: a grid or a sample of parameters.
- `limits`: limits and objectives: results with a bound.
- `tolerance`: a sample of bearings that scatter.
- `sobol`: Sobol' indices, which part of the variance each parameter explains.
- `goals`: objectives, limits, and the designs that are best.
- `search`: a search under way: what it asked, and what was best.
- `descent`: along gradients (SciPy).
- `sampling`: by sampling (Optuna).
- `gradients`: exact derivatives for a search.
- `optimize`: the best design within limits.
- `summary`: a study in words and numbers.
- `page`: its figures and its page.
- `export`: its cases as case files.
"""
