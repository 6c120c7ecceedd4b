"""Arrays of whatever library as numpy arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]  #: whose type and shape its comment says


def as_array(values: Any, name: str) -> Array:
    """Returns an array, without a copy where the object shares its memory (numpy, torch, DLPack, buffers).

    Tensors of other devices than the CPU raise what their library raises. Raises ValueError for masked
    values, which a plain array has no place for.
    """
    masks: Any = np.ma  # whose functions have no types
    if masks.is_masked(values):
        raise ValueError(f"{name}: has masked values, expected a plain array, as .filled(value) or rows without them")
    if hasattr(values, "detach"):  # a tensor that remembers how it was computed gives no memory away
        values = values.detach()
    if hasattr(values, "__dlpack__") and not hasattr(values, "__array__"):
        shared: Array = np.from_dlpack(values)
        return shared
    try:
        return np.asarray(values)
    except ValueError:
        raise ValueError(f"{name}: has rows of different lengths, expected an array") from None
