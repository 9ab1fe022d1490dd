"""Growing lineages: one tree, several side by side, their spread, and trees by a function of one's own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex

from . import _furrow
from ._cell import Cell
from ._checks import bool_of, cues_of, given_of, path_of, refused, seed_of, text_of, text_or_path, threads_of, whole
from ._memo import memo_of
from ._progress import Progress, shown
from ._results import Division, division
from ._studies import Constants, Ranges, table_of
from ._tree import Tree

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Value
    from ._furrow import Memo


class Scenarios(Mapping[str, Tree]):
    """Several trees, grown in one run, by name."""

    def __init__(self, named: Sequence[tuple[tuple[str, str, str, str | None], Tree]]) -> None:
        self._named = tuple(named)
        self._trees = {names[0]: tree for names, tree in named}
        #: The cue of each as given; None for the lineage's own cues.
        self.cues: dict[str, str | None] = {names[0]: names[3] for names, _ in named}

    def _files(self) -> tuple[str, str, str]:
        return _furrow.scenarios_files([(names, tree._grown) for names, tree in self._named])

    def table(self) -> str:
        """The table of all scenarios as ``furrow tree`` prints it."""
        return self._files()[2]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the interactive page of all scenarios (``.html``) or their table (``.csv``)."""
        file = Path(path_of("path", path))
        if file.suffix not in (".html", ".csv"):
            raise refused("path", str(path), "a file that ends in .html or .csv")
        page, csv, _ = self._files()
        _furrow.write_text(file, page if file.suffix == ".html" else csv)

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


def tree(
    lineage: str | os.PathLike[str] | None = None,
    *,
    cue: str | None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Tree:
    """Grows a lineage from one cell: solves every division, then those of the daughters, until no cell can divide.

    ``lineage`` is a lineage file, its text, or None for the built-in C. elegans founders. ``cue`` replaces every cue of
    the lineage. ``r0`` is the radius of the first cell; other keywords are parameters with the names of ``furrow --set``.
    ``law`` is a law of active stress in place of the paper's, as of :class:`Cell`. ``dynamics=True`` computes the division of
    every cell, including those below the critical radius.

    >>> import furrow
    >>> worm = furrow.tree()
    >>> len(worm), worm.founders[0].name, round(worm.founders[0].chi, 3)
    (253, 'P0', 0.185)

    :func:`scenarios` grows several, :func:`tree_ensemble` one over sets of constants or seeds, and :func:`grow` one whose
    cells get their parameters from a function. ``seed`` is that of the noise, ``preset`` and ``config`` are those of
    :class:`Cell`, and ``memo``, ``threads`` and ``progress`` those of :meth:`Cell.divide`.
    """
    known = memo_of(memo)
    given = given_of(parameters, preset, config, r0, law)
    cues = [] if cue is None else [text_of("cue", cue)]
    with shown(progress, "divisions") as tell:
        named, work = _furrow.grow(
            [_labelled(lineage)],
            cues,
            given,
            known,
            seed_of(seed),
            bool_of("dynamics", dynamics),
            threads_of(threads),
            tell,
        )
    _, grown, doubts = named[0]
    return Tree(grown, _with(work, doubts))


def _with(work: Mapping[str, Any], doubts: Sequence[str]) -> dict[str, Any]:
    """The work of a run with the warnings of one tree: each once."""
    return {**work, "warnings": list(dict.fromkeys((*work["warnings"], *doubts)))}


def scenarios(
    lineages: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    *,
    cues: Sequence[str] | Mapping[str, str] = (),
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Scenarios:
    """Grows every lineage with every cue in one run, as :func:`tree` grows one with the other arguments.

    Without ``cues`` the lineages keep theirs. Cues by name, as in ``{"my tension": "tension:gradient,amplitude=0.3"}``, name the
    scenarios; in a list ``"my tension=tension:gradient,amplitude=0.3"`` does the same. Without ``lineages`` they are grown in
    the built-in one.

    >>> import furrow
    >>> both = furrow.scenarios(cues=["germline", "none"])
    >>> {name: len(tree) for name, tree in both.items()}
    {'c_elegans-germline': 253, 'c_elegans-none': 319}
    """
    known = memo_of(memo)
    given = given_of(parameters, preset, config, r0, law)
    named_cues = cues_of(cues)
    listed = [lineages] if lineages is None or isinstance(lineages, (str, os.PathLike)) else list(lineages)
    if not listed:
        raise refused("lineages", lineages, "at least one lineage, or None for the built-in one")
    with shown(progress, "divisions") as tell:
        named, work = _furrow.grow(
            [_labelled(one) for one in listed],
            named_cues,
            given,
            known,
            seed_of(seed),
            bool_of("dynamics", dynamics),
            threads_of(threads),
            tell,
        )
    return Scenarios([(names, Tree(grown, _with(work, doubts))) for names, grown, doubts in named])


def tree_ensemble(
    lineage: str | os.PathLike[str] | None = None,
    *,
    constants: str | os.PathLike[str] | Constants | None = None,
    replicates: SupportsIndex | None = None,
    cue: str | None = None,
    r0: Value | None = None,
    seed: SupportsIndex = 0,
    dynamics: bool = False,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Ranges:
    """Grows a lineage many times: with every set of ``constants``, a table written by ``furrow calibrate --ensemble`` or the
    result of :func:`ensemble`, or with ``replicates`` seeds of the noise from ``seed`` on. Gives the range of every count. Other
    arguments are those of :func:`tree`; ``dynamics`` is for seeds alone."""
    known = memo_of(memo)
    given = given_of(parameters, preset, config, r0, law)
    cues = [] if cue is None else [text_of("cue", cue)]
    if (constants is None) == (replicates is None):
        raise refused("constants", constants, "given, or replicates in its place")
    first, count, dynamics = seed_of(seed), threads_of(threads), bool_of("dynamics", dynamics)
    if constants is not None:
        if dynamics:
            raise refused("dynamics", dynamics, "False with constants")
        found, drawing = _furrow.ranges(_labelled(lineage), cues, table_of(constants), given, known, first, count)
        return Ranges(found, drawing)
    seeds = whole("replicates", replicates, 2, 100_000) if replicates is not None else 0
    with shown(progress, "divisions") as tell:
        grown, found, drawing, page, work, doubts = _furrow.grow_spread(
            _labelled(lineage), cues, given, known, first, seeds, dynamics, count, tell
        )
    return Ranges(found, drawing, Tree(grown, _with(work, doubts)), page)


@dataclass(frozen=True)
class NewCell:
    """A cell that is born, for the function of :func:`grow`.

    ``name``: Its name.
    ``r0``: Its radius R0, in L_h.
    ``volume_fraction``: Its volume over that of the first cell, from its share of its mother's.
    ``generation``: Divisions from the first cell.
    ``side``: ``anterior`` or ``posterior``; None for the first cell.
    ``mother``: Its mother's parameters; None for the first cell.
    ``division``: Its mother's division; None for the first cell.
    """

    name: str
    r0: float
    volume_fraction: float
    generation: int
    side: str | None
    mother: Cell | None
    division: Division | None


def grow(
    first: Cell,
    parameters: Callable[[NewCell], Cell | None],
    *,
    name: str = "Z",
    seed: SupportsIndex = 0,
    max_depth: SupportsIndex = 60,
    max_cells: SupportsIndex = 100_000,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
) -> Tree:
    """Grows a tree whose cells get their parameters from a function: shells set by the mother, cues that are lost, anything.

    ``parameters`` is called for every cell after the first and returns its :class:`Cell`; None ends the branch as a limit of
    depth would. The first cell is called ``name``, and daughters by their mother's name and ``a`` (anterior, the pole u = 1) or
    ``p`` (posterior). The smaller daughter of a cell whose poles are alike is on a side that ``seed`` and the cell's name draw,
    as in :func:`tree`. Branches end after ``max_depth`` divisions, and the tree at ``max_cells``.
    A generation is solved at once, on all cores or ``threads``. Every cell's division is computed. ``memo`` and ``progress`` are
    those of :meth:`Cell.divide`.

    Each shell is rounder than that of the mother:

    >>> import furrow
    >>> def rounder(cell):
    ...     return cell.mother.replace(r0=cell.r0, aspect=1 + 0.8 * (cell.mother.aspect - 1))
    >>> grown = furrow.grow(furrow.Cell(2.4), rounder)
    >>> [cell.name for cell in grown], round(float(grown.cells["aspect"][1]), 3)
    (['Z', 'Za', 'Zp'], 1.404)
    """
    known = memo_of(memo)
    born: dict[str, Cell] = {}
    numerics = ("stages", "intervals", "modes", "elements")

    def rule(
        cell: str,
        r0: float,
        volume_fraction: float,
        generation: int,
        side: str | None,
        mother: str | None,
        record: Mapping[str, Any] | None,
    ) -> _furrow.Inputs | None:
        if mother is None or record is None:
            given: Cell | None = first
        else:
            above = born[mother]
            divided = division(above, seed_of(seed), record)
            given = parameters(NewCell(cell, r0, volume_fraction, generation, side, above, divided))
        if given is None:
            return None
        if not isinstance(given, Cell):
            raise refused("parameters", given, "a function that returns a Cell or None")
        if any(getattr(given, number) != getattr(first, number) for number in numerics):
            raise refused("parameters", given, "a function whose cells have the numerics of the first")
        born[cell] = given
        return given._inputs

    if not isinstance(first, Cell):
        raise refused("first", first, "a Cell")
    if not callable(parameters):
        raise refused("parameters", parameters, "a function that takes a NewCell and returns a Cell or None")
    limits = whole("max_depth", max_depth, 0, 1000), whole("max_cells", max_cells, 1, 10_000_000)
    named = text_of("name", name)
    with shown(progress, "divisions") as tell:
        grown, work = _furrow.grow_by(named, first.r0, rule, known, seed_of(seed), limits, threads_of(threads), tell)
    return Tree(grown, work)


def _labelled(lineage: str | os.PathLike[str] | None) -> tuple[str, str | None]:
    """The name of a lineage, and its file or text."""
    if lineage is None:
        return "c_elegans", None
    text, path = text_or_path("lineage", lineage, "Lineage")
    return ("lineage", text) if path is None else (Path(path).stem or "lineage", path)
