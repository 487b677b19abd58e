"""Root element of a robot's file: plain XML, without external entities."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from xml.etree.ElementTree import Element

from pushpressslide.core.errors import PushPressSlideError


def xml_root(path: Path) -> Element:
    """Root of a file. Prefixes become part of the names.

    Raises PushPressSlideError for a file that is not XML, and OSError for one that
    cannot be read.
    """
    try:
        # files often use a prefix (drake, xacro, gazebo) without declaring it
        text = re.sub(r"(</?)(\w+):(?=\w)", r"\1\2_", path.read_text("utf-8"))
        return ElementTree.fromstring(
            re.sub(r"(\s)(?!xmlns:)(\w+):(?=\w+\s*=)", r"\1\2_", text)
        )
    except (ElementTree.ParseError, UnicodeDecodeError) as error:
        raise PushPressSlideError(f"it is not XML ({error})") from error
