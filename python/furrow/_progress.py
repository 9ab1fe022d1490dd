"""How far a run is, as a bar of tqdm where that is installed."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import TypeAlias

#: None for a bar where tqdm is installed and the output is for a person, False for none, True for one in any case, or a function
#: that is told how many are done and how many there are.
Progress: TypeAlias = bool | Callable[[int, int], object] | None


@contextmanager
def shown(progress: Progress, unit: str) -> Iterator[Callable[[int, int], object] | None]:
    """What a run tells where it is."""
    if progress is False:
        yield None
        return
    if callable(progress):
        yield progress
        return
    bar = _bar(progress, unit)
    if bar is None:
        yield None
        return

    def tell(done: int, of: int) -> None:
        if of > 0:
            bar.total = of
            bar.update(done - bar.n)

    try:
        yield tell
    finally:
        bar.close()


def _bar(progress: bool | None, unit: str) -> Any:
    try:
        with warnings.catch_warnings():
            # In a notebook without its widgets the bar is one of text, which is nothing to warn of.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return None
    # With None it is quiet where nobody looks at a terminal. A run of less than half a second needs no bar.
    return tqdm(unit=f" {unit}", disable=None if progress is None else False, leave=False, delay=0.5)
