"""A figure that a notebook shows. Apart from the rest, since matplotlib is
imported where a figure is drawn, and not before."""

from __future__ import annotations

import io
from typing import Any

import matplotlib.figure


class Figure(matplotlib.figure.Figure):
    """matplotlib's, with a picture of its own: IPython knows how to show
    matplotlib's only once pyplot is there, which nothing here needs."""

    def _repr_png_(self) -> "bytes | None":
        if not self.axes:
            return None
        picture = io.BytesIO()
        # As `%matplotlib inline` would draw it.
        self.savefig(picture, format="png", dpi=self.dpi, bbox_inches="tight",
                     facecolor=self.get_facecolor())
        return picture.getvalue()
