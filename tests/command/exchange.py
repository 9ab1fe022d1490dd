"""Reads the exports of a tree with the packages that they are for, and holds them against tree.json.

    python exchange.py PACKAGE [--installed]

Run by tests/command/sessions/export.txt in a folder with t/tree.json and the exports. With --installed it finds out whether the package is there.
"""

import csv
import importlib
import importlib.metadata
import json
import os
import subprocess
import sys
import warnings

warnings.simplefilter("ignore")
part = sys.argv[1]
importlib.import_module(part)
if "--installed" in sys.argv:
    sys.exit(0)

DISTRIBUTIONS = {"Bio": "biopython", "lineagetree": "lineagetree"}
print(part, importlib.metadata.version(DISTRIBUTIONS.get(part, part)))

document = json.load(open("t/tree.json"))
cells = {cell["name"]: cell for cell in document["cells"]}
daughters = {}
for cell in document["cells"]:
    daughters.setdefault(cell["mother"], []).append(cell["name"])


def ends_in_order():
    ends, stack = [], list(daughters[None])
    while stack:
        name = stack.pop()
        below = daughters.get(name, [])
        stack.extend(reversed(below))
        if not below:
            ends.append(name)
    return ends


ENDS = ends_in_order()
assert len(cells) == 253 and len(ENDS) == 127

LENGTHS = {
    "time": lambda cell: cell["t_end"],
    "generation": lambda cell: 1.0 if cell["mother"] else 0.0,
    "none": lambda cell: None,
}
# What Newick comments say of a cell; the rest is structure, or has characters that they reserve.
NOTES = ["founder", "generation", "r0", "volume_fraction", "outcome", "chi", "chi_signed", "u_furrow", "t_end"]


def same_note(cell, name, read):
    known = cells[cell][name]
    if known is None:
        assert read is None, (cell, name, read)
    elif isinstance(known, str):
        assert read == known, (cell, name, read)
    else:
        assert float(read) == known, (cell, name, read)


def same(kind, file, nodes, ends):
    """nodes: name -> (mother's name, length, notes or None); lengths that are missing are None."""
    assert ends == ENDS, (file, ends[:5])
    assert set(nodes) == set(cells), (file, set(cells) ^ set(nodes))
    for name, (mother, length, notes) in nodes.items():
        assert mother == cells[name]["mother"], (file, name, mother)
        assert length == LENGTHS[kind](cells[name]), (file, name, length)
        for note in NOTES if notes is not None else []:
            same_note(name, note, notes.get(note))
    print(f"  {file}: {len(nodes)} cells, {len(ends)} ends")


def ete4():
    from ete4 import Tree

    for kind, file in [("time", "time.nwk"), ("generation", "generation.nwk"), ("none", "none.nwk"), ("time", "time.nhx")]:
        tree = Tree(open(file), parser=1)
        nodes = {}
        for node in tree.traverse():
            notes = dict(node.props) if file.endswith("nhx") else None
            nodes[node.name] = (node.up.name if node.up else None, node.dist, notes)
        same(kind, file, nodes, list(tree.leaf_names()))


def dendropy():
    from dendropy import Tree

    files = [("time", "time.nwk", "newick"), ("generation", "generation.nwk", "newick"), ("none", "none.nwk", "newick"),
             ("time", "time.nhx", "newick"), ("time", "time.nex", "nexus"), ("generation", "generation.nex", "nexus")]
    for kind, file, schema in files:
        tree = Tree.get(path=file, schema=schema)
        name = lambda node: node.taxon.label if node.taxon else node.label
        nodes = {}
        for node in tree.preorder_node_iter():
            notes = None if file.endswith("nwk") else node.annotations.values_as_dict()
            above = node.parent_node
            nodes[name(node)] = (name(above) if above else None, node.edge.length, notes)
        same(kind, file, nodes, [name(leaf) for leaf in tree.leaf_node_iter()])
        assert schema == "newick" or tree.is_rooted


def Bio():
    from Bio import Phylo

    files = [("time", "time.nwk", "newick"), ("generation", "generation.nwk", "newick"), ("none", "none.nwk", "newick"),
             ("time", "time.nhx", "newick"), ("time", "time.nex", "nexus"), ("generation", "generation.nex", "nexus")]
    for kind, file, schema in files:
        tree = Phylo.read(file, schema)
        # The reader of Nexus takes names of inner nodes that have comments for confidences, and missing lengths for 0.
        name = lambda clade: clade.name or clade.confidence
        nodes, above = {}, {}
        for clade in tree.find_clades():
            length = clade.branch_length
            missing = schema == "nexus" and length == 0.0 and LENGTHS[kind](cells[name(clade)]) is None
            nodes[name(clade)] = (above.get(name(clade)), None if missing else length, None)
            above.update((name(below), name(clade)) for below in clade.clades)
        same(kind, file, nodes, [name(clade) for clade in tree.get_terminals()])


def lineagetree():
    from lineagetree import LineageTree, read_from_csv

    rows = list(csv.DictReader(open("cells.csv")))
    read = read_from_csv("cells.txt")
    # Nodes are numbered anew; the third coordinate says which row of the cells each is.
    name = {node: rows[int(read.pos[node][2])]["name"] for node in read.nodes}
    compare(read, name, "cells.txt")
    order = sorted(read.leaves, key=lambda node: read.pos[node][0])
    assert [name[node] for node in order] == ENDS
    # The recipe of the book.
    page = open(os.environ["FURROW_ROOT"] + "/docs/book/src/use/tree-files.md").read()
    recipe = page.split("```python\n")[1].split("```")[0].replace("furrow-out/", "t/")
    assert recipe.count("\n") == 5
    told = {"json": json, "LineageTree": LineageTree}
    exec(recipe, told)
    made = told["tree"]
    compare(made, made.cell_name, "the recipe")
    assert all(made.r0[node] == cells[made.cell_name[node]]["r0"] for node in made.nodes)


def compare(tree, name, file):
    assert sorted(name[node] for node in tree.nodes) == sorted(cells)
    assert sorted(name[node] for node in tree.leaves) == sorted(ENDS)
    for node in tree.nodes:
        above = tree.predecessor[node]
        assert (name[above[0]] if above else None) == cells[name[node]]["mother"]
        # One time point a generation, as it was exported.
        assert tree.time[node] == cells[name[node]]["generation"]
    print(f"  {file}: {len(tree.nodes)} cells, {len(tree.leaves)} ends")


def networkx():
    import networkx

    graph = networkx.read_graphml("tree.graphml")
    assert networkx.is_arborescence(graph)
    nodes = {}
    for name in graph.nodes:
        above = next(graph.predecessors(name), None)
        # The first cell has no edge that leads to it, and its length is its t_end alone.
        length = graph.edges[above, name].get("length") if above else graph.nodes[name].get("t_end")
        nodes[name] = (above, length, graph.nodes[name])
    same("time", "tree.graphml", nodes, [name for name in ENDS if graph.out_degree(name) == 0])


def geff():
    import geff
    from geff.validate.data import ValidationConfig
    from geff.validate.structure import validate_structure

    for file, key in [("tree.geff", "birth_min"), ("generation.geff", "generation")]:
        validate_structure(file)
        wanted = ValidationConfig(graph=True, sphere=True, ellipsoid=True, lineage=True, tracklet=True)
        graph, metadata = geff.read(file, structure_validation=True, data_validation=wanted)
        nodes = {}
        for node, read in graph.nodes(data=True):
            cell = cells[read["name"]]
            above = [graph.nodes[mother]["name"] for mother in graph.predecessors(node)]
            nodes[cell["name"]] = (above[0] if above else None, LENGTHS["none"](cell), None)
            assert len(above) < 2 and read["t"] == cell.get(key, cell["generation"]), (file, read)
            assert (read["r0"], read["volume"]) == (cell["r0"], cell["volume_fraction"]), (file, read)
            assert (read.get("chi"), read.get("outcome")) == (cell["chi"], cell["outcome"]), (file, read)
            assert (read["founder"], read["generation"]) == (cell["founder"], cell["generation"]), (file, read)
        unit = "minute" if key in document["cells"][0] and key == "birth_min" else None
        assert metadata.directed and metadata.axes[0].unit == unit, metadata.axes
        same("none", file, nodes, ENDS)


def jsonschema():
    from jsonschema import Draft202012Validator

    furrow = os.environ["FURROW_BINARY"]
    run = lambda *arguments: subprocess.run([furrow, *arguments], check=True, capture_output=True, text=True).stdout
    schema = json.loads(run("export", "--schema"))
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    # Scenarios, cells that cannot be computed, other animals and a limit, beside the tree of the founders.
    run("tree", "--cue", "germline", "--cue", "none", "--cue", "tension:gradient,amplitude=0.3", "--out", "cues", "--no-cache")
    run("tree", os.environ["FURROW_ROOT"] + "/lineages/sea_urchin.ron", "--out", "urchin", "--no-cache")
    run("tree", os.environ["FURROW_ROOT"] + "/lineages/template.ron", "--out", "template", "--no-cache")
    run("tree", "--set", "t_max=2", "--dynamics", "--out", "undecided", "--no-cache", "--quiet")
    found = [os.path.join(folder, name) for folder, _, names in os.walk(".") for name in names if name == "tree.json"]
    assert len(found) == 7, found
    reasons = set()
    for file in found:
        tree = json.load(open(file))
        errors = [f"{list(error.path)}: {error.message}" for error in validator.iter_errors(tree)]
        assert not errors, (file, errors[:3])
        reasons |= {cell["ended"]["reason"] for cell in tree["cells"] if cell["ended"]}
        print(f"  {file}: {len(tree['cells'])} cells")
    assert "undecided" in reasons and "below_pitchfork" in reasons, reasons
    # One value of a tree changed: every violation of the schema is refused.
    for place, value in WRONG.items():
        wrong = json.load(open("t/tree.json"))
        inside, keys = wrong, [int(key) if key.isdigit() else key for key in place.split("/")]
        for key in keys[:-1]:
            inside = inside[key]
        inside[keys[-1]] = value
        assert not validator.is_valid(wrong), place


WRONG = {
    "schema_version": 2,
    "seed": -1,
    "cells/3/outcome": "both",
    "cells/0/chi": 1.5,
    "cells/0/generation": 0.5,
    "cells/0/daughter": "left",
    "cells/3/cue": {"kappa": {}},
    "cells": [],
    "lineage/naming": ["a"],
    "cell/material": {},
}

globals()[part]()
