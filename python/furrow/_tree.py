"""Lineages: the tree grown from one cell, and several trees side by side."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _furrow
from ._checks import path_of, refused, text_of
from ._founders import Founder, founder_of
from ._results import Array, Result
from ._tables import exported_files, frame, html_table, pd_index

if TYPE_CHECKING:
    import networkx as nx
    import pandas as pd
    from lineagetree import LineageTree
    from matplotlib.figure import Figure

    from ._furrow import GrownTree

#: The largest tree that a notebook draws (half a megabyte); for larger ones it shows the founders' table.
MOST_DRAWN = 1000


@dataclass(frozen=True)
class TreeCell(Result):
    """A cell of a tree.

    ``name``: Name.
    ``mother``: Name of its mother; None for the first cell.
    ``daughters``: Names of its daughters, the anterior one first; none if it did not divide.
    ``founder``: The founder that it is or descends from.
    ``generation``: Divisions from the first cell.
    ``r0``: Radius R0, in L_h.
    ``volume_fraction``: Its volume over that of the first cell.
    ``cue``: Its cue.
    ``outcome``: ``symmetric``, ``asymmetric`` or ``failed``; None if it is undecided, or a limit or the lineage file stopped it.
    ``ended``: Why it has no daughters.
    ``chi``: Size asymmetry χ.
    ``chi_signed``: Positive if the daughter at the pole u = 0 is smaller.
    ``u_furrow``: Furrow position.
    ``t_end``: Time of pinch-off or of rest, in τ.
    ``phi``: The regulator φ at the furrow.
    ``birth_min``: Its birth, in minutes; None without a clock.
    ``division_min``: Its division, in minutes.
    """

    name: str
    mother: str | None
    daughters: tuple[str, ...]
    founder: str
    generation: int
    r0: float
    volume_fraction: float
    cue: str
    outcome: str | None
    ended: str | None
    chi: float | None
    chi_signed: float | None
    u_furrow: float | None
    t_end: float | None
    phi: float | None = None
    birth_min: float | None = None
    division_min: float | None = None


class Tree:
    """A grown lineage. ``tree["AB"]`` is a cell; numbers of all cells are arrays in breadth-first order: ``tree.r0``,
    ``tree.chi``, ``tree.cells["t_end"]``.

    Missing values, such as χ of a cell that did not divide, are NaN. If the lineage has a clock, ``tree.cells["birth_min"]``
    and ``tree.cells["division_min"]`` are in minutes, and ``tree.cells["lifetime_extrapolated"]`` says which cells divide after a
    lifetime beyond the sizes to which the clock was fitted.

    >>> import furrow
    >>> worm = furrow.tree()
    >>> worm["AB"].mother, worm["AB"].daughters
    ('P0', ('ABa', 'ABp'))
    >>> "ABa" in worm, "ABx" in worm
    (True, False)
    """

    def __init__(self, grown: GrownTree, work: Mapping[str, Any] | None = None) -> None:
        self._grown = grown
        self._cells: Mapping[str, Any] | None = None
        self._numbers_of: dict[str, int] | None = None
        #: Divisions solved.
        self.divisions_solved: int = 0 if work is None else work["divisions_solved"]
        #: Divisions reused from the memo.
        self.memo_hits: int = 0 if work is None else work["memo_hits"]
        #: Warnings of the run, such as a cache that cannot be written, and doubts about the lineage and the tree, such as rules
        #: that never act or cells that are undecided.
        self.warnings: tuple[str, ...] = () if work is None else tuple(work["warnings"])

    def __len__(self) -> int:
        return len(self._grown)

    @property
    def cells(self) -> Mapping[str, Any]:
        """All columns by name: numbers as arrays, strings as lists."""
        if self._cells is None:
            self._cells = MappingProxyType(self._grown.cells())
        return self._cells

    def _number_of(self) -> Mapping[str, int]:
        if self._numbers_of is None:
            self._numbers_of = {name: k for k, name in enumerate(self.names)}
        return self._numbers_of

    def __contains__(self, name: object) -> bool:
        return name in self._number_of()

    def __iter__(self) -> Iterator[TreeCell]:
        return (self[name] for name in self.names)

    def __getitem__(self, name: str) -> TreeCell:
        numbers, cells = self._number_of(), self.cells
        if name not in numbers:
            from difflib import get_close_matches

            near = get_close_matches(str(name), self.names, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            column = f"; the column is tree.cells[{name!r}]" if name in cells else ""
            raise KeyError(f"no cell {name!r} in the tree{hint}{column}")
        k = numbers[name]
        names, mother = cells["name"], int(cells["mother"][k])

        def number(column: str) -> float | None:
            value = float(cells[column][k]) if column in cells else float("nan")
            return None if np.isnan(value) else value

        return TreeCell(
            name=name,
            mother=names[mother] if mother >= 0 else None,
            daughters=tuple(names[i] for i in np.flatnonzero(cells["mother"] == k)),
            founder=cells["founder"][k],
            generation=int(cells["generation"][k]),
            r0=float(cells["r0"][k]),
            volume_fraction=float(cells["volume_fraction"][k]),
            cue=cells["cue"][k],
            outcome=cells["outcome"][k],
            ended=cells["ended"][k],
            chi=number("chi"),
            chi_signed=number("chi_signed"),
            u_furrow=number("u_furrow"),
            t_end=number("t_end"),
            phi=number("phi"),
            birth_min=number("birth_min"),
            division_min=number("division_min"),
        )

    @property
    def names(self) -> list[str]:
        """Names of the cells."""
        return list(self.cells["name"])

    @property
    def r0(self) -> Array:
        """Radii of the cells, in L_h."""
        return self._numbers("r0")

    @property
    def chi(self) -> Array:
        """χ of the divisions."""
        return self._numbers("chi")

    @property
    def generation(self) -> NDArray[np.int64]:
        """Divisions from the first cell."""
        generation: NDArray[np.int64] = self.cells["generation"]
        return generation

    @property
    def mother(self) -> NDArray[np.int64]:
        """The number of each cell's mother, -1 for the first cell."""
        mother: NDArray[np.int64] = self.cells["mother"]
        return mother

    def _numbers(self, name: str) -> Array:
        column: Array = self.cells[name]
        return column

    @property
    def organism(self) -> str:
        """Name of the organism."""
        return self._grown.organism

    @property
    def founders(self) -> tuple[Founder, ...]:
        """The founders' table."""
        return tuple(founder_of(found) for found in self._grown.founders())

    @property
    def ended(self) -> dict[str, int]:
        """Numbers of cells without daughters, by reason."""
        return self._grown.ended()

    def alive(self) -> tuple[Array, NDArray[np.int64]]:
        """Minutes, and the numbers of cells alive then; the lineage must have a clock.

        >>> import furrow
        >>> minutes, cells = furrow.tree().alive()
        >>> int(cells[0]), int(cells[-1])
        (1, 127)
        """
        found = self._grown.alive()
        if found is None:
            raise refused("tree", self.organism, "a tree whose lineage has a clock")
        return found

    @property
    def last_divisions(self) -> dict[str, float | None]:
        """The last division among the descendants of each founder, in minutes; None without a clock or if none divides."""
        return {founder.name: founder.last_division_min for founder in self.founders}

    def table(self) -> str:
        """The founders' table as ``furrow tree`` prints it."""
        return self._grown.table()

    def newick(self) -> str:
        """The tree as Newick."""
        return self._grown.newick()

    @overload
    def export(
        self, format: str, lengths: str | None = None, *, path: None = None, subtree: str | None = None
    ) -> str | dict[str, str] | dict[str, bytes]: ...
    @overload
    def export(
        self, format: str, lengths: str | None = None, *, path: str | os.PathLike[str], subtree: str | None = None
    ) -> None: ...
    def export(
        self,
        format: str,
        lengths: str | None = None,
        *,
        path: str | os.PathLike[str] | None = None,
        subtree: str | None = None,
    ) -> str | dict[str, str] | dict[str, bytes] | None:
        """The tree in a format for other programs: ``newick``, ``nhx``, ``nexus``, ``csv``, ``lineagetree``, ``graphml``,
        ``ctc``, or ``itol`` and ``geff``, which give several files by name. With ``path`` it is written there instead, to a file,
        or for ``itol`` and ``geff`` to a folder.

        ``lengths`` are the branch lengths: ``time``, the default, ``generation``, ``none`` or, if the lineage has a clock,
        ``minutes``. ``csv`` has a column for each and takes none, and ``lineagetree``, ``geff`` and ``ctc`` take ``generation``
        or ``minutes``. ``subtree`` names a cell: only that one and those below it are exported.
        """
        format, lengths = text_of("format", format), None if lengths is None else text_of("lengths", lengths)
        root = None if subtree is None else text_of("subtree", subtree)
        if path is not None:
            self._grown.write_export(format, lengths, root, path_of("path", path))
            return None
        return exported_files(self._grown.export(format, lengths, root))

    def to_json(self) -> str:
        """The text of ``tree.json``; :func:`furrow.read_tree` reads it."""
        return self._grown.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The content of ``tree.json``."""
        return dict(json.loads(self._grown.to_json()))

    def to_pandas(self) -> pd.DataFrame:
        """One row per cell, by its name; ``mother`` is the mother's name."""
        names = self.names
        mothers = [names[mother] if mother >= 0 else None for mother in self.mother]
        columns = {column: values for column, values in self.cells.items() if column != "name"}
        table = frame({**columns, "mother": mothers})
        table.index = pd_index(names)
        return table

    def founders_to_pandas(self) -> pd.DataFrame:
        """One row per founder: its rounds and the observed rounds."""
        rows: dict[str, list[Any]] = {}
        for founder in self.founders:
            names = ("name", "r0", "cue", "outcome", "chi", "last_division_min")
            row: dict[str, Any] = {name: getattr(founder, name) for name in names}
            for whose, rounds in (("model", founder.rounds), ("observed", founder.observed)):
                for name in ("min", "mean", "max", "full_doublings", "terminal"):
                    row[f"{whose}_{name}"] = None if rounds is None else getattr(rounds, name)
            for name, value in row.items():
                rows.setdefault(name, []).append(value)
        return frame(rows)

    def to_networkx(self) -> nx.DiGraph[str]:
        """A directed graph from mothers to daughters, with cell names as nodes and all columns as attributes."""
        try:
            import networkx as nx
        except ImportError as error:
            raise ImportError("to_networkx needs networkx: pip install networkx") from error
        graph: nx.DiGraph[str] = nx.DiGraph(organism=self.organism)
        cells, names = self.cells, self.names
        columns = {name: column for name, column in cells.items() if name not in ("name", "mother")}
        for k, name in enumerate(names):
            graph.add_node(name, **{key: _scalar(column[k]) for key, column in columns.items()})
        graph.add_edges_from((names[mother], names[k]) for k, mother in enumerate(self.mother) if mother >= 0)
        return graph

    def to_lineagetree(self) -> LineageTree:
        """A tree of the package LineageTree: cells by number, with the generation as time point, and with radius, volume and
        labels."""
        try:
            from lineagetree import LineageTree
        except ImportError as error:
            raise ImportError("to_lineagetree needs LineageTree: pip install LineageTree") from error
        names = self.names
        successor: dict[int, list[int]] = {k: [] for k in range(len(self))}
        for k, mother in enumerate(self.mother):
            if mother >= 0:
                successor[int(mother)].append(k)

        def numbers(column: str) -> dict[int, float]:
            return {k: float(value) for k, value in enumerate(self.cells[column])}

        return LineageTree(
            successor=successor,
            time={k: int(generation) for k, generation in enumerate(self.generation)},
            name=self.organism,
            label=dict(enumerate(names)),
            r0=numbers("r0"),
            volume_fraction=numbers("volume_fraction"),
            chi=numbers("chi"),
        )

    def svg(self, time_axis: str = "generations") -> str:
        """The tree as a drawing, over ``generations`` or, if the lineage has a clock, ``minutes``."""
        return self._grown.svg(text_of("time_axis", time_axis))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes ``tree.json``, or by file extension Newick (``.nwk``), a drawing (``.svg``) or the interactive page
        (``.html``). The file is written whole or not at all."""
        file = Path(path_of("path", path))
        texts = {".json": self.to_json, ".nwk": self.newick, ".svg": self.svg, ".html": self._grown.html}
        if file.suffix not in texts:
            raise refused("path", str(path), f"a file that ends in {', '.join(texts)}")
        _furrow.write_text(file, texts[file.suffix]())

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """Rounds of the founders and the observed rounds; needs matplotlib. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.rounds(self), path)

    def colours(self) -> dict[str, str]:
        """The colour of each founder in all drawings."""
        return dict(self._grown.colours())

    def __eq__(self, other: object) -> bool:
        return self.to_json() == other.to_json() if isinstance(other, Tree) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[object, ...]:
        work = {"divisions_solved": self.divisions_solved, "memo_hits": self.memo_hits, "warnings": self.warnings}
        return (Tree, (self._grown, work))

    def __str__(self) -> str:
        return self.table()

    def __repr__(self) -> str:
        return f"<furrow.Tree of {len(self)} cells of {self.organism}>"

    def _repr_svg_(self) -> str | None:
        # A notebook stores its output: drawings of larger trees are megabytes and illegible.
        if len(self) > MOST_DRAWN:
            return None
        return self._grown.svg()

    def _repr_html_(self) -> str:
        drawing = self._repr_svg_()
        if drawing is None:
            return self._founders_html(f"{self.organism}: {len(self)} cells, too many to be drawn here")
        # The drawing has a fixed width; limit it to the notebook's.
        drawing = drawing.replace("<svg ", '<svg style="max-width:100%;height:auto" ', 1)
        return f'<div style="max-width:100%;overflow:auto">{drawing}</div>'

    def _founders_html(self, caption: str) -> str:
        def row(founder: Founder) -> tuple[str, str]:
            if founder.rounds is None:
                return founder.name, "never born"
            chi = "" if founder.chi is None else f", χ = {founder.chi:.3f}"
            rounds = founder.rounds
            return founder.name, f"{founder.outcome}{chi}; {rounds.min} to {rounds.max} rounds, {rounds.terminal} cells"

        return html_table([row(founder) for founder in self.founders], caption)


def _scalar(value: Any) -> Any:
    """A numpy scalar as a Python number."""
    return value.item() if isinstance(value, np.generic) else value


def read_tree(path: str | os.PathLike[str]) -> Tree:
    """Reads a ``tree.json`` written by ``furrow tree`` or :meth:`Tree.save`."""
    return Tree(_furrow.read_tree(path_of("path", path)))
