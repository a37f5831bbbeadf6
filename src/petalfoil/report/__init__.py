"""THE PAPER'S FIGURES AND CLAIMS, regenerated: runs, a study of its silent assumptions, one page (`reproduce`).

================  =========================================================================================
`paper.py`        the paper's packages as cases; what it claims, where it is silent, what was assumed
`scope.py`        how much is run: grids and displacements
`families.py`     the load characteristics of 6, 8 and 10 petals under one set of assumptions
`variations.py`   the assumptions that are varied
`study.py`        the loads under each of them, as ratios
`bounds.py`       the paper's fixed bounds (21), (22) in place of contact between petals
`meanings.py`     what "load characteristic" may mean
`grids.py`        the paper's grids
`claims.py`       claims beside numbers
`figures.py`      figures of the page
`tables.py`       results as rows of text
`page.py`         the page: one file without references to anything outside it
`files.py`        page, NetCDF, CSV and JSON to a folder
`reproduce.py`    all of it in order
================  =========================================================================================

Nothing here is needed by a run: the room stands above the analyses and beside the faces.
"""
