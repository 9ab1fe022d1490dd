"""Lineages: the tree grown from one cell, and several trees side by side."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from . import _furrow
from ._checks import given_of, path_of, refused, seed_of, text_of, threads_of
from ._founders import Founder, founder_of
from ._memo import memo as shared_memo
from ._progress import Progress, shown
from ._results import Array
from ._tables import frame, html_table

if TYPE_CHECKING:
    import networkx as nx
    import pandas as pd
    from lineagetree import LineageTree
    from matplotlib.figure import Figure

    from ._cell import Value
    from ._furrow import GrownTree, Memo
    from ._studies import Constants, Ranges

#: The largest tree that a notebook draws (half a megabyte); for larger ones it shows the founders' table.
MOST_DRAWN = 1000


class Tree:
    """A grown lineage. Numbers of all cells are arrays in breadth-first order: ``tree.r0``, ``tree.chi``, ``tree["t_end"]``.

    Missing values, such as χ of a cell that did not divide, are NaN. If the lineage has a clock, ``tree["birth_min"]`` and
    ``tree["division_min"]`` are in minutes.
    """

    def __init__(self, grown: GrownTree, work: Mapping[str, Any] | None = None) -> None:
        self._grown = grown
        self._cells: dict[str, Any] | None = None
        #: Divisions solved.
        self.divisions_solved: int = 0 if work is None else work["divisions_solved"]
        #: Divisions reused from the memo.
        self.memo_hits: int = 0 if work is None else work["memo_hits"]
        #: Warnings of the run, such as a cache that cannot be written.
        self.warnings: tuple[str, ...] = () if work is None else tuple(work["warnings"])

    def __len__(self) -> int:
        return len(self._grown)

    @property
    def cells(self) -> Mapping[str, Any]:
        """All columns by name: numbers as arrays, strings as lists."""
        if self._cells is None:
            self._cells = self._grown.cells()
        return self._cells

    def __getitem__(self, column: str) -> Any:
        return self.cells[column]

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
        return tuple(founder_of(found) for found in json.loads(self._grown.founders()))

    @property
    def ended(self) -> dict[str, int]:
        """Numbers of cells without daughters, by reason."""
        return dict(json.loads(self._grown.ended()))

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
    def export(self, format: str, lengths: str = "time", *, path: None = None) -> str | dict[str, str] | dict[str, bytes]: ...
    @overload
    def export(self, format: str, lengths: str = "time", *, path: str | os.PathLike[str]) -> None: ...
    def export(
        self, format: str, lengths: str = "time", *, path: str | os.PathLike[str] | None = None
    ) -> str | dict[str, str] | dict[str, bytes] | None:
        """The tree in a format for other programs: ``newick``, ``nhx``, ``nexus``, ``csv``, ``lineagetree``, ``graphml``,
        ``ctc``, or ``itol`` and ``geff``, which give several files by name. With ``path`` it is written there instead, to a file,
        or for ``itol`` and ``geff`` to a folder.

        ``lengths`` are the branch lengths: ``time``, ``generation``, ``none`` or, if the lineage has a clock, ``minutes``.
        """
        format, lengths = text_of("format", format), text_of("lengths", lengths)
        if path is not None:
            self._grown.write_export(format, lengths, path_of("path", path))
            return None
        files = self._grown.export(format, lengths)
        if len(files) == 1 and not files[0][0]:
            text: str = files[0][1]
            return text
        several: dict[str, str] | dict[str, bytes] = dict(files)
        return several

    def to_json(self) -> str:
        """The text of ``tree.json``; :func:`furrow.read_tree` reads it."""
        return self._grown.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The content of ``tree.json``."""
        return dict(json.loads(self._grown.to_json()))

    def to_pandas(self) -> pd.DataFrame:
        """One row per cell."""
        return frame(self.cells)

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
        (``.html``)."""
        file = Path(path_of("path", path))
        texts = {".json": self.to_json, ".nwk": self.newick, ".svg": self.svg, ".html": self._grown.html}
        if file.suffix not in texts:
            raise refused("path", str(path), f"a file that ends in {', '.join(texts)}")
        file.write_text(texts[file.suffix](), encoding="utf-8")

    def plot(self, *, path: str | None = None) -> Figure:
        """Rounds of the founders and the observed rounds; needs matplotlib."""
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
        # A notebook stores what it shows: drawings of larger trees are megabytes and illegible.
        if len(self) > MOST_DRAWN:
            return None
        return self._grown.svg()

    def _repr_html_(self) -> str:
        drawing = self._repr_svg_()
        if drawing is None:
            return self._founders_html(f"{self.organism}: {len(self)} cells, too many to be drawn here")
        # The drawing has a fixed width; limit it to that of the notebook.
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


class Scenarios(Mapping[str, Tree]):
    """Several trees, grown in one run, by name."""

    def __init__(self, trees: Mapping[str, Tree], cues: Mapping[str, str | None]) -> None:
        self._trees = dict(trees)
        #: The cue of each as given; None for the lineage's own cues.
        self.cues = dict(cues)

    def __getitem__(self, name: str) -> Tree:
        return self._trees[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._trees)

    def __len__(self) -> int:
        return len(self._trees)

    def to_dict(self) -> dict[str, Any]:
        """All trees as numbers, strings and lists."""
        return {name: tree.to_dict() for name, tree in self.items()}

    def to_pandas(self) -> pd.DataFrame:
        """The founders' tables of all trees, concatenated."""
        import pandas as pd

        tables = {name: tree.founders_to_pandas() for name, tree in self.items()}
        table: pd.DataFrame = pd.concat(tables, names=["scenario"]).reset_index("scenario").reset_index(drop=True)
        return table

    def __repr__(self) -> str:
        return f"<furrow.Scenarios {', '.join(self)}>"

    def _repr_html_(self) -> str:
        parts = [tree._founders_html(f"{name}: {len(tree)} cells") for name, tree in self.items()]
        return f"<div style='display:flex;gap:2em;flex-wrap:wrap'>{''.join(parts)}</div>"


@overload
def tree(
    lineage: str | os.PathLike[str] | None = None,
    *,
    cue: str | None = None,
    cues: None = None,
    constants: None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Tree: ...
@overload
def tree(
    lineage: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    *,
    cue: None = None,
    cues: Sequence[str],
    constants: None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Scenarios: ...
@overload
def tree(
    lineage: Sequence[os.PathLike[str]] | list[str],
    *,
    cue: None = None,
    cues: Sequence[str] | None = None,
    constants: None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Scenarios: ...
@overload
def tree(
    lineage: str | os.PathLike[str] | None = None,
    *,
    cue: str | None = None,
    cues: None = None,
    constants: str | os.PathLike[str] | Constants,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: Literal[False] = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Ranges: ...
def tree(
    lineage: Any = None,
    *,
    cue: str | None = None,
    cues: Sequence[str] | None = None,
    constants: Any = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Tree | Scenarios | Ranges:
    """Grows a lineage from one cell: solves every division, then those of the daughters, until no cell can divide.

    ``lineage`` is a lineage file, its text, or None for the built-in C. elegans founders. ``cue`` replaces every cue of
    the lineage. With ``cues``, or several lineages, every combination is grown in one run and the result is
    :class:`Scenarios`; ``"my tension=tension:gradient,amplitude=0.3"`` names one. With ``constants``, a table written by
    ``furrow calibrate --ensemble`` or the result of :func:`furrow.ensemble`, the lineage is grown with every set and the
    result is :class:`Ranges`. ``r0`` is the radius of the first cell; other keywords are parameters with the names of
    ``furrow --set``. ``dynamics=True`` computes the division of every cell, including those below the critical radius.

    >>> import furrow
    >>> worm = furrow.tree()
    >>> len(worm), worm.founders[0].name, round(worm.founders[0].chi, 3)
    (253, 'P0', 0.185)
    """
    known = shared_memo() if memo is None else memo
    given = dict(parameters) if r0 is None else {"r0": r0, **parameters}
    several = cues is not None or (not isinstance(lineage, (str, os.PathLike)) and lineage is not None)
    lineages = [lineage] if lineage is None or isinstance(lineage, (str, os.PathLike)) else list(lineage)
    if cue is not None and cues is not None:
        raise refused("cues", list(cues), "given without cue")
    if isinstance(cues, str):
        raise refused("cues", cues, "a list of cues; a single one is given as cue")
    wanted = [cue] if cue is not None else [] if cues is None else list(cues)
    labelled = [_labelled(one) for one in lineages]
    settings = given_of(given, preset, config)
    if constants is not None:
        from ._studies import ranges_of

        if several:
            raise refused("constants", constants, "given with one lineage and at most one cue")
        if dynamics:
            raise refused("dynamics", dynamics, "False with constants")
        return ranges_of(labelled, wanted, constants, settings, known, seed, threads)
    with shown(progress, "divisions") as tell:
        named, work = _furrow.grow(
            labelled,
            [text_of("cue", text) for text in wanted],
            settings,
            known,
            seed_of(seed),
            bool(dynamics),
            threads_of(threads),
            tell,
        )
    took = json.loads(work)
    if not several:
        return Tree(named[0][3], took)
    trees = {name: Tree(grown, took) for name, _, _, grown in named}
    return Scenarios(trees, {name: cue for name, _, cue, _ in named})


def _labelled(lineage: str | os.PathLike[str] | None) -> tuple[str, str | None]:
    """The name of a lineage, and its file or text."""
    if lineage is None:
        return "c_elegans", None
    if isinstance(lineage, str) and (lineage.lstrip().startswith("(") or "Lineage(" in lineage):
        return "lineage", lineage
    path = path_of("lineage", lineage)
    return Path(path).stem or "lineage", path


def read_tree(path: str | os.PathLike[str]) -> Tree:
    """Reads a ``tree.json`` written by ``furrow tree`` or :meth:`Tree.save`."""
    return Tree(_furrow.read_tree(path_of("path", path)))
