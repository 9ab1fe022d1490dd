"""Observed embryos in the formats of trees."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import SupportsFloat

from . import _furrow
from ._checks import optional_path, path_of, text_of
from ._tables import Table, exported_files, matching_of, positive, tables_of


def export_observed(
    embryo: str | os.PathLike[str],
    format: str,
    lengths: str | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
    subtree: str | None = None,
    lineage: str | os.PathLike[str] | None = None,
    volumes: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    frame_minutes: SupportsFloat | None = None,
    voxel: SupportsFloat | None = None,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
) -> str | dict[str, str] | dict[str, bytes] | None:
    """An observed embryo in a format of :meth:`furrow.Tree.export`: one that another program followed, or a table of lifetimes,
    whose mothers follow from names. With ``path`` it is written there instead.

    ``lengths`` are the branch lengths: ``minutes``, the default, ``generation`` or ``none``; ``csv`` takes none.
    ``subtree`` names a cell: only that one and those below it are exported. ``volumes`` are files of volumes beside a table of
    lifetimes. ``frame_minutes`` are the minutes between frames; without it time points are frames where the file counts them.
    ``voxel`` is the edge of a voxel in µm, ``lineage`` has the founders, and ``names`` and ``root`` match cells with other names,
    as for :func:`furrow.compare.counts`.
    """
    asked = {
        "embryo": path_of("embryo", embryo),
        "format": text_of("format", format),
        "lengths": None if lengths is None else text_of("lengths", lengths),
        "lineage": optional_path("lineage", lineage),
        "volumes": tables_of(volumes, "volumes")[0],
        "frame_minutes": None if frame_minutes is None else positive("frame_minutes", frame_minutes),
        "voxel": None if voxel is None else positive("voxel", voxel),
        "matching": matching_of(names, root),
        "subtree": None if subtree is None else text_of("subtree", subtree),
    }
    files = _furrow.export_observed(asked, None if path is None else path_of("path", path))
    return exported_files(files) if path is None else None
