"""Fits the model to measured embryos."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

from . import _furrow
from ._checks import given_of, optional_path, pair_of, seed_of, text_of, text_or_path, threads_of, whole
from ._memo import memo_of
from ._progress import Progress, shown
from ._shapes import Drawn
from ._tables import OfEmbryos, Table, frame, times_of

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Value
    from ._furrow import Drawing, Memo


class Constants(Drawn):
    """Fitted constants: the output of ``furrow fit constants --json``."""

    def __init__(self, found: Mapping[str, Any], drawing: Drawing, ron: str) -> None:
        super().__init__(found, drawing)
        #: The constants as a configuration file, for ``config=``.
        self.ron = ron

    def to_pandas(self) -> pd.DataFrame:
        """One row per number of the model beside the observed one."""
        names = ("founder", "quantity", "observed", "computed")
        return frame({name: [row[name] for row in self["residuals"]] for name in names})


class Activities(Drawn):
    """Activities by founder: the output of ``furrow fit activity --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per founder."""
        names = ("name", "observed", "rounds", "run_xi_s", "xi_s")
        return frame({name: [row.get(name) for row in self["founders"]] for name in names})


class Cue(Drawn):
    """A fitted cue: the output of ``furrow fit cue --json``."""

    @property
    def cue(self) -> str:
        """The cue, for :class:`furrow.Cell` and :func:`furrow.tree`."""
        cue: str = self["cue"]
        return cue

    def to_pandas(self) -> pd.DataFrame:
        """One row per division that was fitted."""
        names = ("cell", "r0", "measured", "sd", "computed", "residual")
        return frame({name: [row[name] for row in self["residuals"]] for name in names})


def _targets(targets: str | os.PathLike[str] | None) -> tuple[str | None, str | None]:
    return (None, None) if targets is None else text_or_path("targets", targets, "Fit")


def _search(particles: SupportsIndex, moves: SupportsIndex, seed: SupportsIndex) -> tuple[int, int, int]:
    return whole("particles", particles, 2, 10_000), whole("moves", moves, 1, 100_000), seed_of(seed)


def constants(
    targets: str | os.PathLike[str] | None = None,
    *,
    lineage: str | os.PathLike[str] | None = None,
    particles: SupportsIndex = 24,
    moves: SupportsIndex = 20,
    seed: SupportsIndex = 0,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Constants:
    """Fits one set of constants to the observed rounds and terminal cells of founders and the measured χ of the germline, with
    the Pareto front between this fit and the published thresholds.

    ``targets`` is a file of observations or its text; default the built-in ones. A swarm of ``particles`` makes so many
    ``moves``, from ``seed`` on. ``lineage`` has the founders. Keywords are parameters at which the search starts, over those of
    ``preset`` and ``config``; ``memo``, ``threads`` and ``progress`` are those of :meth:`furrow.Cell.divide`.
    """
    known = memo_of(memo)
    with shown(progress, "sets of constants") as tell:
        found, drawing, ron = _furrow.fit_constants(
            _targets(targets),
            optional_path("lineage", lineage),
            given_of(parameters, preset, config),
            known,
            _search(particles, moves, seed),
            threads_of(threads),
            tell,
        )
    return Constants(found, drawing, ron)


def activity(
    *,
    rounds: Literal["min", "mean", "max"] = "mean",
    range: tuple[SupportsFloat, SupportsFloat] = (4.0, 100.0),
    lineage: str | os.PathLike[str] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Activities:
    """Finds for each founder by itself the activity, in a ``range`` of ξ_s, that gives its observed ``rounds``. Other arguments
    are those of :func:`constants`."""
    known = memo_of(memo)
    ends = list(pair_of("range", range))
    with shown(progress, "trees") as tell:
        found, drawing = _furrow.fit_activity(
            optional_path("lineage", lineage),
            given_of(parameters, preset, config),
            known,
            text_of("rounds", rounds),
            ends,
            threads_of(threads),
            tell,
        )
    return Activities(found, drawing)


def cue(
    cue: str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1",
    *,
    targets: str | os.PathLike[str] | None = None,
    lineage: str | os.PathLike[str] | None = None,
    particles: SupportsIndex = 24,
    moves: SupportsIndex = 20,
    seed: SupportsIndex = 0,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Cue:
    """Fits the numbers of a ``cue``, whose terms are kept, to the measured χ of the germline, and says which combinations of them
    stay undetermined. Other arguments are those of :func:`constants`."""
    known = memo_of(memo)
    with shown(progress, "cues") as tell:
        found, drawing = _furrow.fit_cue(
            text_of("cue", cue),
            _targets(targets),
            optional_path("lineage", lineage),
            given_of(parameters, preset, config),
            known,
            _search(particles, moves, seed),
            threads_of(threads),
            tell,
        )
    return Cue(found, drawing)


class Clock(Drawn):
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
    frame_minutes: OfEmbryos | None = None,
    common_pace: bool = False,
    common_size: bool = False,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
) -> Clock:
    """Fits the lifetimes of cells as powers of their volumes, by founder: t = t₀ (V/V₀)^−α.

    ``table`` has the columns ``cell`` and ``lifetime_min``, as for :func:`furrow.compare.lifetimes`, and ``volumes`` those of
    :func:`furrow.compare.volumes`; default are published means of C. elegans. ``lineage`` has the founders. Other arguments are
    those of :func:`furrow.compare.lifetimes`.

    >>> import furrow
    >>> found = furrow.fit.clock()
    >>> [(law["founder"], round(law["exponent"], 2)) for law in found["exponents"]][:2]
    [('AB', 0.3), ('MS', 0.26)]
    """
    asked = times_of(table, volumes, frame_minutes, common_pace, common_size, names, root)
    return Clock(*_furrow.fit_clock(asked, optional_path("lineage", lineage)))
