"""The memo that calls share where they are not given another."""

from __future__ import annotations

import threading

from ._furrow import Memo


class _Shared:
    """The memo, once there is one."""

    lock = threading.Lock()
    memo: Memo | None = None


def memo() -> Memo:
    """The memo of this process: every division that it has solved, and those of a store if :func:`use_store` named one."""
    with _Shared.lock:
        if _Shared.memo is None:
            _Shared.memo = Memo()
        return _Shared.memo


def use_store(folder: str | None, r0_step: float | None = None) -> Memo:
    """Keeps divisions in a folder from now on, as the command line does in its cache, or with None in memory alone.

    Gives the memo that all calls share from now on. The command line uses the same folder with ``--cache``.
    """
    from ._checks import path_of

    fresh = Memo(None if folder is None else path_of("store", folder), r0_step)
    with _Shared.lock:
        _Shared.memo = fresh
    return fresh
