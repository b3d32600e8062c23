"""The site's settings: ``uv run --group docs sphinx-build -W -b html docs build/site``."""

import logging
import os
import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")  # of the notebooks' kernels
logging.getLogger("skfem").setLevel(logging.WARNING)

project = "modalkit"
author = "The modalkit developers"
copyright = "2026, the modalkit developers"
version = release = version_of("modalkit-ema")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_design", "modalkit_site"]
exclude_patterns = [
    "made",
    "_ext",
    "**/.ipynb_checkpoints",
    "trust/blind_score.md",
]  # the score is a download
source_suffix = {".md": "myst-nb"}
nitpicky = False
default_role = None
suppress_warnings = [
    "misc.highlighting_failure",
    "myst.header",
    "ref.python",
]  # tables of commands; a name in two classes

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

html_math_renderer = "mathml"
html_theme = "furo"
html_title = "modalkit"
html_static_path = ["_static"]
html_css_files = ["modalkit.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"sidebar_hide_name": False, "navigation_with_keys": True}

autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
