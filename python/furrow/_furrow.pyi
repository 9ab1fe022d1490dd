"""The compiled part of furrow. Use the names in ``furrow`` instead."""

import os
from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "GrownTree",
    "Inputs",
    "Memo",
    "__version__",
    "branch",
    "calibrate",
    "compare_contours",
    "compare_counts",
    "compare_dose",
    "compare_lifetimes",
    "compare_volumes",
    "divide",
    "ensemble",
    "film",
    "fit_clock",
    "grow",
    "parameter_names",
    "pitchfork",
    "presets",
    "ranges",
    "read_tree",
    "solve",
    "solver_version",
    "steady",
    "sweep",
]

__version__: str
solver_version: int

_Told = Callable[[int, int], object] | None
#: Parameters, the preset and the configuration file.
_Given = tuple[Mapping[str, Any], str, str | None]
#: A text, or its file.
_Source = tuple[str | None, str | None]
#: Files, and a table as text.
_Tables = tuple[list[str], str | None]

@final
class Inputs:
    def __new__(
        cls,
        given: _Given,
        cue: str = "none",
        lineage: str | None = None,
    ) -> Inputs: ...
    def parameters(self) -> str: ...
    @property
    def cue(self) -> str: ...
    def cue_at(self, u: NDArray[np.float64], length: float) -> list[tuple[str, NDArray[np.float64]]]: ...
    def mirrored(self) -> Inputs: ...
    def is_mirror_symmetric(self) -> bool: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> Inputs: ...

@final
class Memo:
    """Solved divisions. With a store, which is a cache folder, they persist and are shared with other processes, including the
    command line."""

    def __new__(cls, store: str | os.PathLike[str] | None = None, r0_step: float | None = None) -> Memo: ...
    def __len__(self) -> int: ...
    def __bool__(self) -> bool: ...
    @property
    def store(self) -> os.PathLike[str] | None: ...
    @property
    def r0_step(self) -> float: ...

@final
class GrownTree:
    def __len__(self) -> int: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str) -> GrownTree: ...
    @property
    def organism(self) -> str: ...
    def founders(self) -> str: ...
    def table(self) -> str: ...
    def ended(self) -> str: ...
    def colours(self) -> list[tuple[str, str]]: ...
    def newick(self) -> str: ...
    def svg(self, axis: str = "generations") -> str: ...
    def alive(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None: ...
    def html(self) -> str: ...
    def export(self, format: str, lengths: str) -> list[tuple[str, Any]]: ...
    def write_export(self, format: str, lengths: str, path: str) -> None: ...
    def cells(self) -> dict[str, Any]: ...

def parameter_names() -> list[tuple[str, str]]: ...
def presets() -> list[str]: ...
def divide(inputs: Inputs, memo: Memo, seed: int, count: int, threads: int, progress: _Told = None) -> str: ...
def film(
    inputs: Inputs, seed: int, every: float | None = None, places: int | None = None
) -> tuple[str, dict[str, NDArray[np.float64]], NDArray[np.int64], dict[str, NDArray[np.float64]], list[float]]: ...
def steady(inputs: Inputs, azimuthal: int | None = None) -> tuple[str, dict[str, NDArray[np.float64]]]: ...
def pitchfork(inputs: Inputs, xi_max: float) -> str: ...
def branch(inputs: Inputs, xi_max: float, max_step: float) -> tuple[str, dict[str, dict[str, NDArray[np.float64]]]]: ...
def grow(
    lineages: list[tuple[str, str | None]],
    cues: list[str],
    given: _Given,
    memo: Memo,
    seed: int,
    dynamics: bool,
    threads: int,
    progress: _Told = None,
) -> tuple[list[tuple[str, str, str | None, GrownTree]], str]: ...
def solve(
    inputs: Inputs,
    memo: Memo,
    seed: int,
    unknown: str,
    wanted: tuple[str, float],
    range: list[float] | None,
    points: int,
    threads: int,
    progress: _Told = None,
) -> str: ...
def read_tree(file: str) -> GrownTree: ...
def sweep(
    source: _Source,
    given: _Given,
    memo: Memo,
    out: str | None,
    threads: int,
    progress: _Told = None,
) -> tuple[dict[str, Any], list[tuple[int, str]], str, tuple[int, int]]: ...
def calibrate(source: _Source, given: _Given) -> str: ...
def ensemble(source: _Source, count: int, seed: int, given: _Given, threads: int) -> str: ...
def ranges(
    lineage: tuple[str, str | None],
    cues: list[str],
    source: _Source,
    given: _Given,
    memo: Memo,
    seed: int,
    threads: int,
) -> str: ...
def compare_counts(tree: GrownTree, measured: str | None = None) -> str: ...
def compare_volumes(
    asked: Mapping[str, Any],
    given: _Given,
    memo: Memo,
    threads: int,
    progress: _Told = None,
) -> str: ...
def compare_lifetimes(tree: GrownTree, table: _Source, volumes: _Tables, frame_minutes: float | None) -> str: ...
def fit_clock(table: _Source, volumes: _Tables, lineage: str | None, frame_minutes: float | None) -> str: ...
def compare_dose(
    table: _Source,
    bins: list[float] | None,
    cue: str,
    lineage: str | None,
    given: _Given,
    memo: Memo,
    threads: int,
    progress: _Told = None,
) -> str: ...
def compare_contours(
    measured: list[NDArray[np.float64]], model: list[tuple[float, NDArray[np.float64]]], length: float | None
) -> str: ...
