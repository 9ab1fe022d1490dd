"""Progress, as a tqdm bar if tqdm is installed."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import TypeAlias

#: None for a bar if tqdm is installed and the output is a terminal or notebook; False for no bar; True for a bar in any case; or
#: a function called with the numbers of finished and of all tasks.
Progress: TypeAlias = bool | Callable[[int, int], object] | None


@contextmanager
def shown(progress: Progress, unit: str) -> Iterator[Callable[[int, int], object] | None]:
    """The function that a run calls with its progress."""
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
            # In a notebook without widgets tqdm warns and draws a text bar, which is fine.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return None
    # `disable=None` draws no bar without a terminal. Runs of less than half a second need no bar.
    return tqdm(unit=f" {unit}", disable=None if progress is None else False, leave=False, delay=0.5)
