"""The default memo, shared by all calls."""

from __future__ import annotations

import os
import threading

from ._checks import optional_path, refused
from ._furrow import Memo


class _Shared:
    """The memo, once created."""

    lock = threading.Lock()
    memo: Memo | None = None


def _after_fork() -> None:
    """In the child of a fork: no thread is there that could hold the lock. Memos begin anew by themselves."""
    _Shared.lock = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def memo() -> Memo:
    """The memo of this process: all divisions that it has solved, and those of the store set by :func:`use_store`."""
    with _Shared.lock:
        if _Shared.memo is None:
            _Shared.memo = Memo()
        return _Shared.memo


def memo_of(given: Memo | None) -> Memo:
    """The memo that a call is given, or the shared one."""
    if given is None:
        return memo()
    if not isinstance(given, Memo):
        raise refused("memo", given, "a furrow.Memo, such as furrow.Memo('cache'), or None")
    return given


def use_store(folder: str | os.PathLike[str] | None, r0_step: float | None = None) -> Memo:
    """Stores divisions in a cache folder from now on, or with None only in memory. ``r0_step`` is the relative step to which R0
    is rounded before a division is looked up, from 0 to 0.5.

    Returns the memo that all calls share from now on. ``furrow --cache`` uses the same folder.
    """
    fresh = Memo(optional_path("store", folder), r0_step)
    with _Shared.lock:
        _Shared.memo = fresh
    return fresh
