"""View of a structure as a page."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path

from ._part import as_path
from ._pinode import Error


class StructureView:
    """A structure in 3-D, for a notebook or a page of its own.

    html: the page. It can be rotated by mouse, keys and touch. On paper and without
        WebGL it is a still picture.
    """

    def __init__(self, section: str) -> None:
        self.html = (
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            "<title>The structure</title></head>\n"
            '<body style="font: 15px/1.5 sans-serif; margin: 12px">\n'
            f"{section}</body></html>\n"
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page to a file."""
        file = Path(as_path("path", path))
        try:
            file.write_text(self.html, encoding="utf-8")
        except OSError as failure:
            raise Error(f"{file}: cannot be written: {failure.strerror}") from None

    def _repr_html_(self) -> str:
        # A long list of groups needs more, and the controls come when it draws.
        grow = "this.style.height = this.contentDocument.documentElement.scrollHeight + 40 + 'px'"
        return (
            '<iframe title="The structure" style="width: 100%; height: 800px; border: 0" '
            f'onload="{grow}" srcdoc="{escape(self.html)}"></iframe>'
        )
