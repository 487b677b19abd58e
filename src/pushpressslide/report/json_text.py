"""Strict JSON text of any result."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def to_json(value: Any) -> str:
    """Strict JSON text (without NaN) of ``value``, indented, with a final newline."""
    return (
        json.dumps(plain(value), indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    )


def plain(value: Any) -> Any:
    """``value`` as data that JSON supports.

    NumPy scalars and arrays become numbers and lists; NaN and infinity become None.
    """
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
