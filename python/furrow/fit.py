"""Fits the model to measured embryos."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, SupportsFloat

from . import _furrow
from ._checks import path_of
from ._tables import Found, Table, frame, positive, source_of, tables_of

if TYPE_CHECKING:
    import pandas as pd


class Clock(Found):
    """A fitted clock: the output of ``furrow fit clock --json``."""

    @property
    def ron(self) -> str:
        """The clock as a lineage file, for :func:`furrow.tree`."""
        ron: str = self["ron"]
        return ron

    def to_pandas(self) -> pd.DataFrame:
        """One row per founder, and one for ``all`` cells."""
        rows = [*self["exponents"], self["all"]]
        return frame({name: [row[name] for row in rows] for name in rows[0]})


def clock(
    table: Table | None = None,
    *,
    volumes: Table | None = None,
    lineage: str | os.PathLike[str] | None = None,
    frame_minutes: SupportsFloat | None = None,
) -> Clock:
    """Fits the lifetimes of cells as powers of their volumes, by founder: t = t₀ (V/V₀)^−α.

    ``table`` has the columns ``cell`` and ``lifetime_min``, as for :func:`furrow.compare.lifetimes`, and ``volumes`` those of
    :func:`furrow.compare.volumes`; default are published means of C. elegans. ``lineage`` has the founders.

    >>> import furrow
    >>> found = furrow.fit.clock()
    >>> [(law["founder"], round(law["exponent"], 2)) for law in found["exponents"]][:2]
    [('AB', 0.3), ('MS', 0.26)]
    """
    found = _furrow.fit_clock(
        source_of(table),
        tables_of(volumes),
        None if lineage is None else path_of("lineage", lineage),
        None if frame_minutes is None else positive("frame_minutes", frame_minutes),
    )
    return Clock(json.loads(found))
