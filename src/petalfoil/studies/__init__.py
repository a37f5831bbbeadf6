"""Studies: one question asked of many cases, in a folder that survives whatever stops it.

In the order data flows:

- `question`: what is asked of every case, and its answer for one.
- `variation`: a parameter and the values that it takes.
- `plan`: which cases there are: a grid, or a sample.
- `study_definition`: all of it together, as the file of a study.
- `case_engine`: where cases are answered: in this process, or on the workers of a cluster.
- `study_store`: the folder of a study and its index.
- `study_dataset`: outcomes as labelled data.
- `run`: answers what is not answered yet, and lays it out.
- `sweep`: a grid or a sample of parameters.
- `limits`: limits and objectives: results with a bound.
- `tolerance`: a sample of bearings that scatter.
- `sobol`: Sobol' indices, which part of the variance each parameter explains.
- `goals`: objectives, limits, and the designs that are best.
- `search`: a search under way: what it asked, and what was best.
- `slsqp`: along gradients (SciPy).
- `sampling`: by sampling (Optuna).
- `gradients`: exact derivatives for a search.
- `optimize`: the best design within limits.
- `study_summary`: a study in words and numbers.
- `study_page`: its figures and its page.
- `case_files`: its cases as case files.
"""
