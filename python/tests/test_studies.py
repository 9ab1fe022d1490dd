"""Constants from thresholds."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import REPOSITORY

import furrow


def test_constants_are_those_of_the_command_line(cli):
    targets = REPOSITORY / "data" / "thresholds.ron"
    theirs = cli.json("calibrate", str(targets), "--set", "intervals=32")
    ours = furrow.calibrate(targets, intervals=32)
    assert ours.parameters == theirs["parameters"] and ours.rms == theirs["rms"]
    assert [row["computed"] for row in ours.residuals] == [row["computed"] for row in theirs["residuals"]]
    assert len(ours.excluded) == len(theirs["excluded"])
    assert furrow.calibrate(targets.read_text(), intervals=32) == ours


def test_a_front_is_that_of_the_command_line(cli, tmp_path):
    targets = """Targets(
        unknowns: [(parameter: aspect, start: 1.5), (parameter: p0, start: 0.123)],
        thresholds: [(r0: 2.0, epsilon: 0.87, xi_s: 22.006), (r0: 2.22, epsilon: 0.88, xi_s: 21.94)],
        divisions: [(r0: 1.64, outcome: failed)],
        criticalities: [(r0: 2.22, epsilon: 0.88, kind: subcritical)],
    )"""
    (tmp_path / "targets.ron").write_text(targets)
    theirs = cli.json("calibrate", "targets.ron", "--front", "6", "--seed", "3", "--set", "intervals=32")
    found = furrow.front(targets, 6, seed=3, intervals=32)
    assert found.to_dict() == theirs
    rows = found.to_pandas()
    assert rows["met"].tolist() == [member["met"] for member in found["members"]] and found["statements"] == 2
    # The thresholds of a set equal the thresholds of cells with its constants.
    first = found["members"][0]
    cell = furrow.Cell(2.0, epsilon=0.87, intervals=32, **dict(zip(found["parameters"], first["values"], strict=True)))
    assert cell.pitchfork().xi_s == pytest.approx(first["thresholds"][0], rel=1e-9)


def test_an_ensemble_is_that_of_the_command_line(cli, tmp_path):
    targets = """Targets(
        unknowns: [(parameter: aspect, start: 1.5), (parameter: p0, start: 0.123)],
        thresholds: [(r0: 2.0, epsilon: 0.87, xi_s: 22.006), (r0: 2.22, epsilon: 0.88, xi_s: 21.94)],
    )"""
    (tmp_path / "targets.ron").write_text(targets)
    options = ("--set", "intervals=32", "--set", "stages=3")
    cli.text("calibrate", "targets.ron", "--ensemble", "4", "--seed", "3", "--out", "constants.csv", *options)
    found = furrow.ensemble(targets, 4, seed=3, intervals=32, stages=3)
    assert found.csv == (tmp_path / "constants.csv").read_text()
    assert found.parameters == ("aspect", "p0") and found["p0"].shape == (4,)
    assert np.isclose(found.weights.sum(), 1.0)
    grown = furrow.tree_ensemble('(name: "S", founders: [(name: "S", r0: 2.2)])', constants=found)
    assert grown.members == 4


def test_impossible_targets_are_refused():
    with pytest.raises(furrow.InputError):
        furrow.calibrate("Targets(unknowns: [], thresholds: [])")
    with pytest.raises(furrow.InputError) as refused:
        furrow.ensemble("nowhere.ron", 3)
    assert refused.value.source == "nowhere.ron"
    with pytest.raises(furrow.InputError):
        furrow.ensemble("nowhere.ron", 0)
