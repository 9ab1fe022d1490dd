"""Calls of every public function and method, for type checkers: nothing here runs."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib.figure
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from typing_extensions import assert_type

import furrow
from furrow import plot

Floats = NDArray[np.float64]


def cells(folder: Path) -> None:
    cell = furrow.Cell(np.float64(2), xi_s=Fraction(20), scheme="published", intervals=np.int64(64), cue="none")
    assert_type(cell.r0, float)
    assert_type(cell.stages, int)
    assert_type(cell.scheme, str)
    assert_type(cell.cue, str)
    assert_type(cell.replace(epsilon=0.8).mirrored().is_mirror_symmetric, bool)
    assert_type(cell.cue_at([0.5], 10)["kappa"], Floats)
    assert_type(cell.parameters(), dict[str, Any])
    division = assert_type(cell.divide(seed=3, frames=0.5, places=4), furrow.Division)
    assert_type(division.chi, float | None)
    assert_type(division.daughters, tuple[float, float] | None)
    assert_type(division.plot(path=folder / "division.png"), matplotlib.figure.Figure)
    if division.frames is not None:
        assert_type(division.frames[0], furrow.Frame)
        assert_type(division.frames[1:], list[furrow.Frame])
        assert_type(division.frames.at(0.3).contour["r"], Floats)
        assert_type(division.frames.to_pandas(), pd.DataFrame)
    if division.surfaces is not None and division.neck is not None:
        assert_type(division.surfaces[0], furrow.SurfaceFrame)
        assert_type(division.surfaces.at(0.3).surface.section, Floats)
        assert_type(division.surfaces.positions, Floats)
        assert_type(division.neck.offset, Floats)
    many = assert_type(cell.divide(replicates=3, threads=2, progress=False), furrow.Replicates)
    assert_type(many[0].chi_signed, float | None)
    assert_type(many.chi_mean, float | None)
    steady = assert_type(cell.steady(azimuthal=2), furrow.Steady)
    assert_type(steady.growth_rates, NDArray[np.complex128])
    assert_type(steady.contour.points, Floats)
    assert_type(steady.surface, furrow.Surface | None)
    assert_type(cell.pitchfork(xi_max=50).xi_s, float)
    branch = assert_type(cell.branch(30, 0.5, azimuthal=2), furrow.Branch)
    assert_type(branch["symmetric"].azimuthal, Floats | None)
    assert_type([crossing.m for crossing in branch.crossings or ()], list[int])
    assert_type(branch.folds, tuple[furrow.Event, ...])
    assert_type(cell.checks(), furrow.Checks)
    assert_type(cell.critical_radius(), furrow.CriticalRadius)
    boundary = assert_type(cell.boundary("r0", 1.9, 2, folds=False, critical=True, azimuthal=1), furrow.Boundary)
    boundary.save(folder / "boundary.svg")
    assert_type(boundary.critical, float | None)
    assert_type(cell.phase("r0", 1.6, 2.4, points=2, xi_s=(5, 30)).to_pandas(), pd.DataFrame)
    assert_type(cell.perturb(until=5)[0].returned, bool)
    cell.movie(folder / "division.gif", frames=10)
    cell.write_frames(folder / "frames", every=0.5)
    assert_type(cell.draw().png(), bytes)


def trees(folder: Path, memo: furrow.Memo) -> None:
    tree = assert_type(furrow.tree("mine.ron", r0="17um", epsilon=0.86, memo=memo, progress=print), furrow.Tree)
    assert_type(tree["AB"].daughters, tuple[str, ...])
    assert_type(tree.founders[0], furrow.Founder)
    assert_type(tree.alive()[0], Floats)
    assert_type(tree.to_pandas(), pd.DataFrame)
    assert_type(tree.export("csv", path=folder / "tree.csv"), None)
    tree.save(folder / "tree.html")
    assert_type(furrow.read_tree(folder / "tree.json") == tree, bool)
    assert_type(furrow.scenarios(["a.ron"], cues=["none"])["a-none"], furrow.Tree)
    assert_type(furrow.tree_ensemble(replicates=3).members, int)

    def rule(born: furrow.NewCell) -> furrow.Cell | None:
        return None if born.mother is None else born.mother.replace(r0=born.r0)

    assert_type(furrow.grow(furrow.Cell(2.4), rule, max_depth=3), furrow.Tree)
    assert_type(furrow.tree_schema(), dict[str, Any])
    furrow.new_lineage(folder / "new.ron")
    assert_type(furrow.explore(folder / "page.html", r0=5), int)


def many(folder: Path) -> None:
    found = assert_type(furrow.sweep(axes={"r0": np.linspace(1, 2, 3), "cue": ["none"]}, shard=(1, 2)), furrow.Sweep)
    assert_type(found.undecided, dict[int, str])
    assert_type(furrow.merge([folder / "1"], out=folder / "all"), int)
    assert_type(furrow.solve("epsilon", chi=0.4, r0=2, range=(0.8, 0.9)), dict[str, Any])
    assert_type(furrow.polarity(par={"psi": "shape", "d_p": np.float32(0.1)}).to_pandas(), pd.DataFrame)
    assert_type(furrow.reproduce("2A", out=folder), furrow.Reproduction)
    assert_type(furrow.use_store(folder, r0_step=0.0), furrow.Memo)
    assert_type(furrow.memo().store is None, bool)
    assert_type(furrow.cache.stat(folder), dict[str, Any])
    assert_type(furrow.cache.verify(folder, repair=True), dict[str, Any])
    assert_type(furrow.cache.clear(folder), dict[str, Any])
    assert_type(furrow.presets(), list[str])
    assert_type(furrow.parameter_names(), list[tuple[str, str]])
    solved = furrow.bvp.solve_bvp(lambda x, y, p: p[0] * y, lambda ya, yb, p: ya - 1, [0, 1], [[1, 1]], p=[1], tol=1e-9)
    assert_type(solved, furrow.bvp.Solution)
    assert_type(solved.sol([0.5], nu=1), Floats)
    assert_type(solved.rms_residuals, Floats)
    assert_type((solved.status, solved.message, solved.success), tuple[int, str, bool])
    assert_type(solved["x"], Any)
    singular = furrow.bvp.solve_bvp(
        lambda x, y: y, lambda ya, yb: ya, [0, 1], [[1, 1]], None, [[-1]], verbose=1, bc_tol=1e-9, besides=[solved]
    )
    assert_type(singular.keys(), list[str])


def observed(table: pd.DataFrame, tree: furrow.Tree, outlines: list[Floats]) -> None:
    constants = assert_type(furrow.ensemble("statements.ron", 100, unknowns=["aspect"]), furrow.Constants)
    assert_type(constants["aspect"], Floats)
    assert_type(furrow.calibrate("thresholds.ron", xi_s=20).parameters, dict[str, float])
    assert_type(furrow.front("statements.ron", 40).to_pandas(), pd.DataFrame)
    volumes = furrow.compare.volumes(table, population=["Mac"], constants=constants, length_scale="fit")
    assert_type(volumes.mothers, tuple[furrow.compare.Mother, ...])
    assert_type(furrow.compare.counts(tree, measured="embryo.zip"), furrow.compare.Counts)
    exported = furrow.export_observed("embryo.xml", "newick", root="Track_1=P0", subtree="AB")
    assert_type(exported, str | dict[str, str] | dict[str, bytes] | None)
    assert_type(furrow.compare.lifetimes({"cell": ["AB"], "lifetime_min": [15]}, tree=tree), furrow.compare.Lifetimes)
    assert_type(furrow.compare.dose(bins=[0, 1], r0=5), furrow.compare.Dose)
    laid = furrow.compare.contours(outlines, furrow.Cell(4).divide(frames=True))
    assert_type(laid.similarity_sd, float | None)
    assert_type(furrow.fit.constants(particles=2).ron, str)
    assert_type(furrow.fit.activity(rounds="max", range=(20, 30)), furrow.fit.Activities)
    assert_type(furrow.fit.cue("activity:step,u0=0.5,omega=0.1,amplitude=0.1").cue, str)
    assert_type(furrow.fit.clock(table, frame_minutes=2).ron, str)
    tested = furrow.test(table, ["none", "germline"], free=["cue.amplitude"], noise="given", folded=True, cells=["P0"], voxel=1)
    assert_type(tested, furrow.Hypotheses)
    sampled = furrow.test(table, ["germline"], free=["cue.amplitude"], class_columns=["class"], samples=20, shard=(1, 2))
    assert_type(sampled.save_samples("part.csv"), None)
    for rows in (tested.to_pandas(), tested.pairs_to_pandas(), tested.cells_to_pandas()):
        assert_type(rows, pd.DataFrame)


def pictures(tree: furrow.Tree, ranges: furrow.Ranges, division: furrow.Division, axes: Any) -> None:
    assert_type(plot.division(division), matplotlib.figure.Figure)
    plot.branch(furrow.Cell(2).branch())
    plot.rounds(tree)
    plot.ranges(ranges)
    plot.volumes(furrow.compare.volumes())
    plot.contours(furrow.compare.contours([], division))
    plot.saved(tree.plot(), "tree.png")
    plot.style(axes)
    plot.title_of(division)
    if division.frames is not None:
        plot.contour(axes, division.frames[0])
