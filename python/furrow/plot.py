"""Matplotlib figures in the style of the command line's: the same colours and labels.

Every function returns a :class:`matplotlib.figure.Figure` that you can change or save.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ._branches import Branch
    from ._cell import Cell
    from ._results import Division, Frame, Frames
    from ._studies import Ranges
    from ._surfaces import Surfaces
    from ._tree import Tree
    from .compare import ContoursComparison, VolumesComparison

    Numbers: TypeAlias = NDArray[np.floating[Any]]

INK = "#1a1a1a"
MUTED = "#555555"
FAINT = "#d9d9d9"
SYMMETRIC = "#0072b2"
ASYMMETRIC = "#d55e00"
FAILED = "#999999"
MODEL = "#009e73"
OBSERVED = INK
#: The cue where it raises a field, and where it lowers it.
CUE = "#e69f00"
CUE_LOWERS = "#0072b2"
SHELL = "#8c8c8c"
CYTOPLASM = "#eaf4fa"
SERIES = ("#000000", "#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00")
FORCES = {"active": "#cc79a7", "viscous": "#56b4e9", "elastic": "#009e73", "pressure": "#1a1a1a", "shell": "#e69f00"}
OUTCOMES = {"symmetric": SYMMETRIC, "asymmetric": ASYMMETRIC, "failed": FAILED}
BRANCHES = {"symmetric": SYMMETRIC, "asymmetric": ASYMMETRIC, "cued": MODEL}

#: Labels of parameters on an axis, with their units.
LABELS = {
    "r0": "radius R₀ ($L_h$)",
    "epsilon": "volume fraction ε",
    "xi_s": "activity $ξ_s$ ($κ_0/L_h$)",
    "chi": "size asymmetry χ",
    "t": "time (τ)",
    "H": "elongation H",
    "aspect": "shell, a/b",
    "w": "shell width w",
    "p0": "shell strength $p_0$",
    "gain": "gain g",
}

#: Labels of the fields of a cue.
FIELDS = {
    "kappa": "rigidity κ",
    "activity": "activity",
    "xi_s": "activity $ξ_s$",
    "xi_b": "activity $ξ_b$",
    "eta_b": "viscosity $η_b$",
    "eta_s": "viscosity $η_s$",
    "viscosity": "viscosity",
    "friction": "friction Γ",
    "tension": "tension",
}

#: Contours that a picture of a division shows.
STILLS = 6
#: Weaker parts of a cue than this share of its strongest are not drawn.
FAINTEST = 0.08


def _figure(width: float, height: float) -> Figure:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install matplotlib") from error
    # Not by way of pyplot, which keeps every figure and would show it a second time in a notebook.
    return Figure(figsize=(width, height), layout="constrained", facecolor="white")


def saved(figure: Figure, path: str | os.PathLike[str] | None) -> Figure:
    """The figure, written to ``path`` if given."""
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def style(axes: Axes) -> Axes:
    """Applies the common style to an axis."""
    axes.grid(True, color=FAINT, linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(MUTED)
    axes.tick_params(colors=MUTED, labelcolor=INK)
    axes.xaxis.label.set_color(INK)
    axes.yaxis.label.set_color(INK)
    return axes


def title_of(division: Division) -> str:
    """The title: the cell and its outcome."""
    cell = division.cell
    became = "stays at rest" if division.chi is None else f"{division.outcome}, χ = {division.chi:.3f}"
    return f"R₀ = {cell.r0:g}, ε = {cell.epsilon:g}, $ξ_s$ = {cell.xi_s:g}{_cue_of(cell)}: {became}"


def _cue_of(cell: Cell) -> str:
    """The cue as the last part of a cell's description."""
    return "" if cell.cue == "none" else f", cue {cell.cue}"


def _title(figure: Figure, text: str) -> None:
    """The title of a figure, in as many lines as its width takes."""
    most = int(10.0 * figure.get_figwidth())
    lines = [""]
    # Cues are long and without spaces: a line may end behind a comma or a plus sign.
    for part in re.split(r"(?<=[ ,+])", text):
        if lines[-1] and len(lines[-1] + part.rstrip()) > most:
            lines.append("")
        lines[-1] += part
    figure.suptitle("\n".join(line.rstrip() for line in lines), color=INK, fontsize=11, x=0.01, ha="left")


def contour(
    axes: Axes,
    frame: Frame,
    shell: tuple[float, float] | Numbers | None = None,
    cell: Cell | None = None,
    most: float | None = None,
) -> Axes:
    """A cell in its shell, anterior left; with ``cell``, its cue along the outside.

    ``shell``: The ``wall`` of the frames, or the half axes of an ellipsoid along z and across.

    The colour of a regulator φ is full where it is ``most``; without ``most``, where it is farthest from 0.
    """
    r, z = frame.contour.r, frame.contour.z
    if shell is not None:
        _shell(axes, shell)
    axes.fill(np.concatenate((z, z[::-1])), np.concatenate((r, -r[::-1])), facecolor=CYTOPLASM, edgecolor=INK, linewidth=1.6)
    if cell is not None and cell.cue != "none":
        _cue(axes, frame, cell, most)
    axes.set_aspect("equal")
    axes.axis("off")
    return axes


def _shell(axes: Axes, shell: tuple[float, float] | Numbers) -> None:
    if isinstance(shell, tuple):
        angle = np.linspace(0.0, np.pi, 100)
        r, z = shell[1] * np.sin(angle), shell[0] * np.cos(angle)
    else:
        r, z = shell.T
    axes.plot(np.concatenate((z, z[::-1])), np.concatenate((r, -r[::-1])), color=SHELL, linestyle="--", linewidth=1.0)


def _cue(axes: Axes, frame: Frame, cell: Cell, most: float | None) -> None:
    """The cue along the outside of the contour: a strip for each field, in one colour where the cue raises the field and in
    another where it lowers it, with the local strength as opacity, and one for the regulator φ."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgba

    # Evenly along the contour, independent of the mesh.
    u = np.linspace(0.0, 1.0, 401)
    r, z, psi = (np.interp(u, frame.contour["u"], frame.contour[name]) for name in ("r", "z", "psi"))
    # The outward normal is (sin ψ, cos ψ) along (r, z).
    wide = 0.016 * frame.length / np.pi
    strips, colours = [], []
    strengths = list(_strengths(cell, u, frame.length).values())
    most = most or _most([frame])
    if most:
        strengths.insert(0, np.interp(u, frame.contour["u"], frame.contour["phi"]) / most)
    for place, strength in enumerate(strengths):
        from_, to = 0.5 + 2.4 * place, 2.5 + 2.4 * place
        inner, outer = ((r + k * wide * np.sin(psi), z + k * wide * np.cos(psi)) for k in (from_, to))
        for k in np.flatnonzero(np.abs(strength[:-1]) > FAINTEST):
            corners = [(inner, k), (inner, k + 1), (outer, k + 1), (outer, k)]
            for side in (1.0, -1.0):
                strips.append([(line[1][at], side * line[0][at]) for line, at in corners])
                colours.append(to_rgba(CUE if strength[k] > 0.0 else CUE_LOWERS, min(float(abs(strength[k])), 1.0)))
    axes.add_collection(PolyCollection(strips, facecolors=colours, edgecolors="none", zorder=3))


def _strengths(cell: Cell, u: Numbers, length: float) -> dict[str, Numbers]:
    """How strongly the cue changes each field, from −1 to 1, relative to where it changes it most."""
    changes = cell.cue_at(u, length)
    return {name: values / np.max(np.abs(values)) for name, values in changes.items() if np.any(values)}


def _phi(frames: Sequence[Frame]) -> list[Numbers]:
    """The regulator φ along each contour, nothing without one."""
    return [frame.contour["phi"] for frame in frames if "phi" in frame.contour.columns]


def _most(frames: Sequence[Frame]) -> float:
    """What is farthest from 0 of all φ, and 0 without a regulator."""
    return max((float(np.max(np.abs(phi))) for phi in _phi(frames)), default=0.0)


def _regulator(axes: Axes, frames: Sequence[Frame]) -> None:
    """The regulator φ along the contours, anterior left."""
    from matplotlib import colormaps

    for k, frame in enumerate(frames):
        colour = colormaps["viridis"](0.05 + 0.8 * k / max(len(frames) - 1, 1))
        axes.plot(frame.contour["u"], frame.contour["phi"], color=colour, linewidth=1.8, label=f"t = {frame.t:.3g} τ")
    axes.set(xlim=(1.0, 0.0), xlabel="place u", ylabel="regulator φ")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(frames), fontsize=9)


def _cue_legend(figure: Figure, found: Division, length: float, frames: Sequence[Frame]) -> None:
    """The colours of the cue that the contours have, and its fields from the inside outwards."""
    from matplotlib.patches import Patch

    strengths = _strengths(found.cell, np.linspace(0.0, 1.0, 401), length)
    names = [FIELDS.get(name, name) for name in strengths]
    what = names[0] if len(names) == 1 else "what it changes"
    handles = [
        Patch(facecolor=colour, label=f"cue {verb} {what}")
        for colour, verb, sign in ((CUE, "raises", 1.0), (CUE_LOWERS, "lowers", -1.0))
        if any(np.any(sign * strength > FAINTEST) for strength in strengths.values())
    ]
    phi, most = _phi(frames), _most(frames)
    handles += [
        Patch(facecolor=colour, label=f"regulator φ {sign} 0, to {end:.2g}".replace("-", "−"))
        for colour, sign, end in (
            (CUE, ">", max((float(np.max(one)) for one in phi), default=0.0)),
            (CUE_LOWERS, "<", min((float(np.min(one)) for one in phi), default=0.0)),
        )
        if abs(end) > FAINTEST * most
    ]
    names = ["regulator", *names] if phi else names
    if len(names) > 1:
        handles.append(Patch(facecolor="none", edgecolor="none", label=f"strips from the inside: {', '.join(names)}"))
    figure.legend(handles=handles, frameon=False, loc="outside lower left", ncols=3, fontsize=9)


def division(found: Division) -> Figure:
    """A division: contours in their shell, neck and asymmetry over time, and the normal forces half-way; with a regulator
    also φ along the contours. Without axial symmetry: sections, neck and asymmetry over time."""
    if found.surfaces is not None:
        return _sections(found, found.surfaces)
    frames = found.frames
    if frames is None:
        from ._checks import refused

        raise refused("frames", False, "True, in cell.divide(frames=True), for a picture of a division")
    stills = _stills(frames, float(frames[0].contour.r.max()), found.divided)
    heights = (1.0, 2.2, 1.5) if _phi(stills) else (1.0, 2.2)
    figure = _figure(11.0, 2.0 * sum(heights))
    _title(figure, title_of(found))
    grid = figure.add_gridspec(len(heights), 1, height_ratios=heights)
    row = grid[0].subgridspec(1, STILLS)
    for k, frame in enumerate(stills):
        axes = contour(figure.add_subplot(row[k]), frame, frames.wall, found.cell if k else None, _most(stills))
        _still_title(axes, frame.t, first=k == 0)
    charts = grid[1].subgridspec(1, 2, width_ratios=(0.82, 1.0))
    _over_time(style(figure.add_subplot(charts[0])), found, frames)
    _balance(style(figure.add_subplot(charts[1])), _half_way(frames))
    if _phi(stills):
        _regulator(style(figure.add_subplot(grid[2])), stills)
    if found.cell.cue != "none":
        _cue_legend(figure, found, float(frames[-1].length), stills)
    return figure


def _sections(found: Division, frames: Surfaces) -> Figure:
    """A division without axial symmetry."""
    figure = _figure(11.0, 6.4)
    _title(figure, title_of(found).replace(": ", ", without axial symmetry: "))
    grid = figure.add_gridspec(2, 1, height_ratios=(1.0, 2.2))
    row = grid[0].subgridspec(1, STILLS)
    # The side of the axis on which the neck ends is drawn below.
    offsets = frames.neck_offset[~np.isnan(frames.neck_offset)]
    side = -1.0 if len(offsets) and offsets[-1] > 0.0 else 1.0
    for k, frame in enumerate(_stills(frames, frames.shell[0], found.divided)):
        axes = figure.add_subplot(row[k])
        x, z = frame.surface.section.T
        _shell(axes, frames.wall)
        axes.fill(z, side * x, facecolor=CYTOPLASM, edgecolor=INK, linewidth=1.6)
        axes.set_aspect("equal")
        axes.axis("off")
        _still_title(axes, frame.t, first=k == 0)
    axes = style(figure.add_subplot(grid[1]))
    distance = np.abs(frames.neck_offset) / found.cell.r0
    axes.plot(frames.t, distance, color=INK, linewidth=2.0, label="neck's distance from the axis / R₀")
    _over_time(axes, found, frames)
    axes.set_ylabel("neck radius and distance / R₀,  χ")
    return figure


def _still_title(axes: Axes, t: float, *, first: bool) -> None:
    """The time below a cell, and the names of the poles above the first."""
    axes.set_title(f"t = {t:.3g} τ", y=-0.22, fontsize=9, color=MUTED)
    if first:
        for x, side, pole in ((0.0, "left", "anterior"), (1.0, "right", "posterior")):
            axes.text(x, 1.0, pole, transform=axes.transAxes, ha=side, va="bottom", fontsize=9, color=MUTED)


def _stills(frames: Frames | Surfaces, widest: float, divides: bool) -> list[Any]:
    """Frames between which the neck closes, or the contour of a resting cell grows, by about equal amounts."""
    waist = np.where(np.isnan(frames.neck_radius), widest, frames.neck_radius) / widest
    grown = np.log(frames.length / frames.length[0])
    progress = np.maximum.accumulate(0.5 * grown + 1.0 - np.minimum(waist, 1.0) if divides else grown)
    wanted = np.linspace(progress[0], progress[-1], STILLS)
    return [frames[min(int(k), len(frames) - 1)] for k in np.searchsorted(progress, wanted - 1e-12)]


def _half_way(frames: Frames) -> Frame:
    """The frame with a neck half as wide as the cell was; for a resting cell the last frame."""
    narrow = np.flatnonzero(frames.neck_radius < 0.5 * frames[0].contour.r.max())
    return frames[int(narrow[0])] if len(narrow) else frames[-1]


def _over_time(axes: Axes, found: Division, frames: Frames | Surfaces) -> None:
    axes.plot(frames.t, frames.neck_radius / found.cell.r0, color=SYMMETRIC, linewidth=2.0, label="neck radius / R₀")
    axes.plot(frames.t, frames.chi, color=ASYMMETRIC, linewidth=2.0, label="asymmetry χ about the neck")
    axes.set(xlabel=LABELS["t"], ylabel="neck radius / R₀,  χ", xlim=(0.0, float(frames.t[-1])))
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=9)


def _balance(axes: Axes, frame: Frame) -> None:
    u = frame.contour["u"]
    forces = {name: frame.contour[f"{name}_n"] for name in FORCES}
    for name, force in forces.items():
        axes.plot(u, force, color=FORCES[name], linewidth=1.8, label=name)
    # At the neck forces are far larger, and would hide all others: nine tenths of the contour are shown.
    sizes = np.interp(np.linspace(0, 1, 201), u, np.max(np.abs(np.stack(list(forces.values()))), axis=0))
    most = max(1.24 * float(np.quantile(sizes, 0.9)), 1e-6)
    # The same way as the contours: anterior on the left.
    axes.set(xlim=(1.0, 0.0), ylim=(-most, most), xlabel="place u")
    for x, side, pole in ((0.0, "left", "anterior"), (1.0, "right", "posterior")):
        axes.text(x, -0.085, pole, transform=axes.transAxes, ha=side, va="top", color=MUTED)
    axes.set_ylabel(f"normal force at t = {frame.t:.3g} τ ($κ_0/L_h^3$)")
    axes.axhline(0.0, color=MUTED, linewidth=0.8)
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, fontsize=9, columnspacing=1.2)
    peaks = {name: float(force[np.argmax(np.abs(force))]) for name, force in forces.items()}
    beyond = [f"{name} {peak:+.0f}".replace("-", "−") for name, peak in peaks.items() if abs(peak) > most]
    if beyond:
        text = "\n".join(["at the neck", *beyond])
        axes.text(0.02, 0.97, text, transform=axes.transAxes, va="top", fontsize=9, color=MUTED)


def branch(found: Branch) -> Figure:
    """A bifurcation diagram: elongation and furrow position over activity, dashed where shapes are unstable."""
    breaks = any(np.nanmax(np.abs(curve.delta_u), initial=0.0) > 1e-6 for curve in found.curves)
    figure = _figure(8.4, 7.0 if breaks else 4.2)
    _title(figure, f"Stationary shapes at R₀ = {found.cell.r0:g}, ε = {found.cell.epsilon:g}{_cue_of(found.cell)}")
    shown = (("H", LABELS["H"]), ("delta_u", "furrow position δu (anterior > 0)"))[: 2 if breaks else 1]
    charts = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, label) in zip(charts, shown, strict=True):
        style(axes).set_ylabel(label)
        for curve in found.curves:
            _stability(axes, curve.xi_s, getattr(curve, name), curve.stable, BRANCHES.get(curve.name, INK))
        _events(axes, found, name)
    charts[-1].set_xlabel(LABELS["xi_s"])
    _branch_legend(charts[0], found)
    return figure


def _stability(axes: Axes, x: Numbers, y: Numbers, stable: Any, colour: str) -> None:
    """A curve, solid where shapes are stable; pieces overlap by one point to avoid gaps."""
    ends = np.flatnonzero(np.diff(stable.astype(int))) + 1
    for begin, end in zip([0, *ends], [*ends, len(x)], strict=True):
        piece = slice(max(int(begin) - 1, 0), int(end))
        dashes = "-" if stable[begin] else (0, (3.5, 2.3))
        axes.plot(x[piece], y[piece], color=colour, linestyle=dashes, linewidth=2.2)


def _events(axes: Axes, found: Branch, name: str) -> None:
    for event in found.events:
        curve = found[event.branch]
        y = event.H if name == "H" else _nearest(curve.xi_s, curve.H, curve.delta_u, event.xi_s, event.H)
        marker = "o" if event.kind == "pitchfork" else "D"
        axes.plot([event.xi_s], [y], marker=marker, color=INK, markersize=7, zorder=3)


def _nearest(xi_s: Numbers, elongation: Numbers, values: Numbers, at: float, height: float) -> float:
    """The value of a curve at the point nearest to an event, by activity and elongation."""
    away = (xi_s - at) ** 2 / max(float(np.ptp(xi_s)), 1e-9) ** 2
    away = away + (elongation - height) ** 2 / max(float(np.ptp(elongation)), 1e-9) ** 2
    return float(values[int(np.argmin(away))])


def _branch_legend(axes: Axes, found: Branch) -> None:
    from matplotlib.lines import Line2D

    keys = [
        Line2D([], [], color=BRANCHES.get(curve.name, INK), linewidth=2.2, label=f"{curve.name} shapes") for curve in found.curves
    ]
    for stable, label in ((True, "stable"), (False, "unstable")):
        if any(np.any(np.asarray(curve.stable, dtype=bool) == stable) for curve in found.curves):
            keys.append(Line2D([], [], color=INK, linewidth=2.2, label=label))
            if not stable:
                keys[-1].set_linestyle((0, (3.5, 2.3)))
    for kind, marker in (("pitchfork", "o"), ("fold", "D")):
        if any(event.kind == kind for event in found.events):
            keys.append(Line2D([], [], color=INK, marker=marker, linestyle="none", label=kind))
    axes.legend(handles=keys, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=9)


def rounds(tree: Tree) -> Figure:
    """Rounds of division and terminal cells of each founder, in the model and observed."""
    names = [founder.name for founder in tree.founders]
    model = [founder.rounds for founder in tree.founders]
    seen = [founder.observed for founder in tree.founders]
    sets = [("model", MODEL, model)]
    if any(seen):
        sets.append(("observed", OBSERVED, seen))

    def three(of: Any, name: str) -> tuple[float, float, float] | None:
        value = None if of is None else getattr(of, name)
        return None if value is None else (value, value, value)

    bars = [(label, colour, [_bar(of, three) for of in rows]) for label, colour, rows in sets]
    return _rounds_figure(f"{tree.organism}: rounds of division from each founder", names, bars)


def ranges(found: Ranges) -> Figure:
    """Rounds of division of each founder over sets of constants: medians and 90 % ranges."""
    names = [str(founder["name"]) for founder in found.founders]

    def three(of: Any, name: str) -> tuple[float, float, float] | None:
        value = None if of is None else of[name]
        return None if value is None else (value["p5"], value["p50"], value["p95"])

    bars = [(f"model, median and 5–95 % of {found.members} sets", MODEL, [_bar(f["rounds"], three) for f in found.founders])]
    return _rounds_figure("rounds of division from each founder", names, bars)


def _bar(of: Any, three: Any) -> dict[str, tuple[float, float, float] | None]:
    return {name: three(of, name) for name in ("min", "mean", "max", "terminal")}


def _rounds_figure(title: str, names: Sequence[str], sets: Sequence[tuple[str, str, list[dict[str, Any]]]]) -> Figure:
    figure = _figure(max(7.0, 0.75 * len(names) + 2.0), 6.2)
    _title(figure, title)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    for k, (label, colour, bars) in enumerate(sets):
        offset = 0.24 * (k - 0.5 * (len(sets) - 1))
        x = np.arange(len(names)) + offset
        for place, bar in zip(x, bars, strict=True):
            if bar["min"] is not None and bar["max"] is not None:
                above.plot(
                    [place, place], [bar["min"][1], bar["max"][1]], color=colour, linewidth=6, alpha=0.35, solid_capstyle="butt"
                )
        _points(above, x, [bar["mean"] for bar in bars], colour, label)
        _points(below, x, [bar["terminal"] for bar in bars], colour, label)
    style(above).set_ylabel("rounds")
    style(below).set_ylabel("terminal cells")
    below.set_yscale("log")
    below.yaxis.set_major_formatter("{x:g}")
    below.set_xticks(np.arange(len(names)), names)
    handles, labels = above.get_legend_handles_labels()
    above.legend(handles, labels, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(sets), fontsize=9)
    above.set_title("bars from the fewest to the most rounds, discs at the mean", fontsize=9, color=MUTED, loc="right")
    return figure


def _points(axes: Axes, x: Numbers, values: Sequence[tuple[float, float, float] | None], colour: str, label: str) -> None:
    kept = [(place, value) for place, value in zip(x, values, strict=True) if value is not None]
    if not kept:
        return
    y = np.array([value[1] for _, value in kept])
    errors = np.array([[value[1] - value[0], value[2] - value[1]] for _, value in kept]).T
    axes.errorbar(
        [place for place, _ in kept], y, yerr=errors if errors.any() else None, fmt="o", color=colour, markersize=6, label=label
    )


def volumes(found: VolumesComparison) -> Figure:
    """Measured χ by mother, with the standard deviation, and the model's χ."""
    names = list(dict.fromkeys(mother.mother for mother in found.mothers))
    groups = list(dict.fromkeys(mother.group for mother in found.mothers))
    figure = _figure(min(max(6.4, (0.35 + 0.11 * len(groups)) * len(names) + 2.0), 24.0), 4.4)
    axes = style(figure.subplots())
    hues = [OBSERVED, *SERIES[1:3], *SERIES[4:]]
    # Side by side about the mother's name: its groups, and the model last.
    step = 0.7 / (len(groups) + 1)

    def beside(k: int, mothers: Sequence[str]) -> Numbers:
        return np.array([names.index(name) for name in mothers], dtype=np.float64) + step * (k - 0.5 * len(groups))

    for k, group in enumerate(groups):
        rows = [mother for mother in found.mothers if mother.group == group]
        x = beside(k, [row.mother for row in rows])
        sd = np.array([np.nan if row.sd is None else row.sd for row in rows])
        label, colour = f"measured, {group}" if group else "measured", hues[k % len(hues)]
        axes.errorbar(x, [row.measured for row in rows], yerr=sd, fmt="o", color=colour, markersize=5, label=label)
    first = {mother.mother: mother for mother in reversed(found.mothers)}
    rows = [first[name] for name in names]
    x = beside(len(groups), names)
    for place, row in zip(x, rows, strict=True):
        if row.band is not None:
            axes.plot([place, place], row.band[::2], color=MODEL, linewidth=6, alpha=0.35, solid_capstyle="butt")
    chi = np.array([np.nan if row.model is None else row.model for row in rows])
    axes.plot(x, chi, marker="D", linestyle="none", color=MODEL, markersize=5, label="model")
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axvline(edge, color=FAINT, linewidth=0.8)
    axes.grid(False, axis="x")
    axes.set_xticks(np.arange(len(names)), names, rotation=45 if len(names) > 12 else 0)
    axes.set(xlim=(-0.5, len(names) - 0.5), xlabel="mother", ylabel=LABELS["chi"])
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(groups) + 1, fontsize=9)
    return figure


def contours(found: ContoursComparison) -> Figure:
    """Measured outlines over the model's; at most six, evenly spread."""
    count = min(len(found.laid), 6)
    chosen = np.unique(np.linspace(0, len(found.laid) - 1, count).round().astype(int))
    figure = _figure(2.1 * len(chosen) + 0.3, 2.3)
    for axes, k in zip(figure.subplots(1, len(chosen), squeeze=False)[0], chosen, strict=True):
        outline, model = found.laid[int(k)]
        # The long axis lies along the second coordinate, and here from left to right.
        axes.fill(model[:, 1], model[:, 0], facecolor=CYTOPLASM, edgecolor=MODEL, linewidth=1.6, label="model")
        axes.fill(outline[:, 1], outline[:, 0], facecolor="none", edgecolor=OBSERVED, linewidth=1.4, label="measured")
        axes.set_aspect("equal")
        axes.axis("off")
        one = found.contours[int(k)]
        axes.set_title(f"t = {one['t']:.3g} τ\n|A∩B|/|A| = {one['overlap']['similarity']:.3f}", fontsize=9, color=MUTED)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, loc="outside lower left", ncols=2, fontsize=9)
    return figure
