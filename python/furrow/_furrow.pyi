"""The compiled part of furrow. Use the names in ``furrow`` instead."""

import os
from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Collocation",
    "Drawing",
    "GrownTree",
    "Inputs",
    "Memo",
    "__version__",
    "boundary",
    "branch",
    "cache",
    "calibrate",
    "canonical_name",
    "checks",
    "compare_contours",
    "compare_counts",
    "compare_dose",
    "compare_lifetimes",
    "compare_volumes",
    "critical_radius",
    "divide",
    "draw_division",
    "ensemble",
    "explore",
    "export_observed",
    "film",
    "fit_activity",
    "fit_clock",
    "fit_constants",
    "fit_cue",
    "front",
    "grow",
    "grow_by",
    "grow_spread",
    "merge",
    "new_lineage",
    "parameter_names",
    "perturb",
    "phase",
    "pitchfork",
    "polarity",
    "presets",
    "ranges",
    "read_tree",
    "reproduce",
    "scenarios_files",
    "solve",
    "solve_bvp",
    "solver_version",
    "steady",
    "steady_surface",
    "surfaces",
    "sweep",
    "test",
    "tree_schema",
    "write_movie",
    "write_shapes",
    "write_text",
]

__version__: str
solver_version: int

_Search = tuple[int, int, int]
#: Defect, condition and error of a solution.
_Quality = tuple[float, float, float | None]
_Labelled = tuple[str, str | None]
_Names = tuple[str, str, str, str | None]
_Drawn = tuple[dict[str, Any], "Drawing", list[str]]
_Told = Callable[[int, int], object] | None
#: Parameters, the preset, the configuration file and the law.
_Given = tuple[Mapping[str, Any], str, str | None, str | None]
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
    def replaced(self, parameters: dict[str, Any], cue: str | None = None, law: str | None = None) -> Inputs: ...
    def parameters(self) -> dict[str, Any]: ...
    @property
    def law(self) -> str | None: ...
    @property
    def shell_profile(self) -> str | None: ...
    @property
    def cue(self) -> str: ...
    def resolved_cue(self) -> str | None: ...
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
    def founders(self) -> list[dict[str, Any]]: ...
    def table(self) -> str: ...
    def ended(self) -> dict[str, int]: ...
    def colours(self) -> list[tuple[str, str]]: ...
    def newick(self) -> str: ...
    def svg(self, axis: str = "generations") -> str: ...
    def alive(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None: ...
    def html(self) -> str: ...
    def export(self, format: str, lengths: str | None, subtree: str | None) -> list[tuple[str, Any]]: ...
    def write_export(self, format: str, lengths: str | None, subtree: str | None, path: str) -> None: ...
    def cells(self) -> dict[str, Any]: ...

@final
class Drawing:
    """A picture, as the command line draws it. Notebooks show it."""

    def svg(self) -> str: ...
    def png(self) -> bytes: ...
    def pdf(self) -> bytes: ...
    def save(self, path: str | os.PathLike[str]) -> None: ...
    def _repr_svg_(self) -> str: ...

@final
class Collocation:
    def at(self, x: NDArray[np.float64], slope: bool) -> NDArray[np.float64]: ...

def solve_bvp(
    functions: tuple[Callable[..., Any], Callable[..., Any]],
    jacobians: tuple[Callable[..., Any] | None, Callable[..., Any] | None],
    mesh: NDArray[np.float64],
    guess: NDArray[np.float64],
    p: NDArray[np.float64] | None,
    singular: tuple[NDArray[np.float64], NDArray[np.float64]] | None,
    known: list[Collocation],
    tolerances: tuple[float, float | None],
    max_intervals: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], Collocation, _Quality, NDArray[np.float64], int]: ...
def parameter_names() -> list[tuple[str, str]]: ...
def canonical_name(name: str) -> str: ...
def presets() -> list[str]: ...
def divide(inputs: Inputs, memo: Memo, seed: int, count: int, threads: int, progress: _Told = None) -> Any: ...
def checks(inputs: Inputs, memo: Memo, seed: int, threads: int) -> dict[str, Any]: ...

#: The half axes of a shell along x, y and z, and its section as r and z from pole to pole.
_Wall = tuple[list[float], list[list[float]]]

def film(
    inputs: Inputs, seed: int, every: float | None = None, places: int | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]], NDArray[np.int64], dict[str, NDArray[np.float64]], _Wall]: ...
def steady(inputs: Inputs, azimuthal: int | None = None) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]: ...
def surfaces(
    inputs: Inputs, memo: Memo, seed: int, every: float | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]], _Wall]: ...
def steady_surface(inputs: Inputs) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]: ...
def pitchfork(inputs: Inputs, xi_max: float) -> dict[str, Any]: ...
def branch(
    inputs: Inputs, xi_max: float, max_step: float, azimuthal: int | None = None, reduced_volume: float | None = None
) -> tuple[dict[str, Any], dict[str, dict[str, NDArray[np.float64]]]]: ...
def grow(
    lineages: list[tuple[str, str | None]],
    cues: list[str],
    given: _Given,
    memo: Memo,
    seed: int,
    dynamics: bool,
    threads: int,
    progress: _Told = None,
) -> tuple[list[tuple[_Names, GrownTree, list[str]]], dict[str, Any]]: ...
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
) -> dict[str, Any]: ...
def read_tree(file: str) -> GrownTree: ...
def sweep(
    asked: Mapping[str, Any],
    given: _Given,
    memo: Memo,
    out: str | None,
    shard: tuple[int, int] | None,
    threads: int,
    progress: _Told = None,
) -> tuple[dict[str, Any], list[tuple[int, str]], str, tuple[int, int], list[str]]: ...
def calibrate(source: _Source, unknowns: list[str] | None, given: _Given) -> dict[str, Any]: ...
def ensemble(
    source: _Source, unknowns: list[str] | None, count: int, seed: int, given: _Given, threads: int
) -> dict[str, Any]: ...
def ranges(
    lineage: tuple[str, str | None],
    cues: list[str],
    source: _Source,
    given: _Given,
    memo: Memo,
    seed: int,
    threads: int,
) -> tuple[dict[str, Any], Drawing]: ...
def export_observed(asked: Mapping[str, Any], path: str | None) -> list[tuple[str, Any]]: ...
def compare_counts(tree: GrownTree, measured: str | None, matching: tuple[_Source, list[str]]) -> dict[str, Any]: ...
def compare_volumes(
    asked: Mapping[str, Any],
    given: _Given,
    memo: Memo,
    threads: int,
    progress: _Told = None,
) -> dict[str, Any]: ...
def compare_lifetimes(tree: GrownTree, asked: Mapping[str, Any]) -> dict[str, Any]: ...
def fit_clock(asked: Mapping[str, Any], lineage: str | None) -> tuple[dict[str, Any], Drawing]: ...
def compare_dose(
    table: _Source,
    bins: list[float] | None,
    cue: str,
    lineage: str | None,
    given: _Given,
    memo: Memo,
    threads: int,
    progress: _Told = None,
) -> dict[str, Any]: ...
def compare_contours(
    measured: list[NDArray[np.float64]], model: list[tuple[float, NDArray[np.float64]]], length: float | None
) -> dict[str, Any]: ...
def boundary(
    inputs: Inputs, vary: str, range: list[float], folds: bool, critical: bool, azimuthal: int | None = None
) -> _Drawn: ...
def phase(
    inputs: Inputs,
    memo: Memo,
    seed: int,
    vary: str,
    axes: list[tuple[float, float, int]],
    azimuthal: int,
    threads: int,
    progress: _Told = None,
) -> _Drawn: ...
def critical_radius(inputs: Inputs) -> dict[str, Any]: ...
def perturb(
    inputs: Inputs, seed: int, count: int, until: float, threads: int
) -> tuple[list[dict[str, Any]], Drawing, list[str]]: ...
def polarity(
    given: _Given,
    lineage: str | None,
    one: bool,
    par: Mapping[str, Any],
    length_um: float | None,
    profile: str,
    amplitude: float,
) -> tuple[dict[str, Any], list[tuple[str, list[list[float]]]]]: ...
def draw_division(inputs: Inputs, memo: Memo, seed: int) -> Drawing: ...
def write_movie(inputs: Inputs, memo: Memo, seed: int, path: str, frames: int | None = None, progress: _Told = None) -> None: ...
def write_shapes(inputs: Inputs, memo: Memo, seed: int, folder: str, every: float | None = None) -> None: ...
def fit_constants(
    source: _Source,
    lineage: str | None,
    given: _Given,
    memo: Memo,
    search: _Search,
    threads: int,
    progress: _Told = None,
) -> tuple[dict[str, Any], Drawing, str]: ...
def fit_activity(
    lineage: str | None,
    given: _Given,
    memo: Memo,
    rounds: str,
    range: list[float],
    threads: int,
    progress: _Told = None,
) -> tuple[dict[str, Any], Drawing]: ...
def fit_cue(
    cue: str,
    source: _Source,
    lineage: str | None,
    given: _Given,
    memo: Memo,
    search: _Search,
    threads: int,
    progress: _Told = None,
) -> tuple[dict[str, Any], Drawing]: ...
def test(
    asked: Mapping[str, Any], given: _Given, memo: Memo, threads: int, progress: _Told = None
) -> tuple[dict[str, Any], Drawing, tuple[list[list[list[float]]], str]]: ...
def front(source: _Source, unknowns: list[str] | None, count: int, seed: int, given: _Given, threads: int) -> dict[str, Any]: ...
def grow_spread(
    lineage: _Labelled,
    cues: list[str],
    given: _Given,
    memo: Memo,
    seed: int,
    count: int,
    dynamics: bool,
    threads: int,
    progress: _Told = None,
) -> tuple[GrownTree, dict[str, Any], Drawing, str, dict[str, Any], list[str]]: ...
def grow_by(
    name: str,
    first_r0: float,
    rule: Callable[..., Inputs | None],
    memo: Memo,
    seed: int,
    limits: tuple[int, int],
    threads: int,
    progress: _Told = None,
) -> tuple[GrownTree, dict[str, Any]]: ...
def scenarios_files(parts: list[tuple[_Names, GrownTree]]) -> tuple[str, str, str]: ...
def explore(lineage: _Labelled, given: _Given, memo: Memo, seed: int, path: str) -> int: ...
def new_lineage(path: str) -> None: ...
def write_text(path: str | os.PathLike[str], text: str) -> None: ...
def tree_schema() -> dict[str, Any]: ...
def cache(folder: str, action: str) -> dict[str, Any]: ...
def merge(parts: list[str], out: str) -> int: ...
def reproduce(
    figures: list[str],
    data: str | None,
    given: _Given,
    memo: Memo,
    threads: int,
    out: str | None,
    format: str,
    progress: _Told = None,
) -> tuple[dict[str, Any], str]: ...
