"""Reduction of Meshcat's saved page, and insertion of fragments around its scene."""

from __future__ import annotations

import base64
import gzip
import re

MESSAGE = re.compile(
    r'fetch\("data:application/octet-binary;base64,([^"]*)"\)\s*'
    r"\.then\(res => res\.arrayBuffer\(\)\)\s*"
    r"\.then\(buffer => viewer\.handle_command_bytearray"
    r"\(new Uint8Array\(buffer\)\)\);"
)
"""Pattern of a message in a saved page. The messages make up the scene."""


def small_page(page: str, head: str, body: str) -> str:
    """A saved page with ``head`` inserted at the start of its head, and ``body`` at the
    end of its body.

    All messages are packed into one, which the script in ``head`` unpacks. Messages
    that are not recognised, as from another Drake version, stay unchanged.
    """
    messages = [base64.b64decode(text) for text in MESSAGE.findall(page)]
    if messages:
        call = f'loadMessages("{pack(messages)}");'
        # a function, so that no character of the replacement is an escape
        page = MESSAGE.sub(lambda _: call, page, count=1)
        page = MESSAGE.sub("", page)
    page = page.replace("<head>", f"<head>{head}", 1)
    before, end, after = page.rpartition("</body>")
    return f"{before}{body}{end}{after}" if end else page + body


def pack(messages: list[bytes]) -> str:
    """Messages as one compressed text, each preceded by its length in four
    little-endian bytes.
    """
    parts = [len(message).to_bytes(4, "little") + message for message in messages]
    return base64.b64encode(gzip.compress(b"".join(parts), mtime=0)).decode("ascii")
