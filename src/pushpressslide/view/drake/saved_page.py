"""Reduction of Meshcat's saved page, and insertion of this package's parts around its
scene.
"""

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
"""One of the messages that make up the scene of a saved page."""


def small_page(page: str, head: str, body: str) -> str:
    """A saved page with ``head`` at the start of its head and ``body`` at the end of
    its body.

    Its messages are packed into one, which the script in ``head`` unpacks. If messages
    of another Drake version are not recognised, the page keeps them unchanged.
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
