"""How the pages of docs/ become a site: `make docs` writes it to docs/_build/html, without network."""

from __future__ import annotations

project = "Reflight"
author = "the Reflight authors"
copyright = author  # noqa: A001

extensions = ["myst_parser"]
exclude_patterns = ["_build"]
myst_enable_extensions = ["colon_fence"]
# Every heading down to this level can be linked to, by the name that GitHub gives it.
myst_heading_anchors = 4
# Blocks of a language that Pygments does not know, or cannot read, are an error of the page.
highlight_language = "text"
# Two hyphens stay two: they begin options.
smartquotes = False

html_theme = "furo"
html_title = "Reflight"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
# Nothing is asked of the network, neither when the site is built nor when it is read.
intersphinx_mapping: dict[str, tuple[str, None]] = {}
html_theme_options = {"navigation_with_keys": True}
