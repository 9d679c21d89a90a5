"""Figure that a notebook shows, in a module of its own because matplotlib is imported
only when a figure is drawn.
"""

from __future__ import annotations

import io
from typing import Any

import matplotlib.figure


class Figure(matplotlib.figure.Figure):
    """Figure of matplotlib that draws its own picture. IPython can show matplotlib's
    figures only after pyplot was imported, which this package does not need.
    """

    def _repr_png_(self) -> "bytes | None":
        if not self.axes:
            return None
        picture = io.BytesIO()
        # As `%matplotlib inline` would draw it.
        self.savefig(picture, format="png", dpi=self.dpi, bbox_inches="tight",
                     facecolor=self.get_facecolor())
        return picture.getvalue()
