"""Constants, activities and a cue fitted to a small lineage, beside the command line."""

from __future__ import annotations

import pytest

import furrow

#: A lineage and observations that are fitted fast.
LINEAGE = '(name: "S", founders: [(name: "S", r0: 2.2, observed: (mean: 1, terminal: 2))], limits: (max_depth: 1))'
#: The same lineage with a cue of its founder that a fit replaces.
RINGED = LINEAGE.replace("founders:", 'cues: {"ring": "kappa:u0=0.45,omega=0.2,amplitude=0.1"}, founders:').replace(
    "r0: 2.2,", 'r0: 2.2, cue: "ring",'
)
TARGETS = """Fit(
    unknowns: [(parameter: aspect, from: 1.4, to: 1.6), (parameter: xi_s, from: 22, to: 28)],
    founders: ["S"],
    chi: [(cell: "S", mean: 0.2, sd: 0.02)],
    thresholds: [(r0: 2.0, epsilon: 0.87, xi_s: 22.006)],
)"""
SEARCH = ("--particles", "2", "--moves", "1", "--seed", "3", "--set", "intervals=32")
CUE = "activity:step,u0=0.5,omega=0.1,amplitude=0.1"


@pytest.fixture
def files(cli):
    """The command line, with the files that it reads."""
    (cli.folder / "lineage.ron").write_text(LINEAGE)
    (cli.folder / "ringed.ron").write_text(RINGED)
    (cli.folder / "targets.ron").write_text(TARGETS)
    return cli


def test_constants_are_those_of_the_command_line(files, memo):
    options = ("--targets", "targets.ron", "--lineage", "lineage.ron", "--out", "best.ron")
    theirs = files.json("fit", "constants", *options, *SEARCH)
    ours = furrow.fit.constants(TARGETS, lineage=LINEAGE, particles=2, moves=1, seed=3, intervals=32, memo=memo)
    assert ours.to_dict() == {name: theirs[name] for name in ours}
    assert set(theirs) - set(ours) <= {"seed", "elapsed_s"}
    assert ours.ron == (files.folder / "best.ron").read_text()
    # The gain meets the threshold and no search changes it; the misfit follows from the residuals.
    assert furrow.Cell(2.0, config=files.folder / "best.ron", intervals=32).pitchfork().xi_s == pytest.approx(22.006, rel=1e-6)
    (chi,) = (row for row in ours["residuals"] if row["quantity"] == "chi")
    assert abs(chi["computed"] - chi["observed"]) == pytest.approx(ours["best"]["parts"]["chi"], abs=1e-12)
    assert ours.to_pandas()["founder"].tolist() == ["S"] * 3 and "<svg" in ours.drawing.svg()


def test_a_cue_is_that_of_the_command_line(files, memo):
    options = ("--targets", "targets.ron", "--lineage", "ringed.ron", "--cue", CUE, "--set", "intervals=32")
    theirs = files.json("fit", "cue", *options, "--particles", "4", "--moves", "2")
    ours = furrow.fit.cue(CUE, targets=TARGETS, lineage=RINGED, particles=4, moves=2, intervals=32, memo=memo)
    assert ours.to_dict() == {name: theirs[name] for name in ours}
    assert set(theirs) - set(ours) <= {"seed", "elapsed_s"}
    # χ depends on the cue enough to be met, and a cell with the fitted cue divides as the fit says.
    (row,) = ours["residuals"]
    assert row["computed"] == pytest.approx(0.2, abs=1e-4)
    division = furrow.Cell(row["r0"], cue=ours.cue, intervals=32).divide(memo=furrow.Memo())
    assert division.chi == pytest.approx(row["computed"], abs=1e-6)
    assert ours.to_pandas()["measured"].tolist() == [0.2]


def test_activities_are_those_of_the_command_line(files, memo):
    theirs = files.json("fit", "activity", "--lineage", "lineage.ron", "--xi-from", "20", "--xi-to", "30")
    ours = furrow.fit.activity(lineage=LINEAGE, range=(20, 30), rounds="mean", memo=memo)
    assert ours.to_dict() == {name: theirs[name] for name in ours}
    (founder,) = ours["founders"]
    assert founder["observed"] == 1 and founder["searched"] == [20, 30]
    assert ours.to_pandas()["name"].tolist() == ["S"] and "<svg" in ours.drawing.svg()
