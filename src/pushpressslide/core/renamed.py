"""Old names of attributes, which still work for one version."""

from __future__ import annotations

import warnings
from typing import Any


class Renamed:
    """Old name of a class's attribute. Its use gives a DeprecationWarning."""

    def __init__(self, new: str, until: str = "0.6") -> None:
        """Make the old name stand for the attribute ``new`` until the version
        ``until``.
        """
        self._new = new
        self._until = until

    def __set_name__(self, owner: type, name: str) -> None:
        """Store the old name for the warning."""
        self._old = f"{owner.__name__}.{name}"

    def __get__(self, instance: Any, owner: type) -> Any:
        """Value of the renamed attribute, with a deprecation warning."""
        text = f"{self._old}: call it {self._new}; the old name goes in {self._until}"
        warnings.warn(text, DeprecationWarning, stacklevel=2)
        return getattr(owner if instance is None else instance, self._new)
