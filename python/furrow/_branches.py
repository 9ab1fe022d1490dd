"""Results for one cell: stationary shapes, thresholds and branches."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._results import Array, Contour, Result
from ._tables import frame

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Cell
    from ._surfaces import Surface


@dataclass(frozen=True, eq=False)
class Steady(Result):
    """A stationary shape and its stability.

    ``cell``: The cell.
    ``L``: Contour length, in L_h.
    ``p``: Pressure, in κ0/L_h³.
    ``H``: Elongation (z(0) − z(1))/R0.
    ``r_eq``: Radius at the equator, in L_h.
    ``reduced_volume``: Volume divided by the volume of a sphere with the same area; NaN without axial symmetry.
    ``bending_energy``: ∫ ½κ(C − C0)² dA, in κ0; NaN without axial symmetry.
    ``stable``: Whether every disturbance decays.
    ``growth_rate``: Largest real part of the growth rates, in 1/τ.
    ``growth_rate_uncertainty``: How much it changes on halved intervals; infinite if the shape is not found on them, NaN without
        axial symmetry.
    ``growth_rates``: The rightmost ones, by decreasing real part.
    ``parities``: Whether each mode is ``even``, ``odd`` or ``mixed`` under u → 1 − u.
    ``folds_passed``: Activities of the folds passed on the branch before this shape.
    ``contour``: The shape, with the forces on it; a cell without axial symmetry has ``surface`` instead.
    ``regulator``: The regulator φ at u = 0.5, ``phi_mid``, and at u = 0, ``phi_pole``; None without a regulator.
    ``azimuthal``: Disturbances cos mφ, from ``m`` = 0 on: ``growth_rate``, and for m ≥ 1 the ``parity`` of the leading mode;
        for m = 1 also how much of it is a rigid shift or tilt, ``rigid``. None unless asked for.
    ``neck_offset``: Without axial symmetry: distance of the waist's centre from the axis, in L_h; None without a waist.
    ``modes``: Without axial symmetry: largest azimuthal number in use on the way to the shape.
    ``surface``: Without axial symmetry: the shape, with its mean active tension.

    Without axial symmetry growth rates are those of all azimuthal numbers up to the cell's ``modes``; ``L`` is the length of
    the mean meridian, ``r_eq`` the length over 2π of the ring at its middle; ``parities`` and ``folds_passed`` are empty.
    """

    cell: Cell = field(repr=False)
    L: float
    p: float
    H: float
    r_eq: float
    stable: bool
    growth_rate: float
    growth_rates: NDArray[np.complex128] = field(repr=False)
    parities: tuple[str, ...] = field(repr=False)
    folds_passed: tuple[float, ...]
    _contour: Contour | None = field(repr=False)
    regulator: Mapping[str, float] | None = None
    azimuthal: tuple[Mapping[str, Any], ...] | None = field(default=None, repr=False)
    neck_offset: float | None = None
    modes: int | None = None
    surface: Surface | None = field(default=None, repr=False)
    reduced_volume: float = math.nan
    bending_energy: float = math.nan
    growth_rate_uncertainty: float = math.nan

    @property
    def contour(self) -> Contour:
        """The shape, with the forces on it."""
        if self._contour is None:
            raise AttributeError("without axial symmetry a cell has no contour: surface is its shape")
        return self._contour

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists; growth rates as pairs of real and imaginary part."""
        plain = super().to_dict()
        plain["growth_rates"] = [[rate.real, rate.imag] for rate in self.growth_rates]
        plain["azimuthal"] = None if self.azimuthal is None else [dict(row) for row in self.azimuthal]
        contour = plain.pop("_contour")
        plain["contour"] = None if contour is None else {name: column.tolist() for name, column in contour.columns.items()}
        return plain


@dataclass(frozen=True)
class Pitchfork(Result):
    """The threshold at which the mirror-symmetric shape loses its symmetry.

    ``cell``: The cell.
    ``xi_s``: Threshold ξ_s*.
    ``criticality``: ``supercritical`` or ``subcritical``.
    ``coefficient``: c of ξ_s = ξ_s* + c (u_furrow − ½)² along the asymmetric branch.
    ``H``: Elongation.
    ``L``: Contour length, in L_h.
    ``p``: Pressure, in κ0/L_h³.
    ``residual``: Size of the last Newton correction.
    ``iterations``: Newton iterations.
    ``beyond_fold``: ξ_s of the first fold of the branch of the passive shape if it lies before the pitchfork; else None.
    """

    cell: Cell = field(repr=False)
    xi_s: float
    criticality: str
    coefficient: float
    H: float
    L: float
    p: float
    residual: float
    iterations: int
    beyond_fold: float | None = None


@dataclass(frozen=True)
class Event(Result):
    """A fold or a pitchfork of a branch.

    ``kind``: ``fold`` or ``pitchfork``.
    ``branch``: Name of the branch.
    ``xi_s``: Activity ξ_s.
    ``H``: Elongation.
    ``L``: Contour length, in L_h.
    ``error``: Estimated error of ``xi_s``, from intervals half as long; None if the point is not there on them.
    ``criticality``: For a pitchfork.
    ``coefficient``: For a pitchfork.
    ``maximum``: For a fold: whether ξ_s has a maximum there along the branch.
    """

    kind: str
    branch: str
    xi_s: float
    H: float
    L: float
    error: float | None = None
    criticality: str | None = None
    coefficient: float | None = None
    maximum: bool | None = None


@dataclass(frozen=True)
class Crossing(Result):
    """A shape of a branch where disturbances cos mφ begin or cease to grow.

    ``m``: The azimuthal number m.
    ``branch``: Name of the branch.
    ``xi_s``: Activity ξ_s.
    ``H``: Elongation.
    ``grows_beyond``: Whether they grow beyond it, along the branch.
    """

    m: int
    branch: str
    xi_s: float
    H: float
    grows_beyond: bool


@dataclass(frozen=True)
class HopfPoint(Result):
    """A shape of a branch where an oscillation begins or ceases to grow, and all other disturbances decay.

    ``branch``: Name of the branch.
    ``xi_s``: Activity ξ_s.
    ``H``: Elongation.
    ``period``: Period of the oscillation, in τ.
    ``grows_beyond``: Whether it grows beyond it, along the branch.
    """

    branch: str
    xi_s: float
    H: float
    period: float
    grows_beyond: bool


@dataclass(frozen=True, eq=False)
class Curve(Result):
    """A branch of stationary shapes, point by point.

    ``name``: ``symmetric``, ``cued``, ``asymmetric`` or ``bent``.
    ``xi_s``: Activity.
    ``H``: Elongation.
    ``L``: Contour length, in L_h.
    ``p``: Pressure, in κ0/L_h³.
    ``r_eq``: Radius at the equator, in L_h.
    ``growth_rate``: Largest growth rate, in 1/τ; NaN if not found.
    ``delta_u``: Furrow position u_furrow − ½; NaN for shapes without a furrow.
    ``reduced_volume``: Volume divided by the volume of a sphere with the same area; NaN of ``bent`` shapes.
    ``bending_energy``: ∫ ½κ(C − C0)² dA, in κ0; NaN of ``bent`` shapes.
    ``ended``: Why the continuation stopped.
    ``azimuthal``: Growth rates of disturbances cos mφ, in 1/τ: one row per shape, column k for m = k + 1; NaN if not found.
        None unless asked for.
    """

    name: str
    xi_s: Array = field(repr=False)
    H: Array = field(repr=False)
    L: Array = field(repr=False)
    p: Array = field(repr=False)
    r_eq: Array = field(repr=False)
    growth_rate: Array = field(repr=False)
    delta_u: Array = field(repr=False)
    reduced_volume: Array = field(repr=False)
    bending_energy: Array = field(repr=False)
    ended: str
    azimuthal: Array | None = field(default=None, repr=False)

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether each shape is stable; False if its growth rate was not found."""
        return self.growth_rate < 0.0

    def __len__(self) -> int:
        return len(self.xi_s)

    def to_pandas(self) -> pd.DataFrame:
        """One row per shape."""
        names = ("xi_s", "H", "L", "p", "r_eq", "growth_rate", "delta_u", "reduced_volume", "bending_energy")
        columns: dict[str, Any] = {name: getattr(self, name) for name in names}
        modes = () if self.azimuthal is None else self.azimuthal.T
        rates = {f"growth_rate_m{m}": rate for m, rate in enumerate(modes, 1)}
        return frame({"branch": [self.name] * len(self), **columns, "stable": self.stable, **rates})

    def __repr__(self) -> str:
        return f"<Curve {self.name}: {len(self)} shapes, ξ_s from {self.xi_s.min():.4g} to {self.xi_s.max():.4g}>"


@dataclass(frozen=True, eq=False)
class Branch(Result):
    """The stationary shapes of a cell over ξ_s: ``branch["symmetric"]``, ``branch["asymmetric"]`` and their folds and
    pitchforks.

    ``cell``: The cell.
    ``curves``: The branches.
    ``events``: Their folds and pitchforks.
    ``exponent``: Exponent in |Δu| = prefactor |ξ_s − ξ_s*|^exponent near the pitchfork.
    ``prefactor``: Its prefactor.
    ``crossings``: Where growth rates of disturbances cos mφ change sign; None unless asked for.
    ``hopf``: Where shapes begin or cease to oscillate.
    ``warnings``: What could not be computed.
    ``bent``: Without axial symmetry, where the ``bent`` curve begins, its odd pitchfork and its fold, with the keys of
        ``furrow branch --json``; None if bent states were not followed.
    """

    cell: Cell = field(repr=False)
    curves: tuple[Curve, ...]
    events: tuple[Event, ...]
    exponent: float | None = None
    prefactor: float | None = None
    crossings: tuple[Crossing, ...] | None = None
    warnings: tuple[str, ...] = ()
    bent: dict[str, Any] | None = field(default=None, repr=False)
    hopf: tuple[HopfPoint, ...] = ()

    def __getitem__(self, name: str) -> Curve:
        for curve in self.curves:
            if curve.name == name:
                return curve
        raise KeyError(name)

    @property
    def pitchforks(self) -> tuple[Event, ...]:
        """Its pitchforks."""
        return tuple(event for event in self.events if event.kind == "pitchfork")

    @property
    def folds(self) -> tuple[Event, ...]:
        """Its folds."""
        return tuple(event for event in self.events if event.kind == "fold")

    def to_pandas(self) -> pd.DataFrame:
        """One row per shape of any branch."""
        import pandas as pd

        return pd.concat([curve.to_pandas() for curve in self.curves], ignore_index=True)

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """The branches, stable and unstable; needs matplotlib. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.branch(self), path)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [(curve.name, f"{len(curve)} shapes, {curve.ended}") for curve in self.curves]
        rows += [(event.kind, f"{event.branch}, ξ_s = {event.xi_s:.6g}") for event in self.events]
        rows += [("Hopf point", f"{point.branch}, ξ_s = {point.xi_s:.6g}, period {point.period:.6g} τ") for point in self.hopf]
        return rows + [(f"m = {c.m}", f"{c.branch}, ξ_s = {c.xi_s:.6g}") for c in self.crossings or ()]
