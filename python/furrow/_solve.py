"""The values of one parameter that give a wanted division."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

from . import _furrow
from ._checks import given_of, number_of, optional_path, pair_of, refused, seed_of, text_of, threads_of, whole
from ._memo import memo_of
from ._progress import Progress, shown

if TYPE_CHECKING:
    from ._cell import Value
    from ._furrow import Memo


def solve(
    unknown: str,
    *,
    chi: SupportsFloat | None = None,
    chi_signed: SupportsFloat | None = None,
    u: SupportsFloat | None = None,
    t: SupportsFloat | None = None,
    range: Sequence[SupportsFloat] | None = None,
    points: SupportsIndex = 65,
    seed: SupportsIndex = 0,
    cue: str = "none",
    lineage: str | os.PathLike[str] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> dict[str, Any]:
    """Finds the values of one parameter at which a cell divides with a wanted ``chi``, ``chi_signed``, furrow position ``u``
    or time ``t``; give one of them.

    ``unknown`` is ``r0``, ``epsilon``, ``xi_s``, any other number of a cell, or ``cue.u0``, ``cue.omega``, ``cue.amplitude``,
    ``regulator.turnover`` and the like.
    ``range`` is its first and last value; the defaults are those of ``furrow solve``. The range is scanned at ``points``
    values, and every crossing is refined to 1e-9 of the range. The answer has ``roots``, a list of dicts with ``value``,
    ``chi``, ``chi_signed``, ``smaller`` (the smaller daughter: "posterior", "anterior", "either" or "neither"), ``u_furrow``
    and ``t_end``; ``jumps``, where the outcome leaps over the wanted one; ``gaps``, where the cell does
    not divide; ``seen``, the least and the greatest outcome and where; and ``divisions``, how many it took.
    Without a root it raises :class:`NoOutcome`, which says what was seen.

    ``cue``, ``lineage``, ``preset``, ``config``, ``law`` and keywords are those of :class:`Cell`, and ``seed``, ``memo``,
    ``threads`` and ``progress`` those of :meth:`Cell.divide`.

    >>> import furrow
    >>> found = furrow.solve("epsilon", chi=0.41, r0=2.977, cue="germline")
    >>> [round(root["value"], 6) for root in found["roots"]]
    [0.889617]
    """
    wanted = {name: value for name, value in (("chi", chi), ("chi_signed", chi_signed), ("u", u), ("t", t)) if value is not None}
    if len(wanted) != 1:
        raise refused("chi", chi, "given, or one of chi_signed, u and t in its place, and no two of them")
    ((name, value),) = wanted.items()
    canonical = _furrow.canonical_name(text_of("unknown", unknown))
    for given, other in parameters.items():
        if _furrow.canonical_name(given) == canonical:
            raise refused(given, other, f"left out: {unknown} is the unknown")
    if canonical != "r0" and not any(_furrow.canonical_name(given) == "r0" for given in parameters):
        raise refused("r0", None, f"given where {unknown} is the unknown")
    ends = None if range is None else list(pair_of("range", range))
    place = optional_path("lineage", lineage)
    inputs = _furrow.Inputs(given_of(parameters, preset, config, law=law), text_of("cue", cue), place)
    known = memo_of(memo)
    asked = (name, number_of(name, value))
    count = whole("points", points, 2, 100_000)
    with shown(progress, "divisions") as tell:
        found = _furrow.solve(inputs, known, seed_of(seed), unknown, asked, ends, count, threads_of(threads), tell)
    return found
