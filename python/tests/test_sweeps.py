"""Sweeps from Python and from the command line: the same to the last byte."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import without_commit

import furrow

SWEEP = """Sweep(kind: division, axes: [
    (parameter: "cue", list: ["none", "germline"]),
    (parameter: "r0", range: (from: 1.5, to: 3.0, count: 6)),
], seed: 2)"""


def test_a_sweep_is_that_of_the_command_line(cli, tmp_path, memo):
    (tmp_path / "sweep.ron").write_text(SWEEP)
    cli.text("sweep", "sweep.ron", "--out", "theirs")
    found = furrow.sweep(tmp_path / "sweep.ron", out=tmp_path / "ours", memo=memo)
    for name in ("results.csv", "results.jsonl", "sweep.json"):
        ours, theirs = ((tmp_path / whose / name).read_text() for whose in ("ours", "theirs"))
        assert without_commit(ours) == without_commit(theirs)
    assert found.csv == (tmp_path / "theirs" / "results.csv").read_text()
    axes = {"cue": ["none", "germline"], "r0": np.linspace(1.5, 3.0, 6)}
    again = furrow.sweep(axes=axes, seed=2, memo=memo)
    assert again.csv == found.csv and (again.solved, again.reused) == (0, 12)
    assert found.points == 12 and list(found) == ["cue", "r0", "outcome", "chi", "u_furrow", "t_end", "chi_signed"]
    assert isinstance(found["chi"], np.ndarray) and found["cue"][0] == "none"


def test_a_sweep_agrees_with_single_cells(memo):
    found = furrow.sweep(axes={"r0": [2.0, 2.5], "epsilon": [0.85, 0.87]}, memo=memo)
    for r0, epsilon, chi in zip(found["r0"], found["epsilon"], found["chi"], strict=True):
        assert furrow.Cell(r0, epsilon=epsilon).divide(memo=furrow.Memo()).chi == chi


@pytest.mark.parametrize("kind", ["tree", "pitchfork", "critical"])
def test_other_kinds(cli, tmp_path, memo, kind):
    (tmp_path / "sweep.ron").write_text(f'Sweep(kind: {kind}, axes: [(parameter: "epsilon", list: [0.86, 0.87])])')
    cli.text("sweep", "sweep.ron", "--out", "theirs", "--set", "r0=2.2")
    found = furrow.sweep(axes={"epsilon": [0.86, 0.87]}, kind=kind, r0=2.2, memo=memo)
    assert found.csv == (tmp_path / "theirs" / "results.csv").read_text()


def test_replicates_and_rows_that_are_undecided(memo):
    found = furrow.sweep(axes={"r0": [2.0]}, replicates=3, memo=memo)
    assert found["asymmetric"].tolist() == [3.0] and len(memo) == 3
    odd = furrow.sweep(axes={"t_max": [0.01, 100.0]}, r0=2.0, memo=memo)
    assert set(odd.undecided) == {0} and odd["outcome"][1] == "asymmetric"


def test_tables(memo):
    found = furrow.sweep(axes={"r0": [1.5, 2.0]}, memo=memo)
    assert found.to_dict()["outcome"] == ["failed", "asymmetric"]
    assert found._repr_html_().count("<tr>") == 3
    pandas = pytest.importorskip("pandas")
    assert pandas.isna(found.to_pandas()["chi"][0])


def test_words_of_axes_are_written_as_they_are(memo):
    for cue in ('"), (parameter: "r0', "a\0b\n"):
        with pytest.raises(furrow.InputError, match=r"must be (a field|none, germline)") as refused:
            furrow.sweep(axes={"cue": [cue]}, memo=memo)
        assert refused.value.field.startswith("axes[0].list[0]")


def test_sweeps_have_warnings(memo):
    (size, necks) = furrow.sweep(axes={"r0": [9.0]}, memo=memo).warnings
    assert size.startswith("R0 = 9 L_h is far from the sizes")
    assert necks.startswith("1 division has a second neck that is nearly closed when the first one closes")
    (undecided,) = furrow.sweep(axes={"t_max": [0.01, 100.0]}, r0=2.0, memo=memo).warnings
    assert undecided.startswith("1 of 2 points are undecided, wholly or in part; the first has index 0: ")
    assert furrow.sweep(axes={"r0": [2.0]}, memo=memo).warnings == ()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"axes": {"r0": [2]}, "r0": 3}, "r0"),
        ({"axes": {"eps": [0.8]}, "r0": 2, "epsilon": 0.9}, "epsilon"),
        ({"axes": {"cue": ["none"]}, "cue": "germline", "r0": 2}, "cue"),
        ({"axes": {"r0": [2]}, "shard": (1, 2, 3)}, "shard"),
        ({"axes": {"r0": [2]}, "shard": 3}, "shard"),
        ({"axes": {"r0": np.array(2.0)}}, "axes['r0']"),
    ],
)
def test_arguments_of_sweeps_are_checked(arguments, field):
    with pytest.raises(furrow.InputError) as refused:
        furrow.sweep(**arguments)
    assert refused.value.field == field
