"""Cells without axial symmetry, beside those of the command line: the same to the last bit."""

from __future__ import annotations

import json
import math
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import furrow

COARSE = {"modes": 2, "elements": 32}
ONE_SIDED = "tension:gradient,amplitude=1,at=0,spread=1"
OPTIONS = ("--three-dimensional", "--modes", "2", "--set", "elements=32")


@pytest.fixture(scope="module")
def divided() -> furrow.Division:
    return furrow.Cell(2.5, **COARSE).divide(frames=0.25)


def test_states_at_rest_are_those_of_the_command_line(cli):
    theirs = cli.json("steady", "--r0", "1", *OPTIONS)
    ours = furrow.Cell(1, **COARSE).steady()
    for name in ("L", "p", "H", "r_eq", "stable", "growth_rate", "neck_offset", "modes"):
        assert getattr(ours, name) == theirs.get(name), name
    assert ours.to_dict()["growth_rates"] == [[rate["re"], rate["im"]] for rate in theirs["growth_rates"]]
    assert ours.stable and ours.growth_rate == ours.growth_rates[0].real < 0
    # It is bent, but close to the axisymmetric shape.
    even = furrow.Cell(1).steady()
    np.testing.assert_allclose([ours.L, ours.H, ours.r_eq], [even.L, even.H, even.r_eq], rtol=3e-3)
    assert 0.05 < ours.neck_offset < 0.15
    assert even.surface is None and even.modes is None
    poles = ours.surface.positions[[0, -1], 0, 2]
    assert (poles[0] - poles[1]) / ours.cell.r0 == pytest.approx(ours.H, rel=1e-9)
    assert not hasattr(ours, "contour") and ours.to_dict()["contour"] is None
    assert len(ours.to_dict()["surface"]["tension"]) == 129
    assert pickle.loads(pickle.dumps(ours)).growth_rate == ours.growth_rate


def test_a_cell_that_divides_has_no_state_at_rest(cli):
    with pytest.raises(furrow.NoOutcome, match=r"no state at rest without axial symmetry: the cell divides at t") as found:
        furrow.Cell(2.5, **COARSE).steady()
    command = [str(cli.program), "steady", "--r0", "2.5", *OPTIONS]
    said = subprocess.run(command, check=False, capture_output=True, text=True, encoding="utf-8")
    assert said.returncode == 1 and str(found.value) in said.stderr


def test_divisions_and_necks_are_those_of_the_command_line(cli, divided):
    theirs = cli.json("divide", "--r0", "2.5", *OPTIONS)
    for name in ("outcome", "chi", "chi_signed", "u_furrow", "t_end", "neck_offset", "modes", "steps"):
        assert getattr(divided, name) == theirs.get(name), name
    assert divided.to_dict()["neck"] == theirs["neck"]
    assert len(divided.neck) == len(divided.neck.to_pandas()) > 50
    # The frames are fewer, and the memo does not change them.
    assert len(divided.surfaces) < 10 and divided.frames is None
    again = furrow.Cell(2.5, **COARSE).divide(frames=True)
    assert again == divided and again.neck.radius.tolist() == divided.neck.radius.tolist()
    known = ~np.isnan(again.surfaces.neck_radius[1:])
    assert again.surfaces.neck_radius[1:][known].tolist() == divided.neck.radius.tolist()
    assert len(again.surfaces) == again.steps + 1
    assert furrow.Cell(2.5, **COARSE).divide().neck is None


def test_surfaces_are_closed_and_have_the_volume_of_the_cell(divided):
    frames = divided.surfaces
    assert frames.t[:3].tolist() == [0, 0.25, 0.5]
    assert frames.positions.shape == (len(frames), 129, 64, 3) == frames.normals.shape
    assert frames.tension.shape == (len(frames), 129, 64) and frames.u.shape == (len(frames), 129)
    frame = frames.at(0.5)
    surface = frame.surface
    assert surface.positions.base is frames[0].surface.positions.base is not None
    assert (surface.u[0], surface.u[-1]) == (0, 1) and np.all(np.diff(surface.u) > 0)
    assert np.ptp(surface.positions[0], axis=0).max() == 0 and surface.positions[0, 0, 2] > 0 > surface.positions[-1, 0, 2]
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=-1), 1, atol=1e-12)
    # V = ∫ x · dA / 3 over quadrilaterals; the area of each is half the cross product of its diagonals.
    x = np.concatenate((surface.positions, surface.positions[:, :1]), axis=1)
    corners = np.array([x[:-1, :-1], x[1:, 1:], x[:-1, 1:], x[1:, :-1]])
    areas = 0.5 * np.cross(corners[1] - corners[0], corners[2] - corners[3])
    volume = np.sum(corners.mean(axis=0) * areas) / 3
    assert volume == pytest.approx(4 / 3 * math.pi * 2.5**3, rel=0.01)
    assert frame.chi is not None and 0 < frame.neck_radius < 2.5 and frames.to_pandas()["t"].tolist() == frames.t.tolist()
    assert surface.section.shape == (258, 2) and surface.section[0].tolist() == surface.section[-1].tolist()
    assert pickle.loads(pickle.dumps(divided)).surfaces[1].t == 0.25


def test_files_are_those_of_the_command_line(cli, tmp_path, divided):
    cell = divided.cell
    cell.movie(tmp_path / "ours.gif", frames=2)
    cell.draw().save(tmp_path / "ours.svg")
    for name in ("ours.ply", "ours.glb"):
        cell.write_frames(tmp_path / name, every=0.5)
    pictures = ("--movie", "theirs.gif", "--movie-frames", "2", "--plot", "theirs.svg")
    for name, more in (("theirs.ply", pictures), ("theirs.glb", ())):
        cli.text("divide", "--r0", "2.5", *OPTIONS, "--frames", name, "--frame-step", "0.5", *more)
    listed = json.loads((tmp_path / "ours.json").read_text())
    assert [frame["t"] for frame in listed] == [0, 0.5, divided.surfaces.t[-1]]
    assert listed[1]["neck_offset"] == divided.surfaces.at(0.5).neck_offset
    for name in ("ours.gif", "ours.svg", "ours.glb", *(frame["file"] for frame in listed)):
        assert (tmp_path / name).read_bytes() == (tmp_path / name.replace("ours", "theirs")).read_bytes(), name


def test_bent_states_are_those_of_the_command_line(cli):
    cell = furrow.Cell(1.4, **COARSE)
    theirs = cli.json("branch", "--r0", "1.4", "--xi-max", "30", *OPTIONS)
    ours = cell.branch(30.0)
    assert ours.bent == theirs["bent"] and ours["bent"].xi_s.max() == pytest.approx(ours.bent["fold"]["xi_s"], abs=0.01)
    assert furrow.Cell(1.4).branch(30.0).bent is None
    options = ("--vary", "r0", "--from", "1.4", "--to", "1.45", "--no-folds", "--critical", *OPTIONS)
    theirs = cli.json("boundary", *options)
    assert cell.boundary("r0", 1.4, 1.45, folds=False, critical=True)["bent"] == theirs["bent"]
    assert cell.critical_radius().r0 == theirs["bent"]["critical"]
    phase = ("--vary", "r0", "--from", "1.4", "--to", "1.4", "--points", "1", "--xi-from", "20", "--xi-points", "1")
    theirs = cli.json("phase", *phase, *OPTIONS)
    assert [edge["kind"] for edge in theirs["columns"][0]["edges"]] == []
    assert theirs["cells"][0]["outcome"] == "failed" and theirs["cells"][0]["by"] == "curves"
    assert cell.phase("r0", 1.4, 1.4, points=1, xi_s=(20.0, 20.0), xi_points=1)["cells"] == theirs["cells"]


def test_pictures_of_surfaces(divided, tmp_path):
    pytest.importorskip("matplotlib")
    figure = divided.plot(path=tmp_path / "sections.png")
    assert (tmp_path / "sections.png").stat().st_size > 20_000
    assert "without axial symmetry: symmetric" in figure._suptitle.get_text()
    lines = {line.get_label(): line for line in figure.axes[-1].get_lines()}
    distance = lines["neck's distance from the axis / R₀"].get_ydata()
    assert distance[-1] == abs(divided.surfaces.neck_offset[-1]) / 2.5


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda cell: cell.steady(azimuthal=2), "those of all modes"),
        (lambda cell: cell.divide(frames=True, places=3), "rings and meridians"),
        (lambda cell: cell.divide(frames="often"), "True, False or a number"),
        (lambda cell: cell.divide(frames=-1.0), "above 0"),
        (lambda cell: cell.divide(frames=True, replicates=2), "False with replicates"),
        (lambda cell: cell.write_frames("contours"), r"ends in \.ply or \.glb: without axial symmetry"),
        (lambda cell: cell.pitchfork(), "must be 0"),
        (lambda cell: cell.boundary("aspect", 1.3, 1.4), "r0 or epsilon without axial symmetry"),
        (lambda cell: furrow.Cell(2.0, shell_flattening=0.9), "1 for cells with axial symmetry"),
        (lambda cell: furrow.tree(cue=ONE_SIDED), "without at=PHI for cells with axial symmetry"),
        (lambda cell: furrow.Cell(2.0, cue=ONE_SIDED), "without at=PHI for"),
    ],
)
def test_what_surfaces_do_not_have_is_refused(call, said):
    with pytest.raises(furrow.InputError, match=said):
        call(furrow.Cell(2.5, **COARSE))


def test_computations_with_axial_symmetry_refuse_modes(tmp_path):
    data = Path(__file__).resolve().parents[2] / "data"
    for call in (
        lambda: furrow.polarity(modes=4),
        lambda: furrow.calibrate(data / "thresholds.ron", modes=4),
        lambda: furrow.ensemble(data / "statements.ron", 2, modes=4),
        lambda: furrow.front(data / "statements.ron", 2, modes=4),
        lambda: furrow.test({"mother": ["P0"], "chi": [0.1]}, ["none"], modes=4),
        lambda: furrow.fit.activity(modes=4),
        lambda: furrow.fit.cue(modes=4),
        lambda: furrow.fit.constants(modes=4),
        lambda: furrow.explore(tmp_path / "page.html", modes=4),
        lambda: furrow.sweep(axes={"r0": [2]}, kind="pitchfork", modes=4),
    ):
        with pytest.raises(furrow.InputError, match="must be 0: only divisions") as refused:
            call()
        assert (refused.value.field, refused.value.value, refused.value.source) == ("modes", 4, "furrow")
    assert not (tmp_path / "page.html").exists()
