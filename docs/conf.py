"""The documentation site: `make docs` builds it into build/docs, without any request to the network."""

from __future__ import annotations

import sys
from importlib.metadata import files
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent / "src")]

import gallery  # noqa: E402  (beside this file)

from petalfoil import __version__  # noqa: E402

project = "petalfoil"
author = "petalfoil contributors"
project_copyright = "petalfoil contributors, MIT licence"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "reference",
]
exclude_patterns = [
    "_ext",
    "sg_execution_times.rst",
    *(f"{folder}/*.{kind}" for folder in ("gallery", "tutorials/worked") for kind in ("ipynb", "py", "zip")),
]
nitpicky = False  # docstrings name types in words, "(n, m) array", which are no targets

# ---------------------------------------------------------------------------------------------- pages

myst_enable_extensions = ["attrs_inline", "colon_fence", "dollarmath"]
myst_heading_anchors = 4
suppress_warnings = [
    "config.cache",  # the settings of the gallery hold functions, which are no part of any page
]

# ---------------------------------------------------------------------------------------------- Python

autodoc_typehints = "none"  # arguments with units are described in the text
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

# ---------------------------------------------------------------------------------------------- look

html_theme = "pydata_sphinx_theme"
html_title = "petalfoil"
html_static_path = ["_static"]
html_css_files = ["petalfoil.css"]
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {name: [] for name in ("theory", "contributing", "changes")}  # pages without siblings
html_theme_options = {
    "logo": {"text": f"petalfoil {version}"},
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}

# ---------------------------------------------------------------------------------------------- mathematics

mathjax_path = "mathjax/tex-svg-full.js"
"""One file that draws formulas without fonts: it comes from an installed package, not from a server."""


def copy_mathjax(app: object, problem: Exception | None) -> None:
    """Put MathJax beside the pages."""
    if problem is None:
        (source,) = (f for f in files("sphinx-mathjax-offline") or () if f.name == "tex-svg-full.js")
        target = Path(app.outdir) / "_static" / mathjax_path  # type: ignore[attr-defined]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(Path(str(source.locate())).read_bytes())


# ---------------------------------------------------------------------------------------------- gallery

sphinx_gallery_conf = {
    "examples_dirs": ["../examples/gallery", "../examples/tutorials"],
    "gallery_dirs": ["gallery", "tutorials/worked"],
    "filename_pattern": r"/plot_",
    "image_scrapers": (gallery.scraper,),
    "reset_modules": (),
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,  # that page would ask other servers for scripts
    "only_warn_on_example_error": False,
    "abort_on_example_error": True,
    "within_subsection_order": "FileNameSortKey",
}


def setup(app: object) -> None:
    """Copy MathJax when the pages are written."""
    app.connect("build-finished", copy_mathjax)  # type: ignore[attr-defined]
