"""Play bar of a replay page, as fragments of text for the page."""

from __future__ import annotations

import json
from importlib import resources
from typing import Any


def package_text(name: str, package: str = "pushpressslide.view") -> str:
    """Content of a text file in one of the package's folders."""
    return resources.files(package).joinpath(name).read_text("utf-8")


def filled(template: str, values: dict[str, str]) -> str:
    """The template with its placeholders ``@NAME@`` filled, including those of the play
    bar: ``@BAR_STYLE@``, ``@BAR@`` and ``@BAR_SCRIPT@``.
    """
    bar = {
        "BAR_STYLE": package_text("bar.css"),
        "BAR": package_text("bar.html"),
        "BAR_SCRIPT": package_text("bar.js"),
    }
    for name, text in {**bar, **values}.items():
        template = template.replace(f"@{name}@", text)
    return template


def json_in_page(data: Any) -> str:
    """Data as JSON that is safe inside a page's script. Raises ValueError for NaN."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("</", "<\\/")
