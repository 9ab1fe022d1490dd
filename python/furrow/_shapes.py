"""Where division begins: boundaries, phase diagrams, disturbed shapes, PAR polarity."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsFloat, overload

from . import _furrow
from ._checks import given_of, number_of, optional_path, path_of, refused, text_of
from ._results import Array, Division, Result
from ._tables import Found, frame, positive

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Cell, Value
    from ._furrow import Drawing


class Drawn(Found):
    """A result with the keys of the command line's JSON and its picture."""

    def __init__(self, found: Mapping[str, Any], drawing: Drawing, warnings: tuple[str, ...] = ()) -> None:
        super().__init__(found)
        #: The picture that the command line draws, which notebooks show.
        self.drawing = drawing
        #: What could not be computed.
        self.warnings = warnings

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture as SVG, PDF or PNG, by the file's extension."""
        self.drawing.save(path_of("path", path))

    def _repr_svg_(self) -> str:
        return self.drawing.svg()


class Boundary(Drawn):
    """Curves of pitchforks and folds over a parameter: the output of ``furrow boundary --json``."""

    @property
    def critical(self) -> float | None:
        """The value at which the boundary lies at the cell's own activity, if it was asked for."""
        value: float | None = self["critical"]
        return value

    def to_pandas(self) -> pd.DataFrame:
        """One row per point of any curve: ``pitchfork``, ``pitchfork 1``, ``fold 0``, ``m = 1`` and so on."""
        rows = [{**point, "curve": f"pitchfork {point.get('curve') or ''}".strip()} for point in self["pitchfork"]]
        rows += [{**point, "curve": f"fold {point['curve']}"} for point in self["folds"]]
        rows += [{**point, "curve": f"m = {point['m']}"} for point in self.get("azimuthal", ())]
        names = ("curve", "r0", "epsilon", "value", "xi_s", "H", "criticality", "coefficient")
        return frame({name: [row.get(name) for row in rows] for name in names})


class Phase(Drawn):
    """Outcomes over a parameter and ξ_s: the output of ``furrow phase --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per point of the plane."""
        names = ("x", "xi_s", "outcome", "chi", "by")
        return frame({name: [cell[name] for cell in self["cells"]] for name in names})


@dataclass(frozen=True)
class CriticalRadius(Result):
    """The radius below which cells do not divide.

    ``cell``: The cell; its radius plays no part.
    ``r0``: The critical radius, in L_h.
    ``kind``: ``pitchfork``, or ``cued_fold`` with a cue that tells the poles apart.
    ``slope``: Change of ξ_s along the boundary per change of R0.
    """

    cell: Cell = field(repr=False)
    r0: float
    kind: str
    slope: float


@dataclass(frozen=True, eq=False)
class Checks(Result):
    """The effects of the noise and of the mesh on a division.

    ``cell``: The cell.
    ``depends_on_noise``: Whether another seed changes more than the side of the furrow; None if its division failed.
    ``depends_on_mesh``: Whether twice the mesh with a quarter of the time tolerance changes the outcome, or χ by more than
    0.005; None if so fine a mesh is not allowed.
    ``chi_uncertainty``: Difference in χ to twice the mesh, or to the ``other_seed``; None unless both divide.
    ``other_seed``: The division with another seed: ``seed``, ``outcome``, ``chi``, ``u_furrow``. If neither noise nor mesh
    decides, it is on half the mesh, and has ``intervals`` and ``time_tolerance``.
    ``twice_the_mesh``: The division on twice the mesh, if it was needed.
    """

    cell: Cell = field(repr=False)
    depends_on_noise: bool | None = None
    depends_on_mesh: bool | None = None
    chi_uncertainty: float | None = None
    other_seed: dict[str, Any] | None = None
    twice_the_mesh: dict[str, Any] | None = None


@dataclass(frozen=True, eq=False)
class Perturbation(Result):
    """A stationary shape that was disturbed.

    ``division``: How it ended; ``failed`` if it did not divide in the time that it was watched.
    ``returned``: Whether it came back.
    ``start_growth_rate``: Leading growth rate of the stationary shape, in 1/τ.
    ``t``: Times, in τ.
    ``distance``: Distance from the start, ‖r − r0‖ + ‖z − z0‖.
    """

    division: Division
    returned: bool
    start_growth_rate: float
    t: Array = field(repr=False)
    distance: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class Perturbations(Sequence[Perturbation]):
    """Disturbances with consecutive seeds.

    ``found``: In order of seeds.
    ``drawing``: Distances over time.
    ``undecided``: Why other seeds could not be computed.
    """

    found: tuple[Perturbation, ...]
    drawing: Drawing = field(repr=False)
    undecided: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.found)

    @overload
    def __getitem__(self, index: int) -> Perturbation: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Perturbation]: ...
    def __getitem__(self, index: int | slice) -> Perturbation | Sequence[Perturbation]:
        return self.found[index]

    def _repr_svg_(self) -> str:
        return self.drawing.svg()


class Polarity(Found):
    """PAR polarity of cells, and what ends first as they shrink: the output of ``furrow polarity --json``."""

    def __init__(self, found: Mapping[str, Any], profiles: Mapping[str, Sequence[Sequence[float]]]) -> None:
        super().__init__(found)
        self._profiles = dict(profiles)

    def to_pandas(self) -> pd.DataFrame:
        """One row per cell."""
        names = ("cell", "r0", "r0_um", "polarised", "u0", "omega", "outcome", "chi", "chi_signed")
        return frame({name: [cell.get(name) for cell in self["cells"]] for name in names})

    def profiles_to_pandas(self) -> pd.DataFrame:
        """A and P of the polarised cells along the contour: one row per cell and place."""
        rows = [(cell, *place) for cell, places in self._profiles.items() for place in places]
        return frame({name: [row[k] for row in rows] for k, name in enumerate(("cell", "u", "a", "p"))})


def polarity(
    *,
    r0: Value | None = None,
    lineage: str | os.PathLike[str] | None = None,
    par: Mapping[str, Value] | None = None,
    length_um: SupportsFloat | None = None,
    profile: str = "step",
    amplitude: SupportsFloat = 0.1,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    **parameters: Value,
) -> Polarity:
    """PAR polarity at the sizes of the germline, or of one cell of the radius ``r0``: where its boundary lies, what χ follows,
    and at which size it ends.

    ``par`` sets constants of the chemistry, such as ``{"d_p": 0.1, "psi": 0.174}``; ``length_um`` is L_h in µm. κ follows P as a
    ``profile``, ``step`` or ``band``, of this ``amplitude``. ``lineage`` has the germline and the units; ``preset``, ``config``,
    ``law`` and keywords are those of :class:`Cell`.
    """
    if par is not None and not isinstance(par, Mapping):
        raise refused("par", par, "constants by name, as {'d_p': 0.1}")
    found, profiles = _furrow.polarity(
        given_of(parameters, preset, config, r0, law),
        optional_path("lineage", lineage),
        r0 is not None,
        {text_of("par", name): value for name, value in (par or {}).items()},
        None if length_um is None else positive("length_um", length_um),
        text_of("profile", profile),
        number_of("amplitude", amplitude),
    )
    return Polarity(found, dict(profiles))
