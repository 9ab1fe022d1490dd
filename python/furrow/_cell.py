"""A cell and the computations for it."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _furrow
from ._branches import Branch, Crossing, Curve, Event, HopfPoint, Pitchfork, Steady
from ._checks import (
    bool_of,
    given_of,
    number_of,
    optional_path,
    pair_of,
    path_of,
    refused,
    seed_of,
    text_of,
    threads_of,
    whole,
)
from ._errors import InputError
from ._memo import memo_of
from ._progress import Progress, shown
from ._results import Contour, Division, Frames, Replicates, division
from ._shapes import Boundary, Checks, CriticalRadius, Perturbation, Perturbations, Phase
from ._surfaces import Neck, Surfaces, surface
from ._tables import fixed, html_table
from ._tables import shown as shown_value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import TypeAlias

    from ._furrow import Drawing, Memo

#: A number (also of numpy), or a word for parameters with words as values.
Value: TypeAlias = SupportsFloat | SupportsIndex | str

#: The largest azimuthal number.
MOST_AZIMUTHAL = 16

#: Parameters that are shown in one line, which names them.
_IN_ONE_LINE = ("law", "shell_profile")

#: The columns that change sign under u → 1 − u; psi becomes π − psi.
_ODD = ("z", "v", "active_t")


def _lineage(lineage: str | os.PathLike[str] | None) -> str | None:
    return optional_path("lineage", lineage)


class Cell:
    """A cell: size, confinement, activity, cue, material, shell and numerics.

    ``r0`` is the radius R0 of the sphere with the cell's volume, in L_h (or ``"17um"`` if the lineage has units). Other
    parameters have the names of ``furrow --set``: ``epsilon``, ``xi_s``, ``aspect``, ``intervals`` and so on;
    :meth:`parameters` lists them. ``preset`` is a preset of constants, which a file ``config`` overrides and keywords override
    both; ``lineage`` is a lineage file with units and names of cues. ``shell_profile`` is a table of r over z, the profile of
    the shell, or ``"ellipsoid"``; the table sets ``aspect``. ``cue`` has the syntax of the command line: ``"none"``,
    ``"germline"`` or another name that the lineage defines, or terms such as ``"kappa:u0=0.465,omega=0.0577,amplitude=0.1"``
    and ``"regulator:none,turnover=10,diffusion=1,activity=0.3"``. ``law`` is a law of active stress in place of the paper's: a
    file of expressions, its text, or ``"paper"``; its constants are set as ``**{"law.a": 2}``.

    >>> import furrow
    >>> cell = furrow.Cell(r0=2.0, xi_s=15.0)
    >>> cell.epsilon, cell.xi_s
    (0.87, 15.0)

    Cells are immutable, compare by value, and can be pickled.
    """

    __slots__ = ("_inputs", "_known")

    _inputs: _furrow.Inputs
    _known: dict[str, Any] | None

    # The parameters, for type checkers; `parameters()` gives their values.
    if TYPE_CHECKING:
        kappa: float
        eta_b: float
        eta_s: float
        friction: float
        tension: float
        spontaneous_curvature: float
        normal_friction: float
        xi_s: float
        xi_ratio: float
        gain: float
        aspect: float
        p0: float
        w: float
        shell_flattening: float
        r0: float
        epsilon: float
        rigidity_gradient: str
        stages: int
        intervals: int
        scheme: str
        dt: float
        first_step: float
        time_tolerance: float
        step_factor: float
        t_max: float
        noise: float
        noise_time: float
        chi_symmetric: float
        modes: int
        elements: int
        contact: bool

    def __init__(
        self,
        r0: Value,
        *,
        cue: str = "none",
        preset: str = "gao2026",
        config: str | os.PathLike[str] | None = None,
        law: str | os.PathLike[str] | None = None,
        lineage: str | os.PathLike[str] | None = None,
        **parameters: Value | os.PathLike[str] | None,
    ) -> None:
        given: dict[str, Any] = {"r0": r0, **parameters}
        try:
            inputs = _furrow.Inputs(given_of(given, preset, config, law=law), text_of("cue", cue), _lineage(lineage))
        except InputError as error:
            # Report the caller's value, not its text form.
            if error.field in given:
                error.value = given[error.field]
            raise
        self._hold(inputs)

    def _hold(self, inputs: _furrow.Inputs) -> None:
        object.__setattr__(self, "_inputs", inputs)
        object.__setattr__(self, "_known", None)

    @classmethod
    def _of(cls, inputs: _furrow.Inputs) -> Cell:
        cell = cls.__new__(cls)
        cell._hold(inputs)
        return cell

    def parameters(self) -> dict[str, Any]:
        """All parameters by name, with the cue, the law (None for the paper's) and its constants as ``law.NAME``, and the profile
        of the shell (None for an ellipsoid)."""
        known = self._known
        if known is None:
            known = self._inputs.parameters()
            object.__setattr__(self, "_known", known)
        return dict(known)

    to_dict = parameters

    def replace(self, *, cue: str | None = None, **parameters: Value | os.PathLike[str] | None) -> Cell:
        """A copy with different values of some parameters, or with another ``cue``, ``law`` or ``shell_profile``. None is the
        paper's law or an ellipsoid, and of ``cue`` the cell's own.

        The ellipsoid keeps the ``aspect`` that the table of a profile has set, unless another one is given; a warning says so.
        """
        given: dict[str, Any] = dict(parameters)
        law = None
        if "law" in given:
            named = given.pop("law")
            law = "paper" if named is None else path_of("law", named)
        if given.get("shell_profile", "") is None:
            given["shell_profile"] = "ellipsoid"
        try:
            other = Cell._of(self._inputs.replaced(given, None if cue is None else text_of("cue", cue), law))
        except InputError as error:
            if error.field in parameters:
                error.value = parameters[error.field]
            raise
        lost = self.shell_profile is not None and other.shell_profile is None
        if lost and not {_furrow.canonical_name(name) for name in given} & {"aspect"}:
            text = f"the ellipsoid keeps the aspect ratio of the profile, {other.aspect:.6g}: give aspect= for another one"
            warnings.warn(text, stacklevel=2)
        return other

    def mirrored(self) -> Cell:
        """The mirror image under u → 1 − u."""
        return Cell._of(self._inputs.mirrored())

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether the cell is mirror-symmetric."""
        return self._inputs.is_mirror_symmetric()

    @property
    def law(self) -> str | None:
        """The law of active stress in one line; None for the paper's."""
        return self._inputs.law

    @property
    def shell_profile(self) -> str | None:
        """The profile of the shell in one line; None for an ellipsoid."""
        return self._inputs.shell_profile

    @property
    def cue(self) -> str:
        """The cue as text."""
        return self._inputs.cue

    @property
    def resolved_cue(self) -> str | None:
        """The cue with the position and the width that PAR polarity gives it, as text; None if it does not depend on polarity.

        >>> import furrow
        >>> furrow.Cell(4, cue="kappa:par_band,amplitude=0.1").resolved_cue[:20]
        'kappa:band,u0=0.4330'

        Raises :class:`~furrow.NoOutcome` if the polarity cannot be computed.
        """
        return self._inputs.resolved_cue()

    def cue_at(self, u: ArrayLike, length: SupportsFloat) -> dict[str, NDArray[np.float64]]:
        """The cue at arclength fractions ``u`` of a contour of this length: Σ A f(u) for each field that its terms change. Terms
        that follow PAR polarity are where it places them, as in :attr:`resolved_cue`.

        What a regulator does is not there: flow decides it.
        """
        at = np.ascontiguousarray(u, dtype=np.float64)
        if at.ndim != 1:
            raise refused("u", u, "a one-dimensional array")
        sums: dict[str, NDArray[np.float64]] = {}
        for name, values in self._inputs.cue_at(at, number_of("length", length)):
            sums[name] = sums[name] + values if name in sums else values
        return sums

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            known = self.parameters()
            if name in known:
                return known[name]
        raise AttributeError(f"a cell has no {name!r}")

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a cell does not change: cell.replace({name}=…) is another one")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.parameters()})

    def __eq__(self, other: object) -> bool:
        return self._inputs == other._inputs if isinstance(other, Cell) else NotImplemented

    def __hash__(self) -> int:
        # 0 and −0 are equal.
        return hash(self._inputs.to_json().replace("-0.0", "0.0"))

    def __reduce__(self) -> tuple[object, ...]:
        return (_from_json, (self._inputs.to_json(),))

    def __repr__(self) -> str:
        now, default = self.parameters(), _defaults()
        constants = [name for name in now if name.startswith("law.")]
        kept = {name: value for name, value in now.items() if name not in ("r0", *_IN_ONE_LINE, *constants)}
        changed = [f"{name}={value!r}" for name, value in kept.items() if value != default[name]]
        # The line of a law has its constants.
        changed += [f"{name}={now[name]}" for name in _IN_ONE_LINE if now[name] is not None]
        return f"furrow.Cell({', '.join(['r0=' + repr(now['r0']), *changed])})"

    def _repr_html_(self) -> str:
        now = self.parameters()
        names = ("r0", "epsilon", "xi_s", "cue", *(name for name in _IN_ONE_LINE if now[name] is not None))
        return html_table([(name, shown_value(now[name])) for name in names], "Cell")

    @overload
    def divide(
        self,
        seed: SupportsIndex = 0,
        *,
        frames: bool | float = False,
        places: SupportsIndex | None = None,
        replicates: None = None,
        memo: Memo | None = None,
        threads: SupportsIndex | None = None,
        progress: Progress = None,
    ) -> Division: ...
    @overload
    def divide(
        self,
        seed: SupportsIndex = 0,
        *,
        frames: Literal[False] = False,
        places: None = None,
        replicates: SupportsIndex,
        memo: Memo | None = None,
        threads: SupportsIndex | None = None,
        progress: Progress = None,
    ) -> Replicates: ...
    def divide(
        self,
        seed: SupportsIndex = 0,
        *,
        frames: bool | float = False,
        places: SupportsIndex | None = None,
        replicates: SupportsIndex | None = None,
        memo: Memo | None = None,
        threads: SupportsIndex | None = None,
        progress: Progress = None,
    ) -> Division | Replicates:
        """Computes the division, from the passive shape to pinch-off or rest.

        ``seed`` seeds the noise of the first step. ``frames=True`` keeps the shape after every step, ``frames=0.2``
        one every 0.2 τ, at the collocation points or at ``places`` points per mesh interval. ``replicates=N`` computes
        N divisions with consecutive seeds, on all cores or ``threads``. Divisions in the ``memo``, by default
        :func:`furrow.memo`, are not solved again. ``progress`` is called with the numbers of finished and of all divisions.

        Without axial symmetry, for a cell with ``modes=4``, frames are the ``surfaces`` of the division, about 0.5 MB each;
        with them the division has its ``neck`` after every step.

        >>> import furrow
        >>> division = furrow.Cell(r0=5.4, cue="germline").divide()
        >>> division.outcome, round(division.chi, 3)
        ('asymmetric', 0.185)

        Raises :class:`~furrow.InputError` for numerics or an activity outside the range of divisions, and
        :class:`~furrow.NoOutcome` if the cell neither divides nor rests.
        """
        first = seed_of(seed)
        known = memo_of(memo)
        frames = _frames_of(frames)
        count = 1 if replicates is None else whole("replicates", replicates, 1, 1_000_000)
        if replicates is not None and frames is not False:
            raise refused("frames", frames, "False with replicates")
        if self.modes > 0 and frames is not False:
            return self._filmed(first, known, frames, places)
        if count == 1:
            found = _furrow.divide(self._inputs, known, first, 1, 1)
        else:
            with shown(progress, "divisions") as tell:
                found = _furrow.divide(self._inputs, known, first, count, threads_of(threads), tell)
        solved, undecided = found
        if replicates is None:
            return division(self, first, solved[0][1], frames=self._frames(first, frames, places))
        return Replicates(tuple(division(self, seed, record) for seed, record in solved), dict(undecided))

    def checks(self, seed: SupportsIndex = 0, *, memo: Memo | None = None, threads: SupportsIndex | None = None) -> Checks:
        """Checks whether the noise or the mesh decides the division of :meth:`divide` with this ``seed``, as ``furrow divide``
        does for every cell: it computes the division with another seed on half the mesh, and if this differs, also on the cell's
        own mesh and with its own seed on twice the mesh. ``memo`` and ``threads`` are those of :meth:`divide`.

        >>> import furrow
        >>> furrow.Cell(2.5).checks().depends_on_noise, furrow.Cell(5.6).checks().depends_on_noise
        (False, True)
        """
        found = _furrow.checks(self._inputs, memo_of(memo), seed_of(seed), threads_of(threads))
        return Checks(cell=self, **found)

    def movie(
        self,
        path: str | os.PathLike[str],
        seed: SupportsIndex = 0,
        *,
        frames: SupportsIndex | None = None,
        progress: Progress = None,
    ) -> None:
        """Writes the division as a movie: GIF, animated PNG or animated SVG by the extension of ``path``. ``frames`` are evenly
        spaced in time, 80 by default, 20 in SVG; ``seed`` is that of :meth:`divide`, and ``progress`` is called with the
        numbers of finished and of all frames."""
        count = None if frames is None else whole("frames", frames, 2, 2000)
        with shown(progress, "frames") as tell:
            _furrow.write_movie(self._inputs, memo_of(None), seed_of(seed), path_of("path", path), count, tell)

    def write_frames(
        self, folder: str | os.PathLike[str], seed: SupportsIndex = 0, *, every: SupportsFloat | None = None
    ) -> None:
        """Writes the shapes of the division of :meth:`divide` with this ``seed`` into a ``folder`` as CSV, after every step or
        ``every`` so many τ, as ``furrow divide --frames`` does; ``furrow compare contour`` of the command line reads it. If the
        name ends in ``.ply`` or ``.glb``, it writes surfaces: a file for each frame, or one file. Without axial symmetry only
        these can be written."""
        step = None if every is None else number_of("every", every)
        _furrow.write_shapes(self._inputs, memo_of(None), seed_of(seed), path_of("folder", folder), step)

    def draw(self, seed: SupportsIndex = 0) -> Drawing:
        """The picture that ``furrow divide --plot`` draws of the division of :meth:`divide` with this ``seed``."""
        return _furrow.draw_division(self._inputs, memo_of(None), seed_of(seed))

    def perturb(
        self,
        seed: SupportsIndex = 0,
        *,
        until: SupportsFloat = 40.0,
        replicates: SupportsIndex = 1,
        threads: SupportsIndex | None = None,
    ) -> Perturbations:
        """Starts from the stationary shape at the cell's activity, disturbed by the noise of the first step, and follows it
        for ``until`` τ: whether it returns, with its distance from the start over time. ``replicates`` disturbances have
        consecutive seeds from ``seed`` on, and are followed on all cores or ``threads``.

        >>> import furrow
        >>> [furrow.Cell(2.0, xi_s=xi_s).perturb(until=20)[0].returned for xi_s in (20, 25)]
        [True, False]
        """
        count, first = whole("replicates", replicates, 1, 1_000_000), seed_of(seed)
        rows, drawing, undecided = _furrow.perturb(self._inputs, first, count, number_of("until", until), threads_of(threads))
        found = [
            Perturbation(
                division=division(self, row["seed"], row["division"]),
                returned=row["returned"],
                start_growth_rate=row["start_growth_rate"],
                t=fixed(np.array(row["distances"])[:, 0]),
                distance=fixed(np.array(row["distances"])[:, 1]),
            )
            for row in rows
        ]
        return Perturbations(tuple(found), drawing, tuple(undecided))

    def critical_radius(self) -> CriticalRadius:
        """The radius below which cells like this one do not divide.

        >>> import furrow
        >>> round(furrow.Cell(2.0).critical_radius().r0, 4)
        1.7208

        Raises :class:`~furrow.NoOutcome` if there is none.
        """
        return CriticalRadius(cell=self, **_furrow.critical_radius(self._inputs))

    def boundary(
        self,
        vary: str,
        first: SupportsFloat,
        last: SupportsFloat,
        *,
        folds: bool = True,
        critical: bool = False,
        azimuthal: SupportsIndex | None = None,
    ) -> Boundary:
        """Continues the boundary of division from the ``first`` to the ``last`` value of the parameter ``vary``: pitchforks and,
        unless ``folds`` is False, folds of mirror-symmetric shapes, or the fold that ends the stable shapes of a cell with
        another cue.

        ``critical`` also finds the value at which the boundary lies at the cell's own activity; ``azimuthal=M`` follows the
        activity from which disturbances cos mφ, m = 1 to M, grow.

        >>> import furrow
        >>> found = furrow.Cell(2.0).boundary("r0", 1.9, 2.0, folds=False)
        >>> round(found["pitchfork"][-1]["xi_s"], 4)
        22.0648
        """
        most = None if azimuthal is None else whole("azimuthal", azimuthal, 1, MOST_AZIMUTHAL)
        ends = [number_of("first", first), number_of("last", last)]
        asked = (bool_of("folds", folds), bool_of("critical", critical), most)
        found, drawing, said = _furrow.boundary(self._inputs, text_of("vary", vary), ends, *asked)
        return Boundary(found, drawing, tuple(said))

    def phase(
        self,
        vary: str,
        first: SupportsFloat,
        last: SupportsFloat,
        *,
        points: SupportsIndex = 8,
        xi_s: tuple[SupportsFloat, SupportsFloat] = (5.0, 30.0),
        xi_points: SupportsIndex = 6,
        azimuthal: SupportsIndex = 0,
        seed: SupportsIndex = 0,
        memo: Memo | None = None,
        threads: SupportsIndex | None = None,
        progress: Progress = None,
    ) -> Phase:
        """Maps outcomes over a parameter and ξ_s: the exact edges of stable shapes, and χ from divisions.

        ``vary`` names the parameter, which has ``points`` values from ``first`` to ``last``; ξ_s has ``xi_points`` from the first
        to the last value of ``xi_s``. ``seed``, ``memo``, ``threads`` and ``progress`` are those of :meth:`divide`.
        ``azimuthal=M`` draws where disturbances cos mφ, m = 1 to M, begin to grow.
        """
        known = memo_of(memo)
        across = (number_of("first", first), number_of("last", last), whole("points", points, 1, 10_000))
        up = (*pair_of("xi_s", xi_s), whole("xi_points", xi_points, 1, 10_000))
        with shown(progress, "divisions") as tell:
            found, drawing, said = _furrow.phase(
                self._inputs,
                known,
                seed_of(seed),
                text_of("vary", vary),
                [across, up],
                whole("azimuthal", azimuthal, 0, MOST_AZIMUTHAL),
                threads_of(threads),
                tell,
            )
        return Phase(found, drawing, tuple(said))

    def _frames(self, seed: int, frames: bool | float, places: SupportsIndex | None) -> Frames | None:
        if frames is False:
            if places is not None:
                raise refused("places", places, "given with frames")
            return None
        every = _every(frames)
        count = None if places is None else whole("places", places, 1, 64)
        _, of, ends, columns, (axes, wall) = _furrow.film(self._inputs, seed, every, count)
        return Frames(**of, shell=(axes[2], axes[0]), wall=fixed(np.array(wall)), _places=columns, _ends=ends)

    def _filmed(self, seed: int, memo: Memo, frames: bool | float, places: SupportsIndex | None) -> Division:
        """The division without axial symmetry, with its surfaces."""
        if places is not None:
            raise refused("places", places, "None without axial symmetry, where all frames have the same rings and meridians")
        found, of, grids, (axes, wall) = _furrow.surfaces(self._inputs, memo, seed, _every(frames))
        surfaces = Surfaces(**of, **grids, shell=(axes[0], axes[1], axes[2]), wall=fixed(np.array(wall)))
        neck = Neck(**{name: fixed(np.array(values)) for name, values in found["neck"].items()})
        return division(self, seed, found["division"], surfaces=surfaces, neck=neck, modes=found["modes"])

    def steady(self, *, azimuthal: SupportsIndex | None = None) -> Steady:
        """The stationary shape at the cell's activity, on the branch of the passive shape, and its growth rates.

        ``azimuthal=M`` also computes the growth rates of disturbances cos mφ, m up to M ≤ 16, which are not axisymmetric.

        Without axial symmetry, for a cell with ``modes=4``, it is the state at rest that the cell reaches from the passive
        shape, with the growth rates of all its modes.

        >>> import furrow
        >>> steady = furrow.Cell(1.0, modes=2, elements=32).steady()
        >>> steady.stable, steady.surface
        (True, <Surface of 129 rings × 64 meridians>)

        Raises :class:`~furrow.NoOutcome` if there is none, as for a cell that must divide.
        """
        most = None if azimuthal is None else whole("azimuthal", azimuthal, 0, MOST_AZIMUTHAL)
        if self.modes > 0:
            return self._steady_surface(azimuthal)
        found, places = _furrow.steady(self._inputs, most)
        rates = found.pop("growth_rates")
        modes = found.pop("azimuthal", None)
        if found["growth_rate_uncertainty"] is None:
            found["growth_rate_uncertainty"] = np.inf
        return Steady(
            cell=self,
            growth_rates=_complex(rates),
            parities=tuple(rate["parity"] for rate in rates),
            folds_passed=tuple(found.pop("folds_passed")),
            _contour=Contour(_whole(places)),
            azimuthal=None if modes is None else tuple(modes),
            **found,
        )

    def _steady_surface(self, azimuthal: object) -> Steady:
        if azimuthal is not None:
            only = "None without axial symmetry, where growth rates are those of all modes"
            raise refused("azimuthal", azimuthal, only)
        found, grids = _furrow.steady_surface(self._inputs)
        rates = _complex(found.pop("growth_rates"))
        nothing: dict[str, Any] = {"parities": (), "folds_passed": (), "_contour": None}
        return Steady(cell=self, growth_rates=rates, surface=surface(grids), **nothing, **found)

    def pitchfork(self, xi_max: SupportsFloat = 100.0) -> Pitchfork:
        """The first pitchfork of the mirror-symmetric shapes, for ξ_s up to ``xi_max``.

        Raises :class:`~furrow.NoOutcome` if there is none, as with a cue that breaks the mirror symmetry.
        """
        return Pitchfork(cell=self, **_furrow.pitchfork(self._inputs, number_of("xi_max", xi_max)))

    def branch(
        self,
        xi_max: SupportsFloat = 100.0,
        max_step: SupportsFloat = 1.0,
        *,
        azimuthal: SupportsIndex | None = None,
        reduced_volume: SupportsFloat | None = None,
    ) -> Branch:
        """Symmetric and asymmetric stationary shapes over ξ_s up to ``xi_max``, with folds and pitchforks. ``max_step`` is the
        largest step along a branch, in arclength. A branch ends where its reduced volume, its volume divided by the volume of
        a sphere with the same area, falls to ``reduced_volume``.

        ``azimuthal=M`` also computes growth rates of disturbances cos mφ, m = 1 to M, at every point, and where they change
        sign. For a cell with ``modes`` the curve ``bent`` has the states at rest without axial symmetry.
        """
        most = None if azimuthal is None else whole("azimuthal", azimuthal, 1, MOST_AZIMUTHAL)
        volume = None if reduced_volume is None else number_of("reduced_volume", reduced_volume)
        ends_at = (number_of("xi_max", xi_max), number_of("max_step", max_step))
        found, points = _furrow.branch(self._inputs, *ends_at, most, volume)
        ends = {end["branch"]: end["why"] for end in found["ends"]}
        scaling = found["scaling"] or (None, None)
        return Branch(
            cell=self,
            curves=tuple(Curve(name=name, ended=ends[name], **columns) for name, columns in points.items()),
            events=tuple(Event(**event) for event in found["events"]),
            exponent=scaling[0],
            prefactor=scaling[1],
            crossings=None if most is None else tuple(Crossing(**crossing) for crossing in found["crossings"]),
            warnings=tuple(found["warnings"]),
            bent=found["bent"],
            hopf=tuple(HopfPoint(**point) for point in found["hopf"]),
        )


def _frames_of(frames: object) -> bool | float:
    """False, True for all frames, or the interval between frames, in τ."""
    if isinstance(frames, (bool, np.bool_)):
        return bool(frames)
    try:
        return number_of("frames", frames)
    except InputError:
        raise refused("frames", frames, "True, False or a number of τ") from None


def _every(frames: bool | float) -> float | None:
    """The interval between frames, in τ; None for all."""
    return None if frames is True else float(frames)


def _complex(rates: Sequence[Mapping[str, float]]) -> NDArray[np.complex128]:
    return np.array([complex(rate["re"], rate["im"]) for rate in rates])


def _from_json(text: str) -> Cell:
    return Cell._of(_furrow.Inputs.from_json(text))


def _defaults() -> dict[str, Any]:
    return dict(_furrow.Inputs(({}, "gao2026", None, None)).parameters())


def _whole(places: Mapping[str, Any]) -> dict[str, Any]:
    """A contour from pole to pole; that of a mirror-symmetric shape is computed up to its equator."""
    if places["u"][-1] > 0.75:
        return dict(places)
    whole = {}
    for name, half in places.items():
        other = half[-2::-1]
        if name == "u":
            other = 1.0 - other
        elif name == "psi":
            other = np.pi - other
        elif name in _ODD:
            other = -other
        whole[name] = fixed(np.concatenate((half, other)))
    return whole
