"""Sphinx's settings; build.sh lays this beside the documents."""

import os
import pathlib
import re

root = pathlib.Path(os.environ["PINODE_SOURCE_DIR"])

project = "pinode"
author = copyright = "The pinode authors"
release = version = re.search(r"project\(pinode VERSION ([0-9.]+)",
                              (root / "CMakeLists.txt").read_text())[1]
root_doc = "index"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
doxygen = pathlib.Path(os.environ["PINODE_BUILD_DIR"]) / "site_doxygen" / "xml"
if doxygen.exists():
    extensions.append("breathe")
    breathe_projects = {"pinode": str(doxygen)}
    breathe_default_project = "pinode"

# Indented blocks are formulas, commands and output: no language.
highlight_language = "none"
myst_heading_anchors = 4
myst_all_links_external = False
autodoc_typehints = "description"
autodoc_member_order = "bysource"


def as_written(app, what, name, obj, options, lines):
    """Docstrings are plain text: their lines and indentation stay."""
    lines[:] = ["| " + re.sub(r"([*|\\])", r"\\\1", line) for line in lines] + [""]


def remember_ids():
    """Sphinx 5 spells out the names of all neighbours for every word that might be one of
    them: three quarters of the time. Later ones remember them, in the same way."""
    from sphinx.domains import cpp
    spell_out = cpp.ASTDeclaration.get_newest_id

    def get_newest_id(self):
        if getattr(self, "_newest_id_cache", None) is None:
            self._newest_id_cache = spell_out(self)
        return self._newest_id_cache

    cpp.ASTDeclaration.get_newest_id = get_newest_id


def setup(app):
    remember_ids()
    app.connect("autodoc-process-docstring", as_written)


html_theme = "alabaster"
html_theme_options = {
    "description": "Structural identification from matrices and records",
    "page_width": "1100px",
    "sidebar_width": "260px",
    "fixed_sidebar": True,
}
html_show_sourcelink = False
html_copy_source = False
