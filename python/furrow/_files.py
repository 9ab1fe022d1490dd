"""The paper reproduced, the page that computes, and files to begin with."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex

from . import _furrow
from ._checks import given_of, optional_path, path_of, refused, seed_of, text_of, threads_of
from ._grow import _labelled
from ._memo import memo_of
from ._progress import Progress, shown
from ._tables import Found, frame

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Value
    from ._furrow import Memo


class Reproduction(Found):
    """The paper's statements beside what furrow computes: the output of ``furrow reproduce --json``."""

    def __init__(self, found: Mapping[str, Any], markdown: str) -> None:
        super().__init__(found)
        #: The table as Markdown.
        self.markdown = markdown

    def to_pandas(self) -> pd.DataFrame:
        """One row per statement."""
        names = ("figure", "quantity", "paper", "computed", "rel_error", "verdict", "note")
        return frame({name: [item.get(name) for item in self["items"]] for name in names})

    def _repr_markdown_(self) -> str:
        return self.markdown


def reproduce(
    *figures: str,
    data: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    format: str = "svg",
    table: str | os.PathLike[str] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Reproduction:
    """Recomputes figures, tables and movies of the paper, all without an argument, and says what agrees and what differs.

    ``data`` is a table of cell volumes for the measured rows. ``out`` is a folder for pictures, in the ``format`` ``svg``,
    ``pdf`` or ``png``, and tables; ``table`` a file for the Markdown. Keywords are parameters, over those of ``preset`` and
    ``config``; ``memo``, ``threads`` and ``progress`` are those of :meth:`Cell.divide`.

    >>> import furrow
    >>> found = furrow.reproduce("S3")
    >>> found["differs"]
    0
    """
    known = memo_of(memo)
    with shown(progress, "figures") as tell:
        found, markdown = _furrow.reproduce(
            [text_of("figures", figure) for figure in figures],
            optional_path("data", data),
            given_of(parameters, preset, config),
            known,
            threads_of(threads),
            optional_path("out", out),
            text_of("format", format),
            tell,
        )
    if table is not None:
        _furrow.write_text(path_of("table", table), markdown)
    return Reproduction(found, markdown)


def explore(
    path: str | os.PathLike[str] = "explore.html",
    *,
    lineage: str | os.PathLike[str] | None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    **parameters: Value,
) -> int:
    """Writes a web page that computes divisions in the browser, in one file that works offline. Returns its length in bytes.

    The page begins with the tree of ``lineage``, whose first cell has the radius ``r0``; other arguments are those of
    :func:`tree`."""
    known = memo_of(memo)
    given = given_of(parameters, preset, config, r0)
    return _furrow.explore(_labelled(lineage), given, known, seed_of(seed), path_of("path", path))


def new_lineage(path: str | os.PathLike[str]) -> None:
    """Writes a commented lineage file as a starting point; an existing file is not overwritten."""
    _furrow.new_lineage(path_of("path", path))


def tree_schema() -> dict[str, Any]:
    """The JSON Schema of ``tree.json``."""
    return _furrow.tree_schema()


def merge(parts: Sequence[str | os.PathLike[str]], *, out: str | os.PathLike[str]) -> int:
    """Merges the folders of a sweep's parts, written by ``furrow.sweep(shard=(k, n), out=…)``, into the files of the whole
    sweep, or the tables (``.csv``) of the parts of a sample, written by ``Hypotheses.save_samples`` after
    ``furrow.test(shard=(k, n))``, into one with weights. Returns the number of points."""
    if isinstance(parts, (str, os.PathLike)):
        raise refused("parts", parts, "a list of folders or tables")
    return _furrow.merge([path_of("parts", part) for part in parts], path_of("out", out))
