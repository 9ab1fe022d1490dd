"""Boundaries, phase diagrams, disturbed shapes and polarity, beside those of the command line."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import furrow


def test_boundaries_are_those_of_the_command_line(cli):
    ours = furrow.Cell(2.0).boundary("r0", 1.7, 1.75, folds=False, critical=True)
    theirs = cli.json("boundary", "--vary", "r0", "--from", "1.7", "--to", "1.75", "--no-folds", "--critical")
    assert ours.to_dict() == theirs
    assert ours.critical == pytest.approx(furrow.Cell(2.0).critical_radius().r0, abs=1e-9)
    assert ours.to_pandas()["xi_s"].tolist() == [point["xi_s"] for point in theirs["pitchfork"]]


def test_pictures_are_drawn_saved_and_pickled(tmp_path):
    found = furrow.Cell(2.0).boundary("r0", 1.9, 2.0, folds=False)
    found.save(tmp_path / "boundary.png")
    assert (tmp_path / "boundary.png").read_bytes().startswith(b"\x89PNG")
    assert "Where division begins" in found.drawing.svg()
    again = pickle.loads(pickle.dumps(found))
    assert again.to_dict() == found.to_dict() and again.drawing.svg() == found.drawing.svg()
    with pytest.raises(furrow.InputError, match=r"ends in \.svg, \.pdf or \.png"):
        found.save(tmp_path / "boundary.bmp")


def test_phase_diagrams_are_those_of_the_command_line(cli, memo):
    ours = furrow.Cell(2.0).phase("r0", 1.6, 2.4, points=2, xi_points=2, memo=memo)
    theirs = cli.json("phase", "--vary", "r0", "--from", "1.6", "--to", "2.4", "--points", "2", "--xi-points", "2")
    assert ours.to_dict() == theirs
    assert set(ours.to_pandas()["by"]) == {"curves", "division"}


def test_disturbed_shapes_are_those_of_the_command_line(cli):
    ours = furrow.Cell(2.0, xi_s=20).perturb(3, until=5.0)
    theirs = cli.json("divide", "--r0", "2", "--xi", "20", "--from-steady", "--until", "5", "--seed", "3")
    assert ours[0].returned == theirs["returned"]
    assert np.column_stack((ours[0].t, ours[0].distance)).tolist() == theirs["dis"]
    assert ours[0].start_growth_rate == theirs["start_growth_rate"]


def test_polarity_is_that_of_the_command_line(cli):
    ours = furrow.polarity(r0=5.4, amplitude=0.2)
    assert ours.to_dict() == cli.json("polarity", "--r0", "5.4", "--amplitude", "0.2")
    assert ours.profiles_to_pandas()["p"].max() > 0.5


def test_movies_and_frames_are_those_of_the_command_line(cli, tmp_path):
    cell = furrow.Cell(2.5)
    cell.movie(tmp_path / "ours.gif", frames=2)
    cell.write_frames(tmp_path / "ours", every=0.5)
    cli.text("divide", "--r0", "2.5", "--movie", "theirs.gif", "--movie-frames", "2", "--frames", "theirs", "--frame-step", "0.5")
    assert (tmp_path / "ours.gif").read_bytes() == (tmp_path / "theirs.gif").read_bytes()
    names = sorted(path.name for path in (tmp_path / "ours").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "theirs").iterdir()) and len(names) > 3
    assert all((tmp_path / "ours" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes() for name in names)


@pytest.mark.parametrize(
    "call",
    [
        lambda: furrow.Cell(2).boundary("xi_s", 1, 2),
        lambda: furrow.Cell(2).boundary("r0", 2, 2),
        lambda: furrow.Cell(2).boundary("r0", -1, 2),
        lambda: furrow.Cell(2).boundary("cue.u0", 0.1, 0.2),
        lambda: furrow.Cell(2).boundary("r0", 1, 2, azimuthal=17),
        lambda: furrow.Cell(2).phase("r0", 1, 2, points=0),
        lambda: furrow.Cell(2).phase("r0", 1, 2, xi_s=(-1, 2)),
        lambda: furrow.Cell(2).movie("movie.mp4"),
        lambda: furrow.Cell(2).movie("movie.gif", frames=1),
        lambda: furrow.Cell(2).perturb(replicates=0),
        lambda: furrow.polarity(profile="steep"),
        lambda: furrow.polarity(par={"d_q": 1}),
        lambda: furrow.fit.activity(range=(3, 2)),
        lambda: furrow.fit.constants("nowhere.ron"),
        lambda: furrow.fit.cue("none"),
        lambda: furrow.reproduce("9Z"),
        lambda: furrow.merge([], out="whole"),
        lambda: furrow.tree_ensemble(),
        lambda: furrow.tree_ensemble(replicates=1),
        lambda: furrow.sweep(axes={"r0": [2.0]}, shard=(3, 2)),
        lambda: furrow.grow(furrow.Cell(2.4), lambda cell: 3),
    ],
)
def test_bad_arguments_are_refused(call):
    with pytest.raises(furrow.InputError):
        call()
