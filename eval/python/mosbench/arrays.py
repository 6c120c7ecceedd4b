"""Arrays of whatever library as numpy arrays."""

from __future__ import annotations

from typing import Any

import numpy as np


def as_array(values: Any) -> np.ndarray:
    """Returns an array, without a copy where the object shares its memory (numpy, torch, DLPack, buffers).

    Tensors of other devices than the CPU raise what their library raises.
    """
    if hasattr(values, "detach"):  # a tensor that remembers how it was computed gives no memory away
        values = values.detach()
    if hasattr(values, "__dlpack__") and not hasattr(values, "__array__"):
        return np.from_dlpack(values)
    return np.asarray(values)
