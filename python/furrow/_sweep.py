"""Sweeps: divisions, trees, thresholds or critical radii over axes of parameters."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np

from . import _furrow
from ._checks import given_of, optional_path, path_of, refused, seed_of, shard_of, text_of, threads_of, whole
from ._memo import memo_of
from ._progress import Progress, shown
from ._tables import frame

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Value
    from ._furrow import Memo


class Sweep(Mapping[str, Any]):
    """The table of a sweep: columns by name, first those of the axes. Numbers are arrays with NaN for missing values;
    strings are lists."""

    def __init__(
        self,
        columns: Mapping[str, Any],
        undecided: Mapping[int, str],
        csv: str,
        work: tuple[int, int],
        warnings: Sequence[str] = (),
    ) -> None:
        self._columns = dict(columns)
        #: Why points are undecided, by row number.
        self.undecided = dict(undecided)
        #: The table, byte-identical to ``results.csv`` of ``furrow sweep``.
        self.csv = csv
        #: Divisions or shapes solved.
        self.solved = work[0]
        #: Divisions or shapes reused from the memo or another point.
        self.reused = work[1]
        #: Warnings of the run, such as a cache that cannot be written or divisions with a second neck, and doubts about its
        #: input.
        self.warnings = tuple(warnings)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Any:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def points(self) -> int:
        """The number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def to_dict(self) -> dict[str, list[Any]]:
        """Columns as plain lists."""
        return {name: list(np.asarray(column, dtype=object)) for name, column in self.items()}

    def to_pandas(self) -> pd.DataFrame:
        """One row per point."""
        return frame(self)

    def __repr__(self) -> str:
        return f"<furrow.Sweep of {self.points} points: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        from html import escape

        most = 20
        head = "".join(f"<th>{escape(name)}</th>" for name in self)
        rows = ["".join(f"<td>{escape(_cell(self[name][k]))}</td>" for name in self) for k in range(min(most, self.points))]
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        more = f"<p>and {self.points - most} further points</p>" if self.points > most else ""
        return f"<table><tr>{head}</tr>{body}</table>{more}"


def _cell(value: object) -> str:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _value(value: object) -> float | str:
    """A value of an axis."""
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return path_of("axes", value)
    if isinstance(value, (bool, np.bool_)):
        raise refused("axes", value, "numbers or words")
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise refused("axes", value, "numbers or words") from None
    if not np.isfinite(number):
        raise refused("axes", value, "finite numbers or words")
    return number


def _axes(axes: Mapping[str, Iterable[Any]]) -> list[tuple[str, list[float | str]]]:
    if not isinstance(axes, Mapping):
        raise refused("axes", axes, "names of parameters with their values, as {'r0': [1.6, 2.0]}")
    return [(text_of("axes", name), [_value(value) for value in _listed(name, values)]) for name, values in axes.items()]


def _listed(name: str, values: Any) -> list[Any]:
    """The values of an axis."""
    try:
        if not isinstance(values, (str, bytes, Mapping)):
            return list(values)
    except TypeError:
        # A number, also one of numpy, which says that it could be listed.
        pass
    raise refused(f"axes[{name!r}]", values, "a list of values")


def _check_apart(axes: list[tuple[str, list[float | str]]], cue: str | None, parameters: Mapping[str, Any]) -> None:
    """Refuses parameters that the axes vary, by whatever name."""
    varied = {_furrow.canonical_name(name): name for name, _ in axes}
    given = {**parameters, **({} if cue is None else {"cue": cue})}
    for name, value in given.items():
        axis = varied.get(_furrow.canonical_name(name))
        if axis is not None:
            raise refused(name, value, f"left out: the axis {axis!r} has its values")


def sweep(
    file: str | os.PathLike[str] | None = None,
    *,
    axes: Mapping[str, Iterable[Any]] | None = None,
    kind: str = "division",
    cue: str | None = None,
    replicates: SupportsIndex = 1,
    seed: SupportsIndex = 0,
    lineage: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    shard: tuple[SupportsIndex, SupportsIndex] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Sweep:
    """Computes many points over axes of parameters, equal inputs once, on all cores.

    Give either ``file``, a sweep file, or ``axes``, a mapping of parameters to values, the first varying slowest. Names
    are those of ``furrow --set``, ``cue``, or ``cue.amplitude``, ``regulator.turnover`` and the like. ``kind`` is
    ``division``, ``tree``, ``pitchfork`` or ``critical``. With ``out`` the files of ``furrow sweep`` are written to that folder.
    ``shard=(k, n)`` solves part k of n, which :func:`merge` puts together.

    Divisions with the ``cue``, and keywords as parameters that no axis varies, have ``replicates`` consecutive seeds from
    ``seed`` on. ``lineage`` has the founders of trees and names of cues. ``preset``, ``config`` and ``law`` are those of
    :class:`Cell`, and ``memo``, ``threads`` and ``progress`` those of :meth:`Cell.divide`.

    >>> import furrow
    >>> sizes = furrow.sweep(axes={"r0": [1.5, 2.0, 2.5]})
    >>> sizes["outcome"]
    ['failed', 'asymmetric', 'symmetric']
    """
    known = memo_of(memo)
    if file is None:
        if axes is None:
            raise refused("axes", None, "given if there is no file")
    elif axes is not None or cue is not None or lineage is not None or replicates != 1 or seed != 0 or kind != "division":
        raise refused("file", file, "given without axes, kind, cue, replicates, seed and lineage, which it says itself")
    asked: dict[str, Any] = {
        "file": optional_path("file", file),
        "kind": text_of("kind", kind),
        "axes": [] if axes is None else _axes(axes),
        "cue": None if cue is None else text_of("cue", cue),
        "replicates": whole("replicates", replicates, 1, 1_000_000),
        "seed": seed_of(seed),
        "lineage": optional_path("lineage", lineage),
    }
    given = given_of(parameters, preset, config, law=law)
    folder = optional_path("out", out)
    part = shard_of(shard)
    _check_apart(asked["axes"], cue, parameters)
    with shown(progress, "points") as tell:
        columns, why, csv, work, said = _furrow.sweep(asked, given, known, folder, part, threads_of(threads), tell)
    return Sweep(columns, dict(why), csv, work, said)
