"""Measured embryos beside the model, from Python and from the command line."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

import furrow

TABLE = {
    "embryo": ["1", "1", "1", "1", "1", "1", "2", "2"],
    "cell": ["AB", "P1", "EMS", "P2", "ABa", "ABp", "AB", "P1"],
    "volume_um3": [14000.0, 9500.5, 5600.0, 3900.0, 7100.0, 6900.0, 13500.0, 10000.0],
}


def test_volumes_are_compared_as_by_the_command_line(cli, tmp_path, known):
    lines = [",".join(TABLE), *(f"{e},{c},{v!r}" for e, c, v in zip(*TABLE.values(), strict=True))]
    (tmp_path / "volumes.csv").write_text("\n".join(lines) + "\n")
    theirs = cli.json("compare", "volumes", "volumes.csv")
    ours = furrow.compare.volumes(tmp_path / "volumes.csv", memo=known)
    assert ours.to_dict()["groups"] == theirs["groups"] and ours.used == theirs["used"]
    assert ours.length_scale == theirs["length_scale"]["length"]
    assert furrow.compare.volumes(TABLE, memo=known).mothers == ours.mothers
    pandas = pytest.importorskip("pandas")
    assert furrow.compare.volumes(pandas.DataFrame(TABLE), memo=known).mothers == ours.mothers
    p0 = next(mother for mother in ours.mothers if mother.mother == "P0")
    assert (p0.n, p0.model_outcome) == (2, "asymmetric") and 0.15 < p0.measured < 0.2
    assert ours.to_pandas()["mother"].tolist() == [mother.mother for mother in ours.mothers]


def test_numbers_of_tables_keep_their_value(known):
    short = np.array(TABLE["volume_um3"], dtype=np.float32) / np.float32(3)
    exact = furrow.compare.volumes({**TABLE, "volume_um3": [float(volume) for volume in short]}, memo=known)
    assert furrow.compare.volumes({**TABLE, "volume_um3": short}, memo=known).mothers == exact.mothers
    pandas = pytest.importorskip("pandas")
    assert furrow.compare.volumes(pandas.DataFrame({**TABLE, "volume_um3": short}), memo=known).mothers == exact.mothers


def test_without_a_table_there_are_published_means(cli, known):
    theirs = cli.json("compare", "volumes")
    assert furrow.compare.volumes(memo=known).to_dict()["groups"] == theirs["groups"]


def test_volumes_that_cannot_be_used(known):
    with pytest.raises(furrow.InputError):
        furrow.compare.volumes({"embryo": ["1"], "cell": ["AB", "P1"]}, memo=known)
    with pytest.raises(furrow.InputError):
        furrow.compare.volumes({"colour": ["red"]}, memo=known)
    some = furrow.compare.volumes({**TABLE, "volume_um3": [*TABLE["volume_um3"][:-1], float("nan")]}, memo=known)
    assert len(some.skipped) == 1 and some.used == 7


def test_counts_are_compared_as_by_the_command_line(cli, known):
    theirs = cli.json("compare", "counts")
    ours = furrow.compare.counts(furrow.tree(memo=known))
    assert ours.to_dict() == theirs
    assert set(ours.to_pandas()["founder"]) >= {"AB", "P4"}


def same(ours, theirs, *, without=()):
    """All keys of the command line, with equal values to the last bit."""
    assert set(theirs) - set(without) <= set(ours)
    for name in set(theirs) - set(without):
        assert ours[name] == theirs[name], name


def test_a_trend_and_its_noise_are_those_of_the_command_line(cli, known):
    rows = ["embryo,mother,mother_um3,larger_um3,smaller_um3"]
    for k in range(60):
        volume, chi = 9000.0 * 0.93**k, 0.05 + 0.002 * k
        seen = volume * (1 + 0.03 * (-1) ** k)
        rows.append(f"{k % 2},m{k},{seen!r},{volume * (1 + chi) / 2!r},{volume * (1 - chi) / 2!r}")
    (cli.folder / "divisions.csv").write_text("\n".join(rows) + "\n")
    theirs = cli.json("compare", "volumes", "divisions.csv", "--length-scale", "3", "--bins", "10,1000,20000")
    ours = furrow.compare.volumes(cli.folder / "divisions.csv", length_scale=3, bins=[10, 1000, 20000], memo=known)
    same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members"])
    assert len(ours.to_dict()["divisions"]) == theirs["divisions"] == 60
    assert ours.trend["line"]["slope"] < 0 and len(ours.trend["embryos"]) == 2
    assert 0 < ours.noise["share"] < 1 and len(ours.bins) == len(ours.to_dict()["model_by_bin"]) == 2
    for bad in ([1000], [1000, 10], ["a", "b"]):
        with pytest.raises(furrow.InputError) as refused:
            furrow.compare.volumes(cli.folder / "divisions.csv", bins=bad, memo=known)
        assert refused.value.field == "bins"


def test_populations_are_those_of_the_command_line(cli, known):
    table = {
        "embryo": ["1"] * 6,
        "mother": [f"m{k}" for k in range(6)],
        "larger_um3": [600.0, 610.0, 620.0, 310.0, 320.0, 90.5],
        "smaller_um3": [400.0, 410.0, 405.0, 300.0, 290.0, 10.5],
        "population": ["Mac", "Mac", "Mac", "Mes", "Mes", "Mic"],
    }
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values(), strict=True))]
    (cli.folder / "divisions.csv").write_text("\n".join(lines) + "\n")
    for wanted, argument, count in ((["Mac", "Mes"], "Mac,Mes", 5), ("Mic", "Mic", 1)):
        theirs = cli.json("compare", "volumes", "divisions.csv", "--population", argument)
        ours = furrow.compare.volumes(table, population=wanted, memo=known)
        same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members"])
        assert len(ours.to_dict()["divisions"]) == theirs["divisions"] == count
    assert {group["group"] for group in furrow.compare.volumes(table, memo=known).to_dict()["groups"]} == {"Mac", "Mes", "Mic"}
    for table_given, bad in ((table, "Meso"), (table, [3]), (None, "Mac")):
        with pytest.raises(furrow.InputError) as refused:
            furrow.compare.volumes(table_given, population=bad, memo=known)
        assert refused.value.field == "population"


def test_two_conditions_are_regressed(cli, known):
    second = {**TABLE, "volume_um3": [1.1 * volume if k % 2 else volume for k, volume in enumerate(TABLE["volume_um3"])]}
    for name, table in (("a.csv", TABLE), ("b.csv", second)):
        lines = [",".join(table), *(f"{e},{c},{v!r}" for e, c, v in zip(*table.values(), strict=True))]
        (cli.folder / name).write_text("\n".join(lines) + "\n")
    theirs = cli.json("compare", "volumes", "a.csv", "--against", "b.csv")
    ours = furrow.compare.volumes(TABLE, against=second, memo=known)
    same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members"])
    assert [(one["x"], len(one["mothers"])) for one in ours.regressions] == [("measured", 3)]
    turned = furrow.compare.volumes(TABLE, against=second, regress=("against", "measured"), memo=known)
    assert turned.regressions[0]["x"] == "against"
    with pytest.raises(furrow.InputError) as refused:
        furrow.compare.volumes(TABLE, regress=("wt", "ctrl"), memo=known)
    assert refused.value.field == "regress"


def test_published_means_of_the_sea_urchin(cli, known):
    theirs = cli.json("compare", "volumes", "--published", "villoutreix2016")
    ours = furrow.compare.volumes(published="villoutreix2016", memo=known)
    same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members"])
    with pytest.raises(furrow.InputError):
        furrow.compare.volumes(published="villoutreix", memo=known)


def cd_table(folder):
    """An embryo as a CD table of AceTree: AB, P1 and ABa divide."""
    rows = ["cellTime,cell,time,none,global,local,blot,cross,z,x,y,size,gweight"]
    spans = {
        "AB": (1, 9, 60),
        "P1": (1, 11, 50),
        "ABa": (10, 18, 48),
        "ABp": (10, 25, 47),
        "EMS": (12, 25, 42),
        "P2": (12, 25, 38),
    }
    spans |= {"ABal": (19, 25, 38), "ABar": (19, 25, 37)}
    for cell, (birth, last, size) in spans.items():
        rows += [f"{cell}:{t},{cell},{t},0,0,0,0,0,15,300,200,{size},1000" for t in range(birth, last + 1)]
    file = folder / "CDembryo.csv"
    file.write_text("\n".join(rows) + "\n")
    return file


def test_embryos_of_other_programs(cli, tmp_path, known):
    embryo = cd_table(tmp_path)
    theirs = cli.json("compare", "volumes", embryo.name, "--voxel", "0.1")
    ours = furrow.compare.volumes(embryo, voxel=0.1, memo=known)
    same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members", "skipped"])
    assert ours.of_nuclei and ours.used == sum(1 for _ in embryo.open()) - 1
    worm = furrow.tree(memo=known)
    theirs = cli.json("compare", "counts", "--measured", embryo.name)
    assert furrow.compare.counts(worm, measured=embryo).to_dict() == theirs
    theirs = cli.json("compare", "lifetimes", embryo.name, "--frame-minutes", "2")
    ours = furrow.compare.lifetimes(embryo, tree=worm, frame_minutes=2)
    assert ours.to_dict() == theirs and [(cell["cell"], cell["mean"]) for cell in ours["cells"]] == [("ABa", 18.0)]
    with pytest.raises(furrow.InputError, match="frame_minutes"):
        furrow.compare.lifetimes(embryo, tree=worm)
    (tmp_path / "other.csv").write_text("colour\nred\n")
    with pytest.raises(furrow.InputError, match="AceTree"):
        furrow.compare.counts(worm, measured=tmp_path / "other.csv")


def test_cells_with_other_names_are_matched(cli, tmp_path, known):
    """Two recordings whose cells are called by numbers, one slower than the other."""
    rows = [(1, 0, 9, -1, 60), (2, 10, 19, 1, 50), (3, 10, 21, 1, 48), (4, 20, 30, 2, 39), (5, 20, 30, 2, 38)]
    for name, factor in (("one", 1), ("two", 2)):
        lines = ["track_id,t,y,x,parent_track_id,radius"]
        for track, first, last, parent, radius in rows:
            lines += [f"{track},{t},0,0,{parent},{radius}" for t in range(factor * first, factor * last + 1)]
        (tmp_path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    files = [tmp_path / "one.csv", tmp_path / "two.csv"]
    (tmp_path / "map.csv").write_text("tracked,name\n4,ABp\n")
    worm = furrow.tree(memo=known)
    flags = ("--root", "1=P0", "--names", "map.csv")
    theirs = cli.json("compare", "counts", "--measured", "one.csv", *flags)
    ours = furrow.compare.counts(worm, measured=files[0], names=tmp_path / "map.csv", root="1=P0")
    same(ours.to_dict(), theirs, without=["skipped"])
    assert [division["by"] for division in ours["matched"]["divisions"]] == ["sizes", "names"]
    theirs = cli.json("compare", "lifetimes", "one.csv", "two.csv", "--frame-minutes", "2", "--frame-minutes", "two=1.5", *flags)
    given = {"frame_minutes": {"one": 2, "two": 1.5}, "names": {"tracked": ["4"], "name": ["ABp"]}, "root": ["1=P0"]}
    ours = furrow.compare.lifetimes(files, tree=worm, **given)
    same(ours.to_dict(), theirs, without=["skipped"])
    factors = [embryo["time_factor"] for embryo in ours["embryos"]]
    assert abs(factors[1] / factors[0] - 1.45) < 0.1
    paced = furrow.compare.lifetimes(files, tree=worm, common_pace=True, **given)
    assert paced["cells"][0]["sd"] < 1e-9 < ours["cells"][0]["sd"]
    theirs = cli.json("compare", "volumes", "one.csv", "two.csv", "--voxel", "0.1", "--voxel", "two=0.2", *flags)
    ours = furrow.compare.volumes(files, voxel={"one": 0.1, "two": 0.2}, root="1=P0", names=tmp_path / "map.csv", memo=known)
    same(ours.to_dict(), theirs, without=["divisions", "length_scale_um", "members", "skipped"])
    found = furrow.test(files, ["none"], free=[], root="1=P0", cells=["P0", "AB"], memo=known)
    assert found["n"] == 4 and len(found["matched"]) == 2
    theirs = cli.text("export", "one.csv", "--to", "csv", "--root", "1=P0", "--subtree", "AB", "--frame-minutes", "2")
    assert furrow.export_observed(files[0], "csv", root="1=P0", subtree="AB", frame_minutes=2) == theirs
    with pytest.raises(furrow.InputError, match="must be a cell of a tracked embryo"):
        furrow.compare.counts(worm, measured=files[0], root="9=P0")


def test_geff_with_compressed_arrays_is_read(tmp_path, known):
    """Python's package geff compresses with Blosc."""
    worm = furrow.tree(memo=known)
    worm.export("geff", "minutes", path=tmp_path / "tree.geff")
    plain = furrow.compare.counts(worm, measured=tmp_path / "tree.geff")
    ids = tmp_path / "tree.geff" / "nodes" / "ids"
    described = json.loads((ids / ".zarray").read_text())
    assert described["compressor"] is None
    described["compressor"] = {"id": "blosc", "cname": "lz4", "clevel": 0, "shuffle": 0, "blocksize": 0}
    (ids / ".zarray").write_text(json.dumps(described))
    content = (ids / "0").read_bytes()
    # Header: version, version of the codec, a flag for uncompressed bytes, size of an element;
    # then lengths without and with the header.
    head = struct.pack("<BBBBIII", 2, 1, 2, 8, len(content), len(content), len(content) + 16)
    (ids / "0").write_bytes(head + content)
    assert furrow.compare.counts(worm, measured=tmp_path / "tree.geff").to_dict() == plain.to_dict()
    assert plain["stages"][0]["cells"] == 127


LIFETIMES = {
    "cell": ["AB", "P1", "ABa", "ABp", "EMS", "P2", "ABal"],
    "lifetime_min": [15.5, 17.25, 17.0, 17.5, 20.0, 24.5, 19.0],
    "birth_min": [0.0, 0.0, 15.5, 15.5, 17.25, 17.25, 32.5],
}


def test_lifetimes_are_compared_as_by_the_command_line(cli, known):
    worm = furrow.tree(memo=known)
    assert furrow.compare.lifetimes(tree=worm).to_dict() == cli.json("compare", "lifetimes")
    lines = [",".join(LIFETIMES), *(",".join(map(str, row)) for row in zip(*LIFETIMES.values(), strict=True))]
    (cli.folder / "lifetimes.csv").write_text("\n".join(lines) + "\n")
    ours = furrow.compare.lifetimes(LIFETIMES, tree=worm)
    assert ours.to_dict() == cli.json("compare", "lifetimes", "lifetimes.csv")
    assert ours.to_pandas()["model"][0] == ours["cells"][0]["model"] > 0
    with pytest.raises(furrow.InputError):
        furrow.compare.lifetimes(tree="c_elegans")
    with pytest.raises(furrow.InputError):
        furrow.compare.lifetimes(["a.csv", "b.csv"], tree=worm)


def test_a_clock_is_fitted_as_by_the_command_line(cli, known):
    theirs = cli.json("fit", "clock")
    theirs.pop("volumes")
    ours = furrow.fit.clock()
    assert ours.to_dict() == theirs
    assert ours.to_pandas()["founder"].tolist()[-1] == "all"
    # The tree takes it.
    fitted = furrow.tree(ours.ron, memo=known)
    assert fitted.cells["division_min"][0] == 0 and len(fitted) == 253
    with pytest.raises(furrow.InputError):
        furrow.fit.clock({"cell": ["AB"], "lifetime_min": [15.0]})


def test_doses_are_compared_as_by_the_command_line(cli, known):
    same(furrow.compare.dose(memo=known), theirs := cli.json("compare", "dose"))
    assert theirs["model"]["points"][0]["chi"] < 2e-3
    table = {"dose": [0.1, 0.4, 0.5, 0.9, 1.0, 1.1], "larger_share": [0.51, 0.53, 0.55, 0.58, 0.6, 0.59]}
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values(), strict=True))]
    (cli.folder / "doses.csv").write_text("\n".join(lines) + "\n")
    theirs = cli.json("compare", "dose", "doses.csv", "--bins", "0,0.5,1,1.5", "--r0", "5")
    ours = furrow.compare.dose(table, bins=[0, 0.5, 1, 1.5], r0=5, memo=known)
    assert ours.to_dict() == theirs
    frame = ours.to_pandas()
    assert frame["n"].tolist() == [2, 2, 2] and frame["model"].tolist() == [row["model"]["chi"] for row in ours["bins"]]
    with pytest.raises(furrow.InputError):
        furrow.compare.dose({"dose": [1.0]}, memo=known)


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


def test_an_outline_that_cannot_be_used_is_skipped():
    division = furrow.Cell(r0=4, cue="germline").divide(frames=True)
    half = division.frames[40].contour.points
    ring = np.concatenate((half, half[::-1] * [-1, 1]))
    found = furrow.compare.contours([[[0, 0], [1, 1]], ring, np.full((5, 2), np.nan)], division)
    assert found.used == len(found.contours) == len(found.laid) == 1 and found.contours[0]["file"] == "1"
    assert [one["contour"] for one in found.skipped] == [0, 2] and "at least 3" in found.skipped[0]["why"]
    assert found.similarity == furrow.compare.contours([ring], division).similarity
    assert json.loads(json.dumps(found.to_dict()))["skipped"][0]["contour"] == 0


def test_an_empty_list_of_files_is_no_published_table():
    for call, field in (
        (lambda: furrow.compare.volumes([]), "table"),
        (lambda: furrow.compare.volumes({}), "table"),
        (lambda: furrow.compare.volumes(TABLE, against=[]), "against"),
        (lambda: furrow.compare.lifetimes([]), "table"),
        (lambda: furrow.compare.lifetimes(volumes=[]), "volumes"),
        (lambda: furrow.compare.dose([]), "table"),
        (lambda: furrow.fit.clock([]), "table"),
        (lambda: furrow.test([], ["none"]), "table"),
    ):
        with pytest.raises(furrow.InputError) as refused:
            call()
        assert refused.value.field == field


def test_arguments_without_effect_are_refused():
    for call, field in (
        (lambda: furrow.compare.volumes(TABLE, published="villoutreix2016"), "published"),
        (lambda: furrow.compare.volumes(TABLE, voxel=0.1), "voxel"),
        (lambda: furrow.compare.lifetimes(common_pace=True), "common_pace"),
        (lambda: furrow.compare.lifetimes(frame_minutes=2), "frame_minutes"),
        (lambda: furrow.compare.lifetimes(LIFETIMES, frame_minutes=2), "frame_minutes"),
        (lambda: furrow.fit.clock(common_pace=True), "common_pace"),
        (lambda: furrow.fit.clock(common_size=True), "common_size"),
    ):
        with pytest.raises(furrow.InputError) as refused:
            call()
        assert refused.value.field == field and str(refused.value).startswith(f"furrow: {field} = ")


def test_names_in_tables_in_memory_may_begin_with_a_number_sign(known):
    """A file has comments; a table in memory has none."""
    marked = {**TABLE, "embryo": [f"#{embryo}" for embryo in TABLE["embryo"]]}
    plain = furrow.compare.volumes(TABLE, memo=known).mothers
    assert furrow.compare.volumes(marked, memo=known).mothers == plain
    assert furrow.compare.volumes({**TABLE, "embryo": ["sep=" if e == "2" else e for e in TABLE["embryo"]]}).mothers == plain
    doses = furrow.compare.dose({"condition": ["#1", "#2"], "dose": [0.5, 1.0], "larger_share": [0.55, 0.6]}, memo=known)
    assert sum(row["n"] for row in doses["bins"]) == 2
    times = {"embryo": ["#1"] * len(LIFETIMES["cell"]), **LIFETIMES}
    assert furrow.compare.lifetimes(times)["cells"] == furrow.compare.lifetimes({**times, "embryo": ["1"] * 7})["cells"]
    chi = {"embryo": ["#1", "#2", "#3", "x"], "mother": ["P0"] * 4, "chi": [0.18, 0.17, 0.16, 0.15]}
    assert furrow.test(chi, ["none"], free=[], memo=known)["hypotheses"][0]["cells"][0]["n"] == 4
    pandas = pytest.importorskip("pandas")
    assert furrow.compare.volumes(pandas.DataFrame(marked), memo=known).mothers == plain
    assert furrow.test(pandas.DataFrame(chi), ["none"], free=[], memo=known)["hypotheses"][0]["cells"][0]["n"] == 4


def test_half_floats_keep_their_value(known):
    pandas = pytest.importorskip("pandas")
    shares = np.array([0.5513, 0.6021], dtype=np.float16)
    exact = {"dose": [0.5, 1.0], "larger_share": [float(share) for share in shares]}
    ours = furrow.compare.dose(pandas.DataFrame({"dose": [0.5, 1.0], "larger_share": shares}), memo=known)
    assert ours["bins"] == furrow.compare.dose(exact, memo=known)["bins"]
