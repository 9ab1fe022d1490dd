"""Writes sharded.zip: the embryo of the tests as a GEFF in shards, as Python's Zarr writes them (zarr 3.1, numpy)."""

import shutil
import tempfile
from pathlib import Path

import numpy as np
import zarr

SPOTS = [(10, 1, 20, "P0"), (11, 2, 20, "ID11"), (12, 3, 15, "AB"), (13, 3, 10, "P1"), (14, 4, 15, "AB"), (15, 6, 10, "P1")]
SPOTS += [(16, 5, 11, "ABa"), (17, 5, 12, "ABp"), (18, 6, 11, "ABa"), (19, 6, 12, "ABp")]
EDGES = [(10, 11), (11, 12), (11, 13), (12, 14), (13, 15), (14, 16), (14, 17), (16, 18), (17, 19)]
AXES = [{"name": "t", "type": "time", "unit": "second"}, {"name": "x", "type": "space", "unit": "micrometer"}]

with tempfile.TemporaryDirectory() as folder:
    group = zarr.open_group(Path(folder) / "embryo.geff", mode="w", zarr_format=3)
    group.attrs["geff"] = {"geff_version": "1.3", "directed": True, "sphere": "size", "axes": AXES, "node_props_metadata": {}}
    columns = list(zip(*SPOTS, strict=True))
    rows = {"chunks": (2,), "shards": (8,)}
    group.create_array("nodes/ids", data=np.array(columns[0], "uint64"), **rows)
    group.create_array("nodes/props/t/values", data=60.0 * np.array(columns[1], "float64"), **rows)
    group.create_array("nodes/props/size/values", data=np.array(columns[2], "float32"), compressors=None, **rows)
    group.create_array("nodes/props/name/values", data=np.array(columns[3], "<U4"), **rows)
    group.create_array("edges/ids", data=np.array(EDGES, "uint64"), chunks=(2, 1), shards=(4, 2))
    shutil.make_archive("sharded", "zip", folder)
