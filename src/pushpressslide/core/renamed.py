"""Old names of attributes, which answer for one version."""

from __future__ import annotations

import warnings
from typing import Any


class Renamed:
    """Attribute of a class that answers by its old name, with a DeprecationWarning."""

    def __init__(self, new: str, until: str = "0.6") -> None:
        """Answer for the attribute ``new``, until a version."""
        self._new = new
        self._until = until

    def __set_name__(self, owner: type, name: str) -> None:
        """Learn the old name."""
        self._old = f"{owner.__name__}.{name}"

    def __get__(self, instance: Any, owner: type) -> Any:
        """The attribute by its new name."""
        text = f"{self._old}: call it {self._new}; the old name goes in {self._until}"
        warnings.warn(text, DeprecationWarning, stacklevel=2)
        return getattr(owner if instance is None else instance, self._new)
