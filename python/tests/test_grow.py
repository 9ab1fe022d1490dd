"""Trees by a function of one's own, spreads, pages, parts of sweeps, files to begin with, and the cache as a table."""

from __future__ import annotations

import sqlite3

import pytest
from conftest import REPOSITORY

import furrow

SMALL = '(name: "S", founders: [(name: "S", r0: 2.4)])'


def test_a_tree_by_a_function_is_that_of_the_library(memo):
    cell = furrow.Cell(2.6)
    ours = furrow.grow(cell, lambda born: cell.replace(r0=born.r0), name="S", memo=memo)
    theirs = furrow.tree('(name: "S", founders: [(name: "S", r0: 2.6)])', dynamics=True, memo=memo)
    assert len(ours) == len(theirs) >= 3
    # Radii are the cube roots of other shares.
    assert ours.names == theirs.names and ours.r0 == pytest.approx(theirs.r0, rel=1e-12)
    for column in ("chi", "chi_signed"):
        assert ours.cells[column] == pytest.approx(theirs.cells[column], rel=1e-6, nan_ok=True)
    assert ours["S"].chi == cell.divide(memo=memo).chi


def test_the_side_of_the_smaller_daughter_is_drawn_for_every_cell(memo):
    cell, told = furrow.Cell(2.2), {}

    def like(born: furrow.NewCell) -> furrow.Cell | None:
        told[born.name[:-1]] = born.division
        return None

    sides = {}
    for seed in range(20):
        ours = furrow.grow(cell, like, seed=seed, memo=memo)
        theirs = furrow.tree('(name: "Z", founders: [(name: "Z", r0: 2.2)], limits: (max_depth: 1))', seed=seed, memo=memo)
        sides[seed] = ours["Z"].chi_signed > 0
        assert sides[seed] == (theirs["Z"].chi_signed > 0)
        # The function sees the same division as the tree.
        assert told["Z"].chi_signed == ours["Z"].chi_signed and told["Z"].seed == seed
        assert told["Z"].daughters == pytest.approx((ours["Zp"].r0, ours["Za"].r0))
    assert 5 <= sum(sides.values()) <= 15


def test_volumes_follow_the_radii_that_the_function_gives(memo):
    grown = furrow.grow(furrow.Cell(2.4), lambda born: furrow.Cell(1.1 * born.r0), max_depth=2, memo=memo)
    assert grown.cells["volume_fraction"] == pytest.approx((grown.r0 / grown.r0[0]) ** 3, rel=1e-12)
    assert grown.cells["volume_fraction"][1:3] == pytest.approx([1.1**3 / 2] * 2, rel=1e-3)


def test_only_functions_grow_trees():
    with pytest.raises(furrow.InputError, match="must be a function"):
        furrow.grow(furrow.Cell(2), None)


def test_cells_get_what_the_function_gives_them(tmp_path, memo):
    asked = []

    def rounder(born: furrow.NewCell) -> furrow.Cell | None:
        asked.append(born)
        return None if born.side == "posterior" else born.mother.replace(r0=born.r0, aspect=1.2)

    grown = furrow.grow(furrow.Cell(2.4), rounder, memo=memo)
    assert [born.name for born in asked[:2]] == ["Za", "Zp"] and asked[0].division.outcome == "symmetric"
    assert grown.cells["aspect"][:2].tolist() == [1.505, 1.2]
    assert (grown["Zp"].ended, grown["Zp"].mother) == ("max_depth", "Z")
    grown.save(tmp_path / "tree.json")
    assert furrow.read_tree(tmp_path / "tree.json") == grown
    grown.save(tmp_path / "tree.html")
    assert "Zp" in (tmp_path / "tree.html").read_text(encoding="utf-8") and "Za" in grown.export("nexus")
    assert len(furrow.grow(furrow.Cell(2.4), rounder, max_depth=0, memo=memo)) == 1
    with pytest.raises(ZeroDivisionError):
        furrow.grow(furrow.Cell(2.4), lambda born: 1 / 0, memo=memo)


def test_cells_have_names(known):
    worm = furrow.tree(memo=known)
    assert worm["AB"].r0 == worm.r0[worm.names.index("AB")] and worm["AB"].daughters == ("ABa", "ABp")
    assert worm["P0"].mother is None and worm["P0"].chi == worm.founders[0].chi
    with pytest.raises(KeyError, match="did you mean"):
        worm["ABb"]
    with pytest.raises(KeyError, match=r"tree\.cells"):
        worm["chi"]
    table = worm.to_pandas()
    assert table.loc["AB", "mother"] == "P0" and table.loc["P1", "chi"] == worm["P1"].chi


def test_spread_over_seeds_is_that_of_the_command_line(cli, memo, tmp_path):
    (tmp_path / "s.ron").write_text(SMALL)
    ours = furrow.tree_ensemble(tmp_path / "s.ron", replicates=3, memo=memo)
    theirs = cli.json("tree", "s.ron", "--replicates", "3", "--out", "out")
    assert ours.members == theirs["members"] == 3
    ours.save(tmp_path / "page.html")
    ours.save(tmp_path / "rounds.svg")
    assert "<svg" in (tmp_path / "rounds.svg").read_text(encoding="utf-8") and len(ours.tree) >= 3
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert len(page) == len((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))


def test_files_of_scenarios_are_those_of_the_command_line(cli, memo, tmp_path):
    (tmp_path / "s.ron").write_text(SMALL)
    (tmp_path / "t.ron").write_text(SMALL.replace("2.4", "2.5"))
    found = furrow.scenarios([tmp_path / "s.ron", tmp_path / "t.ron"], memo=memo)
    cli.text("tree", "s.ron", "t.ron", "--out", "out")
    found.save(tmp_path / "table.csv")
    found.save(tmp_path / "page.html")
    assert (tmp_path / "table.csv").read_bytes() == (tmp_path / "out" / "scenarios.csv").read_bytes()
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert all(name in page for name in found) and page.startswith("<!doctype html>")


def test_parts_of_a_sweep_are_merged(memo, tmp_path):
    axes = {"r0": [1.5, 2.0, 2.5]}
    for k in (1, 2):
        furrow.sweep(axes=axes, shard=(k, 2), out=tmp_path / str(k), memo=memo)
    assert furrow.merge([tmp_path / "1", tmp_path / "2"], out=tmp_path / "all") == 3
    assert (tmp_path / "all" / "results.csv").read_text() == furrow.sweep(axes=axes, memo=memo).csv


def test_files_to_begin_with(tmp_path):
    furrow.new_lineage(tmp_path / "new.ron")
    assert "Lineage(" in (tmp_path / "new.ron").read_text(encoding="utf-8")
    with pytest.raises(furrow.InputError):
        furrow.new_lineage(tmp_path / "new.ron")
    assert furrow.explore(tmp_path / "page.html") == len((tmp_path / "page.html").read_bytes())
    assert furrow.tree_schema()["type"] == "object"


def test_the_paper_is_reproduced(cli, tmp_path):
    ours = furrow.reproduce("S3", out=tmp_path / "ours", table=tmp_path / "table.md")
    theirs = cli.json("reproduce", "S3")

    def without_seconds(items):
        return [{name: value for name, value in item.items() if name != "seconds"} for item in items]

    assert without_seconds(ours["items"]) == without_seconds(theirs["items"])
    assert (tmp_path / "table.md").read_text(encoding="utf-8") == ours.markdown
    assert (tmp_path / "ours" / "results.csv").exists() and ours["agrees"] == theirs["agrees"]


def test_the_cache_is_a_table_and_is_looked_after(tmp_path):
    pandas = pytest.importorskip("pandas")
    known = furrow.Memo(tmp_path)
    furrow.Cell(2.5).divide(memo=known)
    (file,) = (path for path in tmp_path.rglob("*") if path.is_file() and path.read_bytes().startswith(b"SQLite format 3"))
    with sqlite3.connect(file) as connection:
        tables = pandas.read_sql("SELECT name FROM sqlite_master WHERE type = 'table'", connection)["name"]
        assert sum(len(pandas.read_sql(f"SELECT * FROM {name}", connection)) for name in tables) >= 1
    assert furrow.cache.stat(tmp_path)["entries"] == 1 and furrow.cache.verify(tmp_path)["damaged"] == []
    furrow.cache.clear(tmp_path)
    assert furrow.cache.stat(tmp_path)["entries"] == 0


def test_type_checkers_see_every_parameter_of_a_cell():
    text = (REPOSITORY / "python" / "furrow" / "_cell.py").read_text(encoding="utf-8")
    declared = text[text.index("if TYPE_CHECKING:\n        kappa") :].split("\n\n", 1)[0]
    kinds = {line.split(":")[0].strip(): line.split(":")[1].strip() for line in declared.splitlines()[1:]}
    values = furrow.Cell(2.0).parameters()
    for text in ("cue", "law", "shell_profile"):
        values.pop(text)
    assert kinds == {name: type(value).__name__ for name, value in values.items()}
