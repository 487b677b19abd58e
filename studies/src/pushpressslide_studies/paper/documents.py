"""Insertion of the results of ``pps reproduce`` into the documents.

python -m pushpressslide_studies.paper.documents TABLE RESULTS README

TABLE is the table.md of a run. RESULTS and README are the pages that are renewed
between their marks.
"""

from __future__ import annotations

import sys
from pathlib import Path

from pushpressslide.core.whole_file import write_whole

CLAIMS = "## Claims\n\n"


def renewed(page: str, name: str, text: str) -> str:
    """A page with the text between the two marks of the given name replaced by
    ``text``.

    Raises ValueError for a page without the two marks.
    """
    start = f"<!-- {name}: begin (generated) -->"
    end = f"<!-- {name}: end -->"
    head, first, rest = page.partition(start)
    _, last, tail = rest.partition(end)
    if not first or not last:
        raise ValueError(f"the page lacks {start!r} or {end!r}")
    return f"{head}{start}\n\n{text.strip()}\n\n{end}{tail}"


def summary_of(table: str) -> str:
    """Line with the number of reproduced claims, from a table.md.

    Raises ValueError for a table without claims.
    """
    _, heading, rest = table.partition(CLAIMS)
    if not heading:
        raise ValueError("the table has no claims")
    return rest.partition("\n")[0]


def write_documents(table: Path, results: Path, readme: Path) -> None:
    """Renew the page of results, and the count of claims in the README."""
    text = table.read_text(encoding="utf-8")
    for page, part in ((results, text), (readme, summary_of(text))):
        old = page.read_text(encoding="utf-8")
        write_whole(page, renewed(old, "results", part))


if __name__ == "__main__":
    write_documents(*map(Path, sys.argv[1:4]))
