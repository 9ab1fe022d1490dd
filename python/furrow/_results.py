"""Results for one cell: divisions with their shapes, stationary shapes, thresholds."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from ._tables import frame, html_table, shown

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Cell

Array = NDArray[np.float64]

#: The columns of a contour, with their units.
PLACE_COLUMNS: Mapping[str, str] = {
    "u": "arclength fraction, 0 at the posterior pole",
    "r": "distance from the axis, L_h",
    "z": "position along the axis, L_h",
    "psi": "tangent angle ψ, from 0 to π",
    "c_uu": "meridional curvature c1, 1/L_h",
    "c_pp": "azimuthal curvature c2, 1/L_h",
    "t_uu": "meridional tension T_uu, active and viscous, κ0/L_h²",
    "t_pp": "azimuthal tension T_φφ, active and viscous, κ0/L_h²",
    "v": "tangential velocity towards larger u, L_h/τ",
    "v_n": "normal velocity outwards, L_h/τ",
    "active_t": "active force density along the contour, towards larger u, κ0/L_h³",
    "active_n": "active normal force, outwards as all that follow, κ0/L_h³",
    "viscous_n": "viscous normal force",
    "elastic_n": "elastic normal force: bending and passive tension",
    "pressure_n": "pressure",
    "shell_n": "force of the shell",
    "residual_n": "sum of the five, 0 for an exact solution",
}


@dataclass(frozen=True, eq=False)
class Contour:
    """A shape, point by point from pole to pole: ``contour["r"]`` and the other columns of :data:`PLACE_COLUMNS`.

    For a cell with a regulator there is also ``contour["phi"]``, the regulator φ.
    """

    columns: Mapping[str, Array] = field(repr=False)

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.columns["u"])

    @property
    def r(self) -> Array:
        """Distance from the axis, in L_h."""
        return self.columns["r"]

    @property
    def z(self) -> Array:
        """Position along the axis, in L_h."""
        return self.columns["z"]

    @property
    def points(self) -> Array:
        """(r, z) of every point."""
        return np.column_stack((self.r, self.z))

    def to_pandas(self) -> pd.DataFrame:
        """One row per point."""
        return frame(self.columns)

    def __repr__(self) -> str:
        return f"<Contour of {len(self)} places>"


@dataclass(frozen=True, eq=False)
class Frame:
    """A dividing cell at one time."""

    t: float  #: Time, in τ.
    length: float  #: Contour length L, in L_h.
    pressure: float  #: Pressure p, in κ0/L_h³.
    neck_radius: float | None  #: Radius of the neck, in L_h; None without a waist.
    neck_u: float | None  #: Arclength fraction of the neck.
    chi: float | None  #: |V_above − V_below|/V of the parts above and below the neck.
    contour: Contour  #: The shape.


@dataclass(frozen=True, eq=False)
class Frames(Sequence[Frame]):
    """The shapes of a dividing cell. Numbers of all frames are arrays; ``frames[k]`` is one frame, whose contour is a
    view."""

    t: Array  #: Times, in τ.
    length: Array  #: Contour lengths, in L_h.
    pressure: Array  #: Pressures, in κ0/L_h³.
    neck_radius: Array  #: Radii of the neck, in L_h; NaN without a waist.
    neck_u: Array  #: Arclength fractions of the neck.
    chi: Array  #: Asymmetry of the parts above and below the neck; NaN without a waist.
    shell: tuple[float, float]  #: Half axes of the shell along z and across, in L_h.
    _places: Mapping[str, Array] = field(repr=False)
    _ends: NDArray[np.int64] = field(repr=False)

    def __len__(self) -> int:
        return len(self.t)

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> list[Frame]: ...
    def __getitem__(self, index: int | slice) -> Frame | list[Frame]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        k = index + len(self) if index < 0 else index
        if not 0 <= k < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        begin = int(self._ends[k - 1]) if k else 0
        places = {name: column[begin : int(self._ends[k])] for name, column in self._places.items()}

        def number(column: Array) -> float | None:
            return None if np.isnan(column[k]) else float(column[k])

        return Frame(
            t=float(self.t[k]),
            length=float(self.length[k]),
            pressure=float(self.pressure[k]),
            neck_radius=number(self.neck_radius),
            neck_u=number(self.neck_u),
            chi=number(self.chi),
            contour=Contour(places),
        )

    def __iter__(self) -> Iterator[Frame]:
        return (self[k] for k in range(len(self)))

    def at(self, t: float) -> Frame:
        """The frame closest to a time."""
        return self[int(np.argmin(np.abs(self.t - t)))]

    def to_pandas(self) -> pd.DataFrame:
        """One row per frame; ``frames[k].contour.to_pandas()`` has the points of one."""
        names = ("t", "length", "pressure", "neck_radius", "neck_u", "chi")
        return frame({name: getattr(self, name) for name in names})

    def __repr__(self) -> str:
        return f"<Frames: {len(self)} from t = 0 to {self.t[-1]:.4g} τ>"


def _plain(value: Any) -> Any:
    """A value that JSON can represent."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value


class Result:
    """Methods of all results."""

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists for JSON."""
        return {f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.name != "frames"}  # type: ignore[arg-type]

    def to_pandas(self) -> pd.DataFrame:
        """One row with every scalar value."""
        values = self.to_dict().items()
        return frame({name: [value] for name, value in values if not isinstance(value, (dict, list))})

    def _rows(self) -> list[tuple[str, str]]:
        values = ((name, value) for name, value in self.to_dict().items() if not isinstance(value, (dict, list)))
        return [(name, shown(value)) for name, value in values]

    def _repr_html_(self) -> str:
        return html_table(self._rows(), type(self).__name__)


@dataclass(frozen=True)
class Division(Result):
    """The outcome of a division and its cost."""

    cell: Cell = field(repr=False)  #: The cell that divided.
    seed: int  #: Seed of the noise in its first step.
    outcome: str  #: ``symmetric``, ``asymmetric`` or ``failed``.
    chi: float | None  #: Size asymmetry χ = |V1 − V2|/V; None if it failed.
    chi_signed: float | None  #: Positive if the daughter at the pole u = 0 is smaller.
    u_furrow: float | None  #: Furrow position in arclength fraction from the pole u = 0.
    t_end: float  #: Time of pinch-off or of rest, in τ.
    daughters: tuple[float, float] | None  #: Radii R0 of the daughters below and above the furrow, in L_h.
    growth_rate: float | None  #: Leading growth rate of the shape at rest, in 1/τ.
    slow_growth_rate: float | None  #: For a cell that waits near a stationary shape: the growth rate there, in 1/τ.
    volume_drift: float  #: Largest relative deviation of the volume.
    steps: int  #: Time steps.
    rejected: int  #: Rejected steps.
    newton_iterations: int  #: Newton iterations.
    factorisations: int  #: Factorisations of a Jacobian.
    remeshings: int  #: Changes of the mesh.
    phi: float | None = None  #: The regulator φ at the furrow at pinch-off, or at u = 0.5 at rest; None without one.
    frames: Frames | None = field(default=None, repr=False, compare=False)  #: Its shapes, if requested.

    @property
    def divided(self) -> bool:
        """Whether the cell divided."""
        return self.outcome != "failed"

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """Contours, asymmetry and the balance of forces; needs matplotlib and frames."""
        from . import plot

        return plot.saved(plot.division(self), path)


def division(cell: Cell, seed: int, record: Mapping[str, Any], frames: Frames | None = None) -> Division:
    """The result from a record of the library."""
    daughters = record.get("daughters")
    return Division(
        cell=cell,
        seed=seed,
        outcome=record["outcome"],
        chi=record.get("chi"),
        chi_signed=record.get("chi_signed"),
        u_furrow=record.get("u_furrow"),
        t_end=record["t_end"],
        daughters=None if daughters is None else (daughters[0], daughters[1]),
        growth_rate=record.get("growth_rate"),
        slow_growth_rate=record.get("slow_growth_rate"),
        volume_drift=record["volume_drift"],
        steps=record["steps"],
        rejected=record["rejected"],
        newton_iterations=record["newton_iterations"],
        factorisations=record["factorisations"],
        remeshings=record["remeshings"],
        phi=record.get("phi"),
        frames=frames,
    )


@dataclass(frozen=True, eq=False)
class Replicates(Sequence[Division]):
    """Divisions of one cell with different noise seeds."""

    divisions: tuple[Division, ...]  #: In order of seeds.
    undecided: Mapping[int, str]  #: Reasons why other seeds could not be computed.

    def __len__(self) -> int:
        return len(self.divisions)

    @overload
    def __getitem__(self, index: int) -> Division: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Division]: ...
    def __getitem__(self, index: int | slice) -> Division | Sequence[Division]:
        return self.divisions[index]

    @property
    def chi(self) -> Array:
        """χ of each division; NaN if it failed."""
        return np.array([np.nan if d.chi is None else d.chi for d in self.divisions])

    @property
    def chi_mean(self) -> float | None:
        """Mean χ of the cells that divided."""
        chi = self.chi[~np.isnan(self.chi)]
        return float(chi.mean()) if len(chi) else None

    @property
    def chi_sd(self) -> float | None:
        """Standard deviation of χ of the cells that divided; None for fewer than two."""
        chi = self.chi[~np.isnan(self.chi)]
        return float(chi.std(ddof=1)) if len(chi) > 1 else None

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        return {"divisions": [d.to_dict() for d in self.divisions], "undecided": dict(self.undecided)}

    def to_pandas(self) -> pd.DataFrame:
        """One row per division."""
        names = [f.name for f in fields(Division) if f.name not in ("cell", "frames", "daughters")]
        return frame({name: [getattr(d, name) for d in self.divisions] for name in names})

    def __repr__(self) -> str:
        mean = "" if self.chi_mean is None else f", mean χ = {self.chi_mean:.4f}"
        return f"<Replicates: {len(self)} divisions{mean}>"


@dataclass(frozen=True, eq=False)
class Steady(Result):
    """A stationary shape and its stability."""

    cell: Cell = field(repr=False)  #: The cell.
    L: float  #: Contour length, in L_h.
    p: float  #: Pressure, in κ0/L_h³.
    H: float  #: Elongation (z(0) − z(1))/R0.
    r_eq: float  #: Radius at the equator, in L_h.
    stable: bool  #: Whether every disturbance decays.
    growth_rate: float  #: Largest real part of the growth rates, in 1/τ.
    growth_rates: NDArray[np.complex128] = field(repr=False)  #: The rightmost ones, by decreasing real part.
    parities: tuple[str, ...] = field(repr=False)  #: Whether each mode is ``even``, ``odd`` or ``mixed`` under u → 1 − u.
    folds_passed: tuple[float, ...]  #: Activities of the folds passed on the branch before this shape.
    contour: Contour = field(repr=False)  #: The shape, with the forces on it.
    #: The regulator φ at u = 0.5, ``phi_mid``, and at u = 0, ``phi_pole``; None without a regulator.
    regulator: Mapping[str, float] | None = None
    #: Disturbances cos mφ, from ``m`` = 0 on: ``growth_rate``, and for m ≥ 1 the ``parity`` of the leading mode; for m = 1
    #: also how much of it is a rigid shift or tilt, ``rigid``. None unless asked for.
    azimuthal: tuple[Mapping[str, Any], ...] | None = field(default=None, repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists; growth rates as pairs of real and imaginary part."""
        plain = super().to_dict()
        plain["growth_rates"] = [[rate.real, rate.imag] for rate in self.growth_rates]
        plain["azimuthal"] = None if self.azimuthal is None else [dict(row) for row in self.azimuthal]
        plain["contour"] = {name: column.tolist() for name, column in self.contour.columns.items()}
        return plain


@dataclass(frozen=True)
class Pitchfork(Result):
    """The threshold at which the mirror-symmetric shape loses its symmetry."""

    cell: Cell = field(repr=False)  #: The cell.
    xi_s: float  #: Threshold ξ_s*.
    criticality: str  #: ``supercritical`` or ``subcritical``.
    coefficient: float  #: c of ξ_s = ξ_s* + c (u_furrow − ½)² along the asymmetric branch.
    H: float  #: Elongation.
    L: float  #: Contour length, in L_h.
    p: float  #: Pressure, in κ0/L_h³.
    residual: float  #: Size of the last Newton correction.
    iterations: int  #: Newton iterations.


@dataclass(frozen=True)
class Event(Result):
    """A fold or a pitchfork of a branch."""

    kind: str  #: ``fold`` or ``pitchfork``.
    branch: str  #: Name of the branch.
    xi_s: float  #: Activity ξ_s.
    H: float  #: Elongation.
    L: float  #: Contour length, in L_h.
    criticality: str | None = None  #: For a pitchfork.
    coefficient: float | None = None  #: For a pitchfork.
    maximum: bool | None = None  #: For a fold: whether ξ_s has a maximum there along the branch.


@dataclass(frozen=True)
class Crossing(Result):
    """A shape of a branch where disturbances cos mφ begin or cease to grow."""

    m: int  #: The azimuthal number m.
    branch: str  #: Name of the branch.
    xi_s: float  #: Activity ξ_s.
    H: float  #: Elongation.
    grows_beyond: bool  #: Whether they grow beyond it, along the branch.


@dataclass(frozen=True, eq=False)
class Curve(Result):
    """A branch of stationary shapes, point by point."""

    name: str  #: ``symmetric``, ``cued`` or ``asymmetric``.
    xi_s: Array = field(repr=False)  #: Activity.
    H: Array = field(repr=False)  #: Elongation.
    L: Array = field(repr=False)  #: Contour length, in L_h.
    p: Array = field(repr=False)  #: Pressure, in κ0/L_h³.
    r_eq: Array = field(repr=False)  #: Radius at the equator, in L_h.
    growth_rate: Array = field(repr=False)  #: Largest growth rate, in 1/τ; NaN if not found.
    delta_u: Array = field(repr=False)  #: Furrow position u_furrow − ½.
    ended: str  #: Why the continuation stopped.
    #: Growth rates of disturbances cos mφ, in 1/τ: one row per shape, column k for m = k + 1; NaN if not found. None unless
    #: asked for.
    azimuthal: Array | None = field(default=None, repr=False)

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether each shape is stable; False if its growth rate was not found."""
        return self.growth_rate < 0.0

    def __len__(self) -> int:
        return len(self.xi_s)

    def to_pandas(self) -> pd.DataFrame:
        """One row per shape."""
        names = ("xi_s", "H", "L", "p", "r_eq", "growth_rate", "delta_u")
        columns: dict[str, Any] = {name: getattr(self, name) for name in names}
        modes = () if self.azimuthal is None else self.azimuthal.T
        rates = {f"growth_rate_m{m}": rate for m, rate in enumerate(modes, 1)}
        return frame({"branch": [self.name] * len(self), **columns, "stable": self.stable, **rates})

    def __repr__(self) -> str:
        return f"<Curve {self.name}: {len(self)} shapes, ξ_s from {self.xi_s.min():.4g} to {self.xi_s.max():.4g}>"


@dataclass(frozen=True, eq=False)
class Branch(Result):
    """The stationary shapes of a cell over ξ_s: ``branch["symmetric"]``, ``branch["asymmetric"]`` and their folds and
    pitchforks."""

    cell: Cell = field(repr=False)  #: The cell.
    curves: tuple[Curve, ...]  #: The branches.
    events: tuple[Event, ...]  #: Their folds and pitchforks.
    exponent: float | None = None  #: Exponent in |Δu| = prefactor |ξ_s − ξ_s*|^exponent near the pitchfork.
    prefactor: float | None = None  #: Its prefactor.
    #: Where growth rates of disturbances cos mφ change sign; None unless asked for.
    crossings: tuple[Crossing, ...] | None = None
    warnings: tuple[str, ...] = ()  #: Growth rates of such disturbances that could not be computed.

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
        """The branches, stable and unstable; needs matplotlib."""
        from . import plot

        return plot.saved(plot.branch(self), path)

    def _rows(self) -> list[tuple[str, str]]:
        rows = [(curve.name, f"{len(curve)} shapes, {curve.ended}") for curve in self.curves]
        rows += [(event.kind, f"{event.branch}, ξ_s = {event.xi_s:.6g}") for event in self.events]
        return rows + [(f"m = {c.m}", f"{c.branch}, ξ_s = {c.xi_s:.6g}") for c in self.crossings or ()]
