"""Measured embryos beside the model, from Python and from the command line."""

from __future__ import annotations

import numpy as np
import pytest

import furrow

TABLE = {
    "embryo": ["1", "1", "1", "1", "1", "1", "2", "2"],
    "cell": ["AB", "P1", "EMS", "P2", "ABa", "ABp", "AB", "P1"],
    "volume_um3": [14000.0, 9500.5, 5600.0, 3900.0, 7100.0, 6900.0, 13500.0, 10000.0],
}


def test_volumes_are_compared_as_by_the_command_line(cli, tmp_path, memo):
    lines = [",".join(TABLE), *(f"{e},{c},{v!r}" for e, c, v in zip(*TABLE.values(), strict=True))]
    (tmp_path / "volumes.csv").write_text("\n".join(lines) + "\n")
    theirs = cli.json("compare", "volumes", "volumes.csv")
    ours = furrow.compare.volumes(tmp_path / "volumes.csv", memo=memo)
    assert ours.to_dict()["groups"] == theirs["groups"] and ours.used == theirs["used"]
    assert ours.length_scale == theirs["length_scale"]["length"]
    assert furrow.compare.volumes(TABLE, memo=memo).mothers == ours.mothers
    pandas = pytest.importorskip("pandas")
    assert furrow.compare.volumes(pandas.DataFrame(TABLE), memo=memo).mothers == ours.mothers
    p0 = next(mother for mother in ours.mothers if mother.mother == "P0")
    assert (p0.n, p0.model_outcome) == (2, "asymmetric") and 0.15 < p0.measured < 0.2
    assert ours.to_pandas()["mother"].tolist() == [mother.mother for mother in ours.mothers]


def test_without_a_table_there_are_published_means(cli, memo):
    theirs = cli.json("compare", "volumes")
    assert furrow.compare.volumes(memo=memo).to_dict()["groups"] == theirs["groups"]


def test_volumes_that_cannot_be_used(memo):
    with pytest.raises(furrow.InputError):
        furrow.compare.volumes({"embryo": ["1"], "cell": ["AB", "P1"]}, memo=memo)
    with pytest.raises(furrow.InputError):
        furrow.compare.volumes({"colour": ["red"]}, memo=memo)
    some = furrow.compare.volumes({**TABLE, "volume_um3": [*TABLE["volume_um3"][:-1], float("nan")]}, memo=memo)
    assert len(some.skipped) == 1 and some.used == 7


def test_counts_are_compared_as_by_the_command_line(cli, memo):
    theirs = cli.json("compare", "counts")
    ours = furrow.compare.counts(furrow.tree(memo=memo))
    assert ours.to_dict() == theirs
    assert set(ours.to_pandas()["founder"]) >= {"AB", "P4"}


def test_an_outline_of_the_model_is_found_again():
    division = furrow.Cell(r0=4, cue="germline").divide(frames=True)
    half = division.frames[40].contour.points
    ring = 7.3 * np.concatenate((half, half[::-1] * [-1, 1]))
    angle = 0.4
    turned = ring @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) + [100, -50]
    found = furrow.compare.contours([turned], division)
    assert found.contours[0]["frame"] == "40" and found.similarity > 0.995
    assert np.isclose(found.length_scale, 7.3, rtol=1e-3)
    assert found.laid[0][0].shape[1] == 2
    for bad in ([[[0, 0], [1, 1]]], [[1, 2, 3]], [["a"]], [np.full((5, 2), np.nan)], []):
        with pytest.raises(furrow.InputError):
            furrow.compare.contours(bad, division)
    with pytest.raises(furrow.InputError):
        furrow.compare.contours([ring], furrow.Cell(r0=2).divide())
