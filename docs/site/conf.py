"""How Sphinx makes the site of the pages that scripts/docs_site gathers."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

project = "Stator"
html_title = "Stator"
language = "en"
extensions = ["myst_parser", "navigation", "search_entries"]
myst_heading_anchors = 6
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["stator.css"]
html_js_files = ["stator.js"]
html_search_scorer = str(Path(__file__).resolve().parent / "scorer.js")
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_permalinks_icon = "#"
pygments_style = "default"
pygments_dark_style = "github-dark"
