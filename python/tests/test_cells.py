"""One cell from Python and from the command line: the same to the last bit."""

from __future__ import annotations

import csv
import io
import json
import math
import pickle

import numpy as np
import pytest

import furrow


@pytest.mark.parametrize(
    ("arguments", "cell", "seed"),
    [
        (("--r0", "5.4", "--cue", "germline"), {"r0": 5.4, "cue": "germline"}, 0),
        (("--r0", "2", "--seed", "7"), {"r0": 2}, 7),
        (("--r0", "1.5"), {"r0": 1.5}, 0),
        (("--r0", "3", "--set", "scheme=published", "--xi", "24"), {"r0": 3, "scheme": "published", "xi": 24}, 0),
        (("--r0", "4", "--preset", "sulston1983", "--set", "xi_b=-3"), {"r0": 4, "preset": "sulston1983", "xi_b": -3}, 0),
    ],
)
def test_divisions_are_those_of_the_command_line(cli, memo, arguments, cell, seed):
    theirs = cli.json("divide", *arguments)
    ours = furrow.Cell(**cell).divide(seed, memo=memo)
    for name in ("outcome", "chi", "chi_signed", "u_furrow", "t_end", "growth_rate", "steps", "newton_iterations"):
        assert getattr(ours, name) == theirs.get(name), name
    assert ours.daughters == (None if theirs["daughters"] is None else tuple(theirs["daughters"]))
    assert ours.divided == (theirs["outcome"] != "failed")


def test_frames_are_those_of_the_command_line(cli, tmp_path):
    cli.text("divide", "--r0", "4", "--cue", "germline", "--frames", "out")
    listed = json.loads((tmp_path / "out" / "frames.json").read_text())
    frames = furrow.Cell(r0=4, cue="germline").divide(frames=True).frames
    assert frames.t.tolist() == [frame["t"] for frame in listed]
    for k in (0, 20, len(listed) - 1):
        with (tmp_path / "out" / listed[k]["file"]).open() as file:
            rows = list(csv.DictReader(file))
        for name in furrow.PLACE_COLUMNS:
            assert frames[k].contour[name].tolist() == [float(row[name]) for row in rows], (k, name)
        assert frames[k].neck_radius == listed[k]["neck_radius"]


def test_frames_are_views_of_what_was_computed():
    frames = furrow.Cell(r0=2.5).divide(frames=True).frames
    assert frames[3].contour.r.base is frames[4].contour.r.base is not None
    assert len(frames[-3:]) == 3
    assert frames.at(0.3).t == frames.t[np.argmin(abs(frames.t - 0.3))]
    assert sum(len(frame.contour) for frame in frames) == len(frames[0].contour.r.base)
    with pytest.raises(IndexError):
        frames[len(frames)]
    even = furrow.Cell(r0=2.5).divide(frames=0.25).frames
    assert even.t[:3].tolist() == [0.0, 0.25, 0.5]
    dense = furrow.Cell(r0=2.5).divide(frames=0.25, places=12).frames
    assert len(dense[0].contour) > 2 * len(even[0].contour)


def test_forces_balance_along_a_contour():
    contour = furrow.Cell(r0=4, cue="germline").divide(frames=0.3).frames[1].contour
    parts = sum(contour[f"{name}_n"] for name in ("active", "viscous", "elastic", "pressure", "shell"))
    np.testing.assert_allclose(parts, contour["residual_n"], atol=1e-9)
    assert contour["u"][0] == 0.0 and contour["u"][-1] == 1.0
    # The pole u = 0 is the posterior one, at z > 0.
    assert contour.z[0] > 0 > contour.z[-1]


def test_stationary_shapes_are_those_of_the_command_line(cli):
    theirs = cli.json("steady", "--r0", "2", "--xi", "15", "--epsilon", "0.8")
    ours = furrow.Cell(r0=2, xi_s=15, epsilon=0.8).steady()
    for name in ("L", "p", "H", "r_eq", "stable", "growth_rate"):
        assert getattr(ours, name) == theirs[name], name
    assert [rate.real for rate in ours.growth_rates] == [rate["re"] for rate in theirs["growth_rates"]]
    assert ours.growth_rate_uncertainty == theirs["growth_rate_uncertainty"] < 1e-4
    assert list(ours.parities) == [rate["parity"] for rate in theirs["growth_rates"]]


def test_growth_rates_beyond_axial_symmetry_are_those_of_the_command_line(cli):
    theirs = cli.json("steady", "--r0", "2", "--xi", "15", "--azimuthal", "2")["azimuthal"]
    cell = furrow.Cell(r0=2, xi_s=15)
    ours = cell.steady(azimuthal=2)
    assert list(ours.azimuthal) == theirs and [row["m"] for row in theirs] == [0, 1, 2]
    assert ours.azimuthal[0]["growth_rate"] == ours.growth_rate and ours.to_dict()["azimuthal"] == theirs
    assert cell.steady().azimuthal is None
    for bad in (-1, 17, 1.5):
        with pytest.raises(furrow.InputError) as refused:
            cell.steady(azimuthal=bad)
        assert refused.value.field == "azimuthal"


CARRIED = "regulator:none,turnover=10,diffusion=1,activity=0.3"


def test_a_regulator_is_that_of_the_command_line(cli, tmp_path):
    theirs = cli.json("steady", "--r0", "1.65", "--cue", CARRIED)
    cell = furrow.Cell(r0=1.65, cue=CARRIED)
    ours = cell.steady()
    assert ours.regulator == theirs["regulator"]
    # The contour is whole, and φ even.
    phi = ours.contour["phi"]
    assert phi[0] == phi[-1] and math.isclose(phi[0], ours.regulator["phi_pole"]) and len(phi) == len(ours.contour)
    theirs = cli.json("divide", "--r0", "3", "--cue", CARRIED, "--frames", "out")
    ours = furrow.Cell(r0=3, cue=CARRIED).divide(frames=True)
    assert ours.phi == theirs["phi"] and ours.to_pandas()["phi"][0] == ours.phi
    with (tmp_path / "out" / "frame_0020.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert ours.frames[20].contour["phi"].tolist() == [float(row["phi"]) for row in rows]
    assert not ours.frames[0].contour["phi"].any()
    # In a tree and in its export.
    grown = furrow.tree(r0=2.5, cue=CARRIED)
    column = [float(row["phi"] or "nan") for row in csv.DictReader(io.StringIO(grown.export("csv")))]
    np.testing.assert_array_equal(grown.cells["phi"], column)
    assert math.isclose(grown.cells["phi"][0], furrow.Cell(r0=2.5, cue=CARRIED).divide().phi, rel_tol=1e-5)
    # A cell without a regulator has no regulator values.
    plain = furrow.Cell(r0=1.65)
    assert plain.steady().regulator is None and plain.divide().phi is None
    assert set(plain.steady().contour.columns) == set(furrow.PLACE_COLUMNS)


def test_a_symmetric_contour_is_whole_and_mirrored():
    cell = furrow.Cell(r0=2, xi_s=15)
    contour = cell.steady().contour
    np.testing.assert_array_equal(contour.r, contour.r[::-1])
    np.testing.assert_allclose(contour.z, -contour.z[::-1], atol=1e-12)
    np.testing.assert_allclose(contour["u"], 1 - contour["u"][::-1], atol=1e-15)
    assert np.all(np.diff(contour["u"]) > 0) and np.all(np.diff(contour["psi"]) > 0)
    # Its volume is the cell's.
    volume = -np.trapezoid(np.pi * contour.r**2, contour.z)
    assert math.isclose(volume, 4 / 3 * math.pi * cell.r0**3, rel_tol=1e-3)
    # A cue breaks the symmetry, and the shape is computed whole.
    bent = furrow.Cell(r0=2, xi_s=15, cue="germline").steady().contour
    assert bent["u"][-1] == 1.0 and abs(bent.z[0] + bent.z[-1]) > 1e-6


def test_thresholds_are_those_of_the_command_line(cli):
    theirs = cli.json("pitchfork", "--r0", "2.22", "--epsilon", "0.64")
    ours = furrow.Cell(r0=2.22, epsilon=0.64).pitchfork()
    for name in ("xi_s", "criticality", "coefficient", "H", "L", "p"):
        assert getattr(ours, name) == theirs[name], name


def test_branches_are_those_of_the_command_line(cli):
    theirs = cli.json("branch", "--r0", "2", "--xi-max", "30")
    ours = furrow.Cell(r0=2).branch(xi_max=30)
    for curve in ours.curves:
        points = [point for point in theirs["points"] if point["branch"] == curve.name]
        assert curve.xi_s.tolist() == [point["xi_s"] for point in points]
        assert curve.H.tolist() == [point["H"] for point in points]
        assert curve.stable.tolist() == [point.get("stable", False) for point in points]
    assert [(e.kind, e.xi_s) for e in ours.events] == [(e["kind"], e["xi_s"]) for e in theirs["events"]]
    assert ours.exponent == theirs["scaling"]["exponent"]
    assert len(ours.pitchforks) == 1 and len(ours.folds) == 2
    with pytest.raises(KeyError):
        ours["cued"]


def test_branches_end_at_a_reduced_volume():
    lacking = '"-xi_s"'
    law = f'Law(name: "vesicle", stress_uu: {lacking}, stress_phiphi: {lacking})'
    vesicle = furrow.Cell(1.0, law=law, aspect=0.6, epsilon=0.01, w=3, p0=1e-3)
    oblate = vesicle.branch(reduced_volume=0.65)["symmetric"]
    assert oblate.reduced_volume[-1] == pytest.approx(0.65, abs=1e-5) and oblate.H[-1] < 1.2
    assert oblate.bending_energy[0] == pytest.approx(8 * np.pi, rel=1e-6)
    with pytest.raises(furrow.InputError, match=r"reduced_volume = 1\.5: must be above 0 and below 1"):
        vesicle.branch(reduced_volume=1.5)


def test_spontaneous_curvature_and_normal_friction_are_parameters():
    plain, curled = furrow.Cell(1.6).steady(), furrow.Cell(1.6, spontaneous_curvature=0.3).steady()
    assert curled.H != plain.H and curled.bending_energy < plain.bending_energy
    dragged = furrow.Cell(1.6, normal_friction=0.5)
    assert dragged.steady().H == plain.H and dragged.steady().growth_rate > plain.growth_rate
    assert dragged.normal_friction == 0.5 and furrow.Cell(1.6).normal_friction == 0


def test_branches_have_growth_rates_beyond_axial_symmetry(cli):
    theirs = cli.json("branch", "--r0", "2", "--xi-max", "24", "--azimuthal", "2", "--set", "intervals=32")
    ours = furrow.Cell(r0=2, intervals=32).branch(24, azimuthal=2)
    for curve in ours.curves:
        points = [point["stability"]["azimuthal"] for point in theirs["points"] if point["branch"] == curve.name]
        assert curve.azimuthal.tolist() == [[row["growth_rate"] for row in rows] for rows in points]
    assert [crossing.to_dict() for crossing in ours.crossings] == theirs["azimuthal"]
    assert {(c.m, c.branch, c.grows_beyond) for c in ours.crossings} == {(1, "symmetric", True), (1, "asymmetric", False)}
    # The rate changes sign between the shapes on both sides of a crossing.
    (begin,) = (crossing for crossing in ours.crossings if crossing.grows_beyond)
    symmetric = ours[begin.branch]
    after = int(np.flatnonzero(symmetric.azimuthal[:, 0] > 0)[0])
    assert symmetric.xi_s[after - 1] < begin.xi_s < symmetric.xi_s[after]
    assert ours.warnings == () and "m = 1" in ours._repr_html_()
    assert ours.to_pandas()["growth_rate_m2"].tolist() == [row[1] for curve in ours.curves for row in curve.azimuthal]
    plain = furrow.Cell(r0=2, intervals=32).branch(5)
    assert plain.crossings is None and plain["symmetric"].azimuthal is None
    for bad in (0, 17, 1.5):
        with pytest.raises(furrow.InputError) as refused:
            furrow.Cell(r0=2).branch(azimuthal=bad)
        assert refused.value.field == "azimuthal"


def test_numbers_arrive_to_the_last_bit():
    digits = np.random.default_rng(1)
    numbers = np.ldexp(digits.random(200), digits.integers(-20, 4, 200)) + 1e-6
    numbers = [float(number) for number in numbers] + [1 / 3, np.nextafter(2, 3), np.float32(0.1), 5e-324 + 1e-6]
    for number in numbers:
        cell = furrow.Cell(number, eta_s=number)
        assert cell.r0.hex() == cell.eta_s.hex() == float(number).hex()
        assert furrow.Cell(1.0).replace(r0=number).r0.hex() == cell.r0.hex()
        assert pickle.loads(pickle.dumps(cell)).r0.hex() == cell.r0.hex()
    for number in (5e-324, 1.7976931348623157e308):
        assert furrow.Cell(2, eta_s=number).eta_s.hex() == number.hex()
    radii = digits.uniform(1.0, 1.4, 10)
    swept = furrow.sweep(axes={"r0": radii, "cue.u0": [0.1 + 0.2]}, cue="germline", t_max=0.01, memo=furrow.Memo(r0_step=0))
    assert swept["r0"].tolist() == radii.tolist() and set(swept["cue.u0"]) == {0.1 + 0.2}
    found = furrow.polarity(r0=5.4, par={"k_ap": np.float32(0.19), "psi": 0.1 + 0.2})
    assert (found["constants"]["k_ap"], found["cells"][0]["psi"]) == (float(np.float32(0.19)), 0.1 + 0.2)


def test_whole_numbers_and_words_are_told_apart():
    assert furrow.Cell(2, intervals=64.0).intervals == furrow.Cell(2, intervals="64").intervals == 64
    for name, value in (("intervals", 64.5), ("stages", "two"), ("scheme", 1), ("rigidity_gradient", 0.5)):
        with pytest.raises(furrow.InputError) as refused:
            furrow.Cell(2, **{name: value})
        assert (refused.value.field, refused.value.value) == (name, value)


def test_parameters_go_by_the_names_of_the_command_line():
    for name, section in furrow.parameter_names():
        assert section in ("physics", "numerics")
        if name not in ("xi_b", "shell_profile"):
            assert name in furrow.Cell(r0=2).parameters()
    assert furrow.Cell(2, xi=20) == furrow.Cell(2, xi_s=20.0)
    assert furrow.Cell(2, g=0.4).gain == 0.4
    assert isinstance(furrow.Cell(2).r0, float) and isinstance(furrow.Cell(2).intervals, int)
    assert furrow.Cell(2, xi_b=-5).xi_ratio == -0.2
    assert furrow.Cell("17um", lineage='(base: "c_elegans", units: (length_um: 3.2))').r0 == 17 / 3.2
    assert furrow.Cell(np.float64(2), intervals=np.int64(64)).intervals == 64
    assert furrow.Cell(2, rigidity_gradient="dropped").rigidity_gradient == "dropped"


def test_a_cell_is_a_value():
    cell = furrow.Cell(r0=2.0, cue="germline", w=0.15)
    assert cell == furrow.Cell(r0=2, w=0.15, cue="kappa:u0=0.465,omega=0.0577,amplitude=0.1")
    assert len({cell, cell.replace(), cell.replace(r0=3)}) == 2
    assert cell.replace(epsilon=0.8).epsilon == 0.8 and cell.replace(epsilon=0.8).w == 0.15
    assert cell.replace(cue="none").cue == "none"
    bent = cell.replace(cue="kappa:u0=0.375,omega=0.1,amplitude=0.1")
    assert bent.mirrored() != bent and bent.mirrored().mirrored() == bent
    assert not bent.is_mirror_symmetric and cell.replace(cue="none").is_mirror_symmetric
    assert eval(repr(cell)) == cell
    with pytest.raises(AttributeError):
        cell.r0 = 3
    with pytest.raises(AttributeError):
        cell.radius  # noqa: B018


def test_a_cue_may_have_a_regulator():
    cell = furrow.Cell(r0=2.0, cue="regulator:none,turnover=10,diffusion=1,diluted=true,activity=0.3+germline")
    assert cell.cue.endswith("+regulator:none,turnover=10,diffusion=1,activity=0.3")
    assert eval(repr(cell)) == cell and cell.replace(r0=3).cue == cell.cue
    assert furrow.Cell(2, cue="regulator:none,turnover=10,diffusion=1,activity=0.3").is_mirror_symmetric
    assert list(cell.cue_at([0.5], length=10)) == ["kappa"]
    with pytest.raises(furrow.InputError, match=r"regulator.turnover = \(not given\)"):
        furrow.Cell(2, cue="regulator:none,diffusion=1,activity=0.3")


def test_a_mirrored_cell_divides_mirrored(memo):
    cell = furrow.Cell(r0=4, cue="germline")
    here, there = cell.divide(memo=memo), cell.mirrored().divide(memo=memo)
    assert math.isclose(here.chi_signed, -there.chi_signed, rel_tol=1e-3)


def test_replicates_are_those_of_the_command_line(cli, memo):
    theirs = cli.json("divide", "--r0", "2", "--replicates", "3", "--seed", "4")
    ours = furrow.Cell(r0=2).divide(4, replicates=3, memo=memo)
    assert [d.chi for d in ours] == [d["chi"] for d in theirs["replicates"]]
    assert [d.seed for d in ours] == [4, 5, 6] and ours.undecided == {}
    assert math.isclose(ours.chi_mean, theirs["chi_mean"], rel_tol=1e-14)
    assert math.isclose(ours.chi_sd, theirs["chi_sd"], rel_tol=1e-9)
    assert len(memo) == 3


def test_the_memo_is_shared_and_a_store_outlives_it(tmp_path):
    store = tmp_path / "store"
    first = furrow.Memo(store)
    division = furrow.Cell(r0=2.5).divide(memo=first)
    assert len(first) == 1 and str(first.store) == str(store)
    again = furrow.Memo(store)
    assert furrow.Cell(r0=2.5).divide(memo=again) == division
    assert len(furrow.Memo(store)) == 0 and furrow.Memo(r0_step=0).r0_step == 0
    assert furrow.memo() is furrow.memo()


def test_results_are_tables():
    pandas = pytest.importorskip("pandas")
    division = furrow.Cell(r0=2.5).divide()
    assert division.to_pandas()["chi"].tolist() == [division.chi]
    assert json.loads(json.dumps(division.to_dict()))["cell"]["r0"] == 2.5
    branch = furrow.Cell(r0=2).branch(xi_max=24)
    table = branch.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == sum(len(curve) for curve in branch.curves)
    assert json.loads(json.dumps(branch.to_dict()))["events"][0]["kind"] == "pitchfork"
    steady = furrow.Cell(r0=2, xi_s=12).steady()
    assert len(steady.contour.to_pandas()) == len(steady.contour)
    assert json.loads(json.dumps(steady.to_dict()))["stable"] is True
    frames = furrow.Cell(r0=2.5).divide(frames=0.5).frames
    assert frames.to_pandas()["t"].tolist() == frames.t.tolist()
    for shown in (division, branch, steady, furrow.Cell(r0=2)):
        assert "<table>" in shown._repr_html_()


def test_a_cue_is_told_place_by_place():
    cell = furrow.Cell(4, cue="kappa:u0=0.4,omega=0.1,amplitude=0.2+tension:gradient,amplitude=0.5")
    found = cell.cue_at([0.0, 0.4, 1.0], length=10)
    np.testing.assert_allclose(found["kappa"], 0.2 * np.exp(-((np.array([0.0, 0.4, 1.0]) - 0.4) ** 2) / 0.01))
    np.testing.assert_allclose(found["tension"], [0.5, 0.1, -0.5])


def test_a_cue_that_follows_polarity_is_where_it_acts(cli):
    text = "kappa:par_band,amplitude=0.1"
    cell = furrow.Cell(4, cue=text)
    theirs = cli.json("divide", "--r0", "4", "--cue", text)["resolved_cue"]
    assert cell.resolved_cue == theirs and theirs.startswith("kappa:band,u0=0.433")
    places = [0.3, 0.43, 0.5]
    np.testing.assert_array_equal(cell.cue_at(places, 14)["kappa"], furrow.Cell(4, cue=theirs).cue_at(places, 14)["kappa"])
    assert cell.cue_at([0.43306], 14)["kappa"] == pytest.approx([0.1], rel=1e-6)
    # A small cell has no polarity, and other cues do not depend on it.
    small = cell.replace(r0=2.2)
    assert small.resolved_cue == "none" and small.cue_at(places, 8) == {}
    assert furrow.Cell(4, cue="germline").resolved_cue is None


def test_equal_cells_have_equal_hashes():
    assert furrow.Cell(2, tension=-0.0) == furrow.Cell(2, tension=0.0)
    assert hash(furrow.Cell(2, tension=-0.0)) == hash(furrow.Cell(2, tension=0.0))


def test_one_replicate_has_no_spread(cli, memo):
    theirs = cli.json("divide", "--r0", "2")
    ours = furrow.Cell(2).divide(replicates=1, memo=memo)
    assert ours.chi_sd == theirs["chi_sd"] == 0.0
    assert furrow.Cell(1.5).divide(replicates=2, memo=memo).chi_sd is None


def test_results_cannot_be_written_to():
    frames = furrow.Cell(2.2).divide(frames=True).frames
    branch = furrow.Cell(2).branch(xi_max=24, azimuthal=1)["symmetric"]
    bent = furrow.Cell(1.0, modes=2, elements=32).steady().surface
    arrays = [frames.t, frames.wall, frames[3].contour["r"], branch.H, branch.azimuthal, bent.positions, bent.u]
    arrays += [furrow.Cell(2, xi_s=12).steady().contour["r"], furrow.Cell(2, xi_s=20).perturb(until=1)[0].distance]
    assert not any(array.flags.writeable for array in arrays)
    with pytest.raises(ValueError, match="read-only"):
        frames.t[0] = 1


def test_all_frames_may_be_asked_for_by_numpy():
    cell = furrow.Cell(2.2)
    assert len(cell.divide(frames=np.True_).frames) == len(cell.divide(frames=True).frames)
    assert cell.divide(frames=np.False_).frames is None
    frames = cell.divide(frames=0.5).frames
    assert frames.at(0.6).t == pytest.approx(0.5)
    for t in (float("nan"), float("inf"), "1"):
        with pytest.raises(furrow.InputError):
            frames.at(t)
