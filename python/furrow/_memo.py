"""The memo that calls share where they are not given another."""

from __future__ import annotations

import threading

from ._furrow import Memo

_lock = threading.Lock()
_shared: Memo | None = None


def memo() -> Memo:
    """The memo of this process: every division that it has solved, and those of a store if :func:`use_store` named one."""
    global _shared
    with _lock:
        if _shared is None:
            _shared = Memo()
        return _shared


def use_store(folder: str | None, r0_step: float | None = None) -> Memo:
    """Keeps divisions in a folder from now on, as the command line does in its cache, or with None in memory alone.

    Gives the memo that all calls share from now on. The command line uses the same folder with ``--cache``.
    """
    from ._checks import path_of

    global _shared
    fresh = Memo(None if folder is None else path_of("store", folder), r0_step)
    with _lock:
        _shared = fresh
    return fresh
