"""Sphinx's settings; build.sh lays this beside the documents."""

import inspect
import os
import pathlib
import re
import textwrap

from docutils import nodes

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
# Quotes of examples stay what can be copied.
smartquotes = False
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"


def inline(text):
    """A line of plain text, in which `names` stand between backquotes."""
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(f"`{part}`" if part.startswith("`") and part.endswith("`") and len(part) > 2
                   else re.sub(r"([*|`\\])|(?<=\w)(_)(?!\w)", r"\\\1\2", part)
                   for part in parts)


def arguments(obj):
    try:
        return set(inspect.signature(obj).parameters)
    except (TypeError, ValueError):
        return set()


def is_python(code):
    try:
        compile(code, "example", "exec")
    except SyntaxError:
        return False
    return True


def entry(line, known):
    """(arguments, text) of a line "name, name: what they are"; none of any other."""
    match = re.match(r"([\w, ]+): +(.*)", line)
    named = match[1].split(", ") if match else []
    return (named, match[2]) if named and set(named) <= known else ([], "")


def blocks_of(lines, known):
    """Paragraphs, entries of arguments and what is indented below an empty line."""
    block = []
    for line in lines:
        follows = block and block[-1].strip()
        if line.startswith("    ") and block and (follows or block[0].startswith("    ")):
            block.append(line)
        elif not line.strip():
            if block:
                block.append("")
        elif follows and not entry(line, known)[0] and not entry(block[0], known)[0]:
            block.append(line)
        else:
            yield block
            block = [line]
    yield block


def as_written(app, what, name, obj, options, lines):
    """Docstrings are plain text: examples become code, what is said of arguments stands
    at the arguments, and of all else lines and indentation stay."""
    known = arguments(obj)
    written = []
    for block in blocks_of(list(lines), known):
        while block and not block[-1].strip():
            block.pop()
        if not block:
            continue
        named, text = entry(block[0], known)
        if block[0].startswith("    "):
            code = textwrap.dedent("\n".join(block))
            language = "python" if is_python(code) else "none"
            written += [f".. code-block:: {language}", "",
                        *("   " + line for line in code.splitlines())]
        elif named:
            text = " ".join(inline(line.strip()) for line in [text, *block[1:]])
            written += [f":param {argument}: {text}" for argument in named]
        else:
            written += ["| " + inline(line) for line in block]
        written.append("")
    lines[:] = written


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


def dashes(app, doctree, page):
    """Between an argument and what it is; `smartquotes` would make them."""
    for text in list(doctree.findall(nodes.Text)):
        if text == " -- ":
            text.parent.replace(text, nodes.Text(" – "))


def setup(app):
    remember_ids()
    app.connect("doctree-resolved", dashes)
    app.connect("autodoc-process-docstring", as_written)


html_theme = "alabaster"
html_theme_options = {
    "description": "Structural identification from matrices and records",
    "page_width": "1280px",
    "body_max_width": "1000px",
    "sidebar_width": "260px",
    "fixed_sidebar": True,
}
templates_path = ["_templates"]
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
