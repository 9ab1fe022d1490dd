"""Inspects, verifies and clears a cache folder of solved divisions.

>>> import furrow, tempfile
>>> with tempfile.TemporaryDirectory() as folder:
...     _ = furrow.Cell(2.5).divide(memo=furrow.Memo(folder))
...     furrow.cache.stat(folder)["entries"]
1
"""

from __future__ import annotations

import os
from typing import Any

from . import _furrow
from ._checks import bool_of, path_of


def stat(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """Counts ``entries``, those of ``other_versions``, ``bytes`` and ``corrupt`` entries."""
    return _furrow.cache(path_of("folder", folder), "verify")


def verify(folder: str | os.PathLike[str], *, repair: bool = False) -> dict[str, Any]:
    """Checks every entry and lists the ``damaged`` ones; ``repair`` removes them."""
    return _furrow.cache(path_of("folder", folder), "repair" if bool_of("repair", repair) else "verify")


def clear(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """Removes all entries, of every version, and says what there was."""
    return _furrow.cache(path_of("folder", folder), "clear")
