"""Trees from Python and from the command line, and what other libraries make of them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import without_commit

import furrow


@pytest.fixture(scope="module")
def worm() -> furrow.Tree:
    return furrow.tree()


def test_the_tree_is_that_of_the_command_line(cli, worm, tmp_path):
    printed = cli.text("tree", "--out", "out")
    table = worm.table()
    assert printed.startswith(table) and "P0        5.400  germline  asymmetric   0.185" in table
    assert without_commit((tmp_path / "out" / "tree.json").read_text()) == without_commit(worm.to_json())
    assert (tmp_path / "out" / "tree.nwk").read_text() == worm.newick()
    theirs = cli.json("tree", "--out", "out")
    assert [founder.chi for founder in worm.founders] == [founder["chi"] for founder in theirs["founders"]]
    assert worm.founders[1].rounds.mean == theirs["founders"][1]["rounds"]["mean"]
    assert worm.founders[1].rounds.symmetric_doublings == 4
    assert str(worm) == table


def test_columns_are_of_all_cells(worm):
    assert len(worm) == len(worm.names) == len(worm.r0) == 253
    assert worm.names[0] == "P0" and worm.mother[0] == -1
    born = worm.mother[1:]
    assert np.all(worm.generation[1:] == worm.generation[born] + 1)
    # Volumes are handed down whole.
    for mother in np.unique(born):
        assert np.isclose(worm.cells["volume_fraction"][1:][born == mother].sum(), worm.cells["volume_fraction"][mother])
    assert worm.cells["outcome"].count("failed") == sum(worm.ended.values()) == 127
    assert np.isnan(worm.chi[[outcome == "failed" for outcome in worm.cells["outcome"]]]).all()


def test_scenarios_are_those_of_the_command_line(cli, tmp_path, known):
    cues = ["none", "tension:gradient,amplitude=0.3"]
    cli.text("tree", "--cue", cues[0], "--cue", cues[1], "--out", "out")
    found = furrow.scenarios(cues=cues, memo=known)
    assert list(found) == ["c_elegans-none", "c_elegans-cue-2"]
    assert found.cues == dict(zip(found, cues, strict=True))
    for name, tree in found.items():
        theirs = (tmp_path / "out" / name / "tree.json").read_text()
        assert without_commit(theirs) == without_commit(tree.to_json())
    assert found["c_elegans-none"] == furrow.tree(cue="none", memo=known)
    assert "c_elegans-cue-2: " in found._repr_html_()


def test_a_lineage_of_ones_own(cli, tmp_path, memo):
    text = 'Lineage(name: "mine", founders: [(name: "S", r0: 2.4)])'
    (tmp_path / "mine.ron").write_text(text)
    cli.text("tree", "mine.ron", "--out", "out", "--dynamics", "--seed", "3", "--set", "epsilon=0.86")
    keywords = {"seed": 3, "epsilon": 0.86, "dynamics": True, "memo": memo}
    theirs = without_commit((tmp_path / "out" / "tree.json").read_text())
    for lineage in (tmp_path / "mine.ron", str(tmp_path / "mine.ron"), text):
        assert without_commit(furrow.tree(lineage, **keywords).to_json()) == theirs
    other = furrow.tree(text, r0=2.3, memo=memo)
    assert other.r0[0] == 2.3
    both = furrow.scenarios([tmp_path / "mine.ron", text.replace("2.4", "2.5")], memo=memo)
    assert [tree.r0[0] for tree in both.values()] == [2.4, 2.5]


def test_a_tree_is_a_graph(worm):
    networkx = pytest.importorskip("networkx")
    graph = worm.to_networkx()
    assert networkx.is_arborescence(graph) and graph.number_of_nodes() == 253
    assert set(graph.successors("P0")) == {"AB", "P1"}
    assert graph.nodes["AB"]["r0"] == worm.r0[worm.names.index("AB")]
    assert graph.nodes["AB"]["outcome"] == "symmetric"
    # The graph can be written and read again: its numbers are not numpy's.
    text = "\n".join(networkx.generate_graphml(networkx.DiGraph(graph.edges)))
    assert networkx.parse_graphml(text).number_of_edges() == 252


def test_a_tree_is_one_of_lineagetree(worm):
    pytest.importorskip("lineagetree")
    found = worm.to_lineagetree()
    assert len(found.nodes) == 253 and len(found.leaves) == 127
    roots = list(found.roots)
    assert [found.label[root] for root in roots] == ["P0"]
    assert sorted(found.label[cell] for cell in found.successor[roots[0]]) == ["AB", "P1"]
    assert found.time[worm.names.index("ABa")] == 2


def test_newick_has_every_cell(worm):
    newick = worm.newick()
    assert newick.count(",") == 126 and newick.rstrip().endswith(";")
    assert worm.export("newick", "generation").count(":1") >= 252
    assert set(worm.export("itol")) > {"tree.nwk"} or isinstance(worm.export("itol"), dict)
    with pytest.raises(furrow.InputError) as refused:
        worm.export("nexuss")
    assert refused.value.field == "format" and "nexus" in refused.value.allowed


def test_cells_over_minutes(worm, cli, tmp_path):
    minutes, cells = worm.alive()
    births, divisions = worm.cells["birth_min"], worm.cells["division_min"]
    counted = [int((births <= at).sum() - (divisions <= at).sum()) for at in minutes]
    assert cells.tolist() == counted and len(minutes) > 50 and cells[-1] == 127
    last = worm.last_divisions
    of_ab = [k for k, founder in enumerate(worm.cells["founder"]) if founder == "AB"]
    assert last["AB"] == np.nanmax(divisions[of_ab])
    theirs = cli.json("tree", "--out", "out")
    assert last == {row["name"]: row.get("last_division_min") for row in theirs["founders"]}
    assert [{"min": at, "cells": n} for at, n in zip(minutes.tolist(), cells.tolist(), strict=True)] == theirs["alive"]
    assert worm.founders_to_pandas()["last_division_min"][0] == last["P0"]
    # The drawing equals the command line's.
    cli.text("tree", "--out", "minutes", "--time-axis", "minutes")
    assert worm.svg("minutes") == (tmp_path / "minutes" / "tree.svg").read_text(encoding="utf-8")
    assert worm.svg("minutes") != worm.svg() == (tmp_path / "out" / "tree.svg").read_text(encoding="utf-8")
    without = furrow.tree('Lineage(name: "mine", founders: [(name: "S", r0: 2.4)])')
    assert set(without.last_divisions.values()) == {None}
    for call in (without.alive, lambda: without.svg("minutes"), lambda: worm.svg("hours")):
        with pytest.raises(furrow.InputError):
            call()


@pytest.mark.parametrize("format", ["newick", "ctc", "itol", "geff"])
def test_exports_are_files_of_the_command_line(worm, cli, tmp_path, format):
    worm.save(tmp_path / "tree.json")
    cli.text("export", "tree.json", "--to", format, "--out", "theirs", "--branch-lengths", "minutes")
    worm.export(format, "minutes", path=tmp_path / "ours")

    def files(folder):
        if folder.is_file():
            return {"": folder.read_bytes()}
        return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}

    ours, theirs = files(tmp_path / "ours"), files(tmp_path / "theirs")
    assert ours == theirs and all(ours.values())
    held = worm.export(format, "minutes")
    held = {"": held} if isinstance(held, str) else held
    assert {name: text.encode() if isinstance(text, str) else text for name, text in held.items()} == ours


def test_tables_for_pandas(worm):
    pytest.importorskip("pandas")
    cells = worm.to_pandas()
    assert cells.shape[0] == 253 and cells["r0"].to_numpy().tolist() == worm.r0.tolist()
    founders = worm.founders_to_pandas().set_index("name")
    assert founders.loc["AB", "model_terminal"] == 64 and founders.loc["AB", "observed_terminal"] == 487
    both = furrow.scenarios(cues=["germline", "none"]).to_pandas()
    assert both.groupby("scenario").size().tolist() == [11, 11]


def test_files_are_read_again(worm, tmp_path):
    worm.save(tmp_path / "tree.json")
    assert furrow.read_tree(tmp_path / "tree.json") == worm
    for name, begins in (("tree.svg", "<svg"), ("tree.nwk", "("), ("tree.html", "<!")):
        worm.save(tmp_path / name)
        assert (tmp_path / name).read_text().startswith(begins)
    with pytest.raises(furrow.InputError):
        worm.save(tmp_path / "tree.xlsx")
    (tmp_path / "tree.json").write_text(worm.to_json()[:1000])
    with pytest.raises(furrow.InputError, match=r"tree\.json"):
        furrow.read_tree(tmp_path / "tree.json")


def test_labels_of_founders_lie_clear_of_cells(worm):
    drawn = worm.svg()
    cells = [tuple(map(float, cell)) for cell in re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)" r="([\d.]+)"', drawn)]
    labels = re.findall(r'<text x="([\d.]+)" y="([\d.]+)" font-size="11" text-anchor="(start|end)"[^>]*>χ', drawn)
    assert len(cells) > 250 and len(labels) == 10
    for left, base, anchor in labels:
        # As wide as "χ 0.76", and as high.
        middle, y = float(left) + (18 if anchor == "start" else -18), float(base) - 4
        assert all(abs(cx - middle) > 18 + r or abs(cy - y) > 4 + r for cx, cy, r in cells)


def test_what_a_notebook_shows_is_bounded(worm):
    drawing = worm._repr_svg_()
    assert drawing.startswith("<svg") and "ABa" in drawing
    assert drawing[5:] in worm._repr_html_() and len(worm._repr_html_()) < 300_000
    many = '(name: "large", founders: [(name: "S", r0: 20)], limits: (max_cells: 1001, max_depth: 40))'
    # Radii are rounded, so that few divisions are solved.
    large = furrow.tree(many, memo=furrow.Memo(r0_step=0.02))
    assert len(large) > 1000
    assert large._repr_svg_() is None
    shown = large._repr_html_()
    assert len(shown) < 2000 and "too many to be drawn" in shown


def test_to_dict_is_what_json_can_hold(worm):
    assert json.loads(json.dumps(worm.to_dict()))["cells"][0]["name"] == "P0"


def test_ranges_over_constants(cli, tmp_path):
    table = "aspect,p0,w,gain,weight\n1.5,0.123,0.1445,0.5,0.75\n1.49,0.122,0.144,0.5,0.25\n"
    (tmp_path / "constants.csv").write_text(table)
    theirs = cli.json("tree", "--constants", "constants.csv")
    ours = furrow.tree_ensemble(constants=tmp_path / "constants.csv")
    theirs.pop("elapsed_s")
    assert ours.to_dict() == theirs and ours.members == 2
    frame = ours.to_pandas().set_index("name")
    assert frame.loc["AB", "terminal_p50"] == 80


@pytest.mark.parametrize("name", ["sea_urchin", "template"])
def test_observed_counts_may_have_gaps(name):
    """Lineage files give what was observed and no more."""
    lineage = Path(__file__).parents[2] / "lineages" / f"{name}.ron"
    founders = {founder.name: founder for founder in furrow.tree(lineage, memo=furrow.Memo()).founders}
    seen = [founder.observed for founder in founders.values() if founder.observed is not None]
    assert seen and any(observed.mean is None or observed.terminal is None for observed in seen)


def test_cues_by_name_are_scenarios_of_that_name(known):
    cues = {"mine": "tension:gradient,amplitude=0.3", "plain": "none"}
    found = furrow.scenarios(cues=cues, memo=known)
    assert found.cues == cues
    assert found["plain"] == furrow.tree(cue="none", memo=known)
    # A tree has the names of its cues.
    assert found["mine"].newick() == furrow.tree(cue=cues["mine"], memo=known).newick() != found["plain"].newick()
    for bad in ({"a:b": "none"}, {3: "none"}, {"a": 3}, 3, "none"):
        with pytest.raises(furrow.InputError) as refused:
            furrow.scenarios(cues=bad)
        assert refused.value.field == "cues"
    with pytest.raises(furrow.InputError, match="at least one lineage"):
        furrow.scenarios([])


DOUBTFUL = """Lineage(name: "S", units: (length_um: 3.2), dies: ["Sx"], limits: (max_depth: 2), founders: [
    (name: "S", r0: 13), (name: "A", mother: "S", daughter: larger, r0: 6.2),
    (name: "B", mother: "S", daughter: smaller, r0: 5.5)],
    physics_rules: [(parameter: "epsilon", value: 0.86), (parameter: "epsilon", value: 0.85)])"""


def test_trees_have_the_warnings_of_the_command_line(cli, memo):
    (cli.folder / "doubtful.ron").write_text(DOUBTFUL)
    found = furrow.tree(cli.folder / "doubtful.ron", memo=memo).warnings
    for doubt in (
        'founder "S": r0 = 13 is in L_h (41.60 µm); if it is in µm, write r0: "13um"',
        'founder "S": r0 = 13, but its daughters "A" (r0 = 6.2) and "B" (r0 = 5.5) have 0.18 times its volume together, at birth',
        "physics_rules[1] never acts: physics_rules[0] comes first for epsilon and applies to all its cells",
        'dies: the tree has no cell "Sx"',
    ):
        assert found.count(doubt) == 1
    command = [str(cli.program), "tree", "doubtful.ron", "--no-cache", "--out", "out"]
    theirs = subprocess.run(command, cwd=cli.folder, check=True, capture_output=True, text=True).stderr
    said = [line.removeprefix(" WARN ").removeprefix("doubtful.ron: ") for line in theirs.splitlines() if " WARN " in line]
    assert sorted(said) == sorted(found)


def test_trees_doubt_sizes_cues_and_undecided_cells(memo):
    small = '(name: "S", founders: [(name: "S", r0: 3)], limits: (max_depth: 1))'
    assert furrow.tree(small, memo=memo).warnings == ()
    (size,) = (doubt for doubt in furrow.tree(small.replace("3", "9"), memo=memo).warnings if "far from the sizes" in doubt)
    assert size.startswith("R0 = 9 L_h")
    (who,) = furrow.tree(small, cue="tension:gradient,amplitude=0.3", memo=memo).warnings
    assert who.startswith("no founder of the lineage has a cue: tension:gradient,amplitude=0.3 is given to S")
    for tree in (
        furrow.tree(small, dynamics=True, t_max=0.01, memo=memo),
        furrow.grow(furrow.Cell(3, t_max=0.01), lambda born: None, name="S", memo=memo),
    ):
        (undecided,) = tree.warnings
        assert undecided.startswith("cell S (R0 = 3) is undecided, and its branch ends there: ")
    with pytest.raises(furrow.InputError, match="30um"):
        furrow.tree(r0=30)


def test_every_call_says_that_its_store_cannot_be_used(tmp_path):
    (tmp_path / "furrow.sqlite").mkdir()
    memo, small = furrow.Memo(tmp_path), '(name: "S", founders: [(name: "S", r0: 2.4)])'
    doses = {"dose": [0.5, 1.0], "larger_share": [0.55, 0.6]}
    for epsilon in (0.86, 0.87):
        warnings = furrow.tree(small, epsilon=epsilon, memo=memo).warnings
        assert len(warnings) == 1 and "going on without storing" in warnings[0]
        assert furrow.sweep(axes={"r0": [2.5]}, epsilon=epsilon, memo=memo).warnings == warnings
        for call in (
            lambda epsilon=epsilon: furrow.Cell(2.5, epsilon=epsilon).divide(memo=memo),
            lambda epsilon=epsilon: furrow.compare.dose(doses, epsilon=epsilon, memo=memo),
        ):
            with pytest.warns(UserWarning, match="going on without storing") as told:
                call()
            assert len(told) == 1


def test_branch_lengths_that_a_format_cannot_have_are_refused(worm):
    for format, lengths in (("csv", "generation"), ("lineagetree", "none"), ("newick", "minute")):
        with pytest.raises(furrow.InputError) as refused:
            worm.export(format, lengths)
        assert refused.value.field == "lengths" and "--" not in str(refused.value)
    assert worm.export("csv").startswith("name,") and worm.export("newick") == worm.export("newick", "time")


FULL_DISK = """
import resource, signal, sys
import furrow

folder = sys.argv[1]
tree = furrow.tree('(name: "S", founders: [(name: "S", r0: 2.4)])')
several = furrow.scenarios(cues=["none", "germline"])
spread = furrow.tree_ensemble('(name: "S", founders: [(name: "S", r0: 2.4)])', replicates=2)
table = {"embryo": list("abcd"), "mother": ["P0"] * 4, "chi": [0.18, 0.17, 0.16, 0.15]}
asked = {"free": ["cue.amplitude"], "particles": 2, "moves": 1, "samples": 20, "intervals": 32}
tested = furrow.test(table, ["tension:gradient,amplitude=0.3"], noise="replicates", **asked)
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
for save, name in (
    (tree.save, "tree.json"), (tree.save, "tree.html"), (several.save, "several.html"), (several.save, "several.csv"),
    (spread.save, "spread.html"), (tested.save_samples, "samples.csv"),
    (lambda path: furrow.reproduce("S3", table=path), "table.md"),
):
    path = f"{folder}/{name}"
    with open(path, "w") as file:
        file.write("old")
    try:
        save(path)
    except OSError:
        pass
    else:
        raise AssertionError(f"{name} was written")
    with open(path) as file:
        assert file.read() == "old", name
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such limit there")
def test_a_file_that_cannot_be_written_stays_as_it_was(tmp_path):
    done = subprocess.run([sys.executable, "-c", FULL_DISK, str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(list(tmp_path.iterdir())) == 7
