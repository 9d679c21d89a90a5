"""Arrays as others have them, as arrays of NumPy with NaN where an entry is missing.

What is masked has a number below its mask that nobody is to see; NumPy itself
hands that out wherever a plain array is asked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def plain(values: Any) -> Any:
    """An array with masked entries as one with NaN in their places; any other value
    as it is."""
    if not isinstance(values, np.ma.MaskedArray):
        return values
    if not values.mask.any():
        return values.data
    # Others cannot be NaN; they are refused by name where numbers are asked for.
    if values.dtype.kind not in "fiu":
        return values.astype(object).filled(None)
    return values.astype(float).filled(np.nan)


def as_array(values: Any) -> np.ndarray:
    """`values` as an array, NaN where they are masked. Raises what NumPy raises for
    what is no array."""
    if isinstance(values, (list, tuple)):
        values = [plain(v) for v in values]
    return np.asarray(plain(values))
