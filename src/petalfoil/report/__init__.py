"""Pages from results.

The figures and claims of the paper, computed again under varied assumptions (`reproduce`):

==========================  =================================================================================
`paper_cases.py`            the bearings of the paper as cases; inputs that it does not state
`load_characteristics.py`   load characteristics of packs with 6, 8 and 10 petals, and the extent of the report
`assumptions.py`            loads under one changed assumption at a time
`fixed_bounds.py`           the fixed bounds (21), (22) of the paper instead of contact between petals
`interpretations.py`        other quantities that "load characteristic" may denote
`paper_grids.py`            loads on the grids of the paper
`claims.py`                 claims of the paper beside computed results
`page_figures.py`           figures of the page that no other page has
`page_tables.py`            results as tables of text
`html.py`                   elements of a page without external references, from `templates/`
`paper_page.py`                   the page
`report_files.py`           page, NetCDF, CSV and JSON in a folder
`reproduce.py`              the whole report
==========================  =================================================================================

What a design review asks about any bearing (`report`):

==========================  =================================================================================
`case_results.py`           the analyses of the report, with their results or refusals
`case_page.py`              the page: sections, headline, inputs and assumptions, accuracy
`pdf.py`                    a page printed by a browser or WeasyPrint
`case_report.py`            the whole report
==========================  =================================================================================

No analysis needs this package. It uses the analyses, the figures and the result files.
"""
