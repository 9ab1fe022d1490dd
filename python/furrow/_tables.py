"""Tables that are given, and tables for pandas, which is optional."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, Union

import numpy as np
from numpy.typing import NDArray

from ._checks import bool_of, number_of, path_of, refused, text_of, texts_of
from ._errors import InputError

if TYPE_CHECKING:
    from typing import TypeAlias

    import pandas as pd

#: A file, several, a DataFrame, or columns by name.
Table: TypeAlias = Union[str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]], Mapping[str, Any], "pd.DataFrame"]


#: The allowed kinds of tables.
TABLES = "a file, several files, a DataFrame or columns by name"


def tables_of(table: Table | None, name: str = "table") -> tuple[list[str], str | None]:
    """Files, or a table as CSV; ``name`` is the argument."""
    if table is None:
        return [], None
    if isinstance(table, (str, os.PathLike)):
        return [path_of(name, table)], None
    if hasattr(table, "to_csv") and hasattr(table, "columns"):
        return [], _csv_of_frame(table)
    if isinstance(table, Mapping):
        return [], _csv_of_columns(table, name)
    if not isinstance(table, Iterable):
        raise refused(name, table, TABLES)
    files = [path_of(name, one) for one in table]
    if not files:
        raise refused(name, table, f"{TABLES}; this list is empty")
    return files, None


def _csv_of_frame(given: Any) -> str:
    """A DataFrame as CSV."""
    # Short floats would be written with the digits that tell them apart, which are too few for long ones.
    short = [name for name, kind in given.dtypes.items() if str(kind).lower() in ("float16", "float32")]
    given = given.astype(dict.fromkeys(short, "float64"))
    firsts = [given.columns[0], *given.iloc[:, 0]] if len(given.columns) else []
    return str(given.to_csv(index=_begins_like_a_comment(firsts)))


def _csv_of_columns(table: Mapping[str, Any], name: str) -> str:
    """Columns by name as CSV."""
    columns = {text_of(name, column): [_plain(value) for value in values] for column, values in table.items()}
    lengths = {column: len(values) for column, values in columns.items()}
    if len(set(lengths.values())) != 1:
        raise refused(name, lengths, "columns of equal length, at least one")
    if _begins_like_a_comment([next(iter(columns)), *next(iter(columns.values()))]):
        columns = {"": list(range(next(iter(lengths.values())))), **columns}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    # str of a Python float has all its digits.
    writer.writerows(zip(*columns.values(), strict=True))
    return out.getvalue()


def _begins_like_a_comment(firsts: Iterable[object]) -> bool:
    """Whether a row of a file that begins with one of these would be taken for a comment, or for Excel's line of the separator.
    A table in memory has neither: its rows are numbered then, in a first column without a name."""
    return any(isinstance(first, str) and (first.startswith("#") or first == "sep=") for first in firsts)


def _plain(value: object) -> object:
    """A number of numpy as one of Python, of the same value."""
    return value.item() if isinstance(value, np.generic) else value


def source_of(table: Table | None, name: str = "table") -> tuple[str | None, str | None]:
    """One table as CSV, or its file; ``name`` is the argument."""
    files, text = tables_of(table, name)
    if table is not None and text is None and len(files) != 1:
        raise refused(name, table, "one file, a DataFrame or columns by name")
    return text, files[0] if files else None


#: A number of all embryos, or numbers by the names of embryos.
OfEmbryos: TypeAlias = SupportsFloat | Mapping[str, SupportsFloat]


def of_embryos(name: str, value: OfEmbryos | None) -> list[tuple[str | None, float]]:
    """Numbers of embryos; without a name of all others."""
    if value is None:
        return []
    if isinstance(value, Mapping):
        return [(text_of(name, embryo), positive(name, number)) for embryo, number in value.items()]
    return [(None, positive(name, value))]


def matching_of(names: Table | None, root: str | Sequence[str] | None) -> tuple[tuple[str | None, str | None], list[str]]:
    """A table of names, and roots."""
    roots = [root] if isinstance(root, str) else texts_of("root", root or [])
    return source_of(names, "names"), roots


def times_of(
    table: Table | None,
    volumes: Table | None,
    frame_minutes: OfEmbryos | None,
    common_pace: bool,
    common_size: bool,
    names: Table | None,
    root: str | Sequence[str] | None,
) -> dict[str, Any]:
    """What lifetimes and volumes are read from."""
    if table is None and bool_of("common_pace", common_pace):
        raise refused("common_pace", common_pace, "False without a table: published lifetimes are means of all embryos")
    if volumes is None and bool_of("common_size", common_size):
        raise refused("common_size", common_size, "False without volumes: published volumes are means of all embryos")
    if table is None and frame_minutes is not None:
        raise refused("frame_minutes", frame_minutes, "given with a table: published lifetimes are in minutes")
    asked = tables_of(table)
    if asked[1] is not None and frame_minutes is not None:
        raise refused("frame_minutes", frame_minutes, "left out: tables have times in a unit, and no file has frames")
    return {
        "table": asked,
        "volumes": tables_of(volumes, "volumes"),
        "frame_minutes": of_embryos("frame_minutes", frame_minutes),
        "common_pace": bool_of("common_pace", common_pace),
        "common_size": bool_of("common_size", common_size),
        "matching": matching_of(names, root),
    }


def exported_files(files: list[tuple[str, Any]]) -> str | dict[str, str] | dict[str, bytes]:
    """The text of one file, or several files by name."""
    if len(files) == 1 and not files[0][0]:
        text: str = files[0][1]
        return text
    several: dict[str, str] | dict[str, bytes] = dict(files)
    return several


def positive(name: str, value: SupportsFloat) -> float:
    """A finite number above 0."""
    allowed = "a finite number above 0"
    try:
        number = number_of(name, value)
    except InputError:
        raise refused(name, value, allowed) from None
    if not (np.isfinite(number) and number > 0.0):
        raise refused(name, value, allowed)
    return number


def fixed(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """An array that cannot be written to: results do not change."""
    array.setflags(write=False)
    return array


class Found(Mapping[str, Any]):
    """A result with the keys of the command line's JSON."""

    def __init__(self, found: Mapping[str, Any]) -> None:
        self._found = dict(found)

    def __getitem__(self, name: str) -> Any:
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        return dict(self._found)

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__name__}: {', '.join(self)}>"


def frame(columns: Mapping[str, Any]) -> pd.DataFrame:
    """Columns as a DataFrame."""
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install pandas") from error
    table: pd.DataFrame = pd.DataFrame(dict(columns))
    return table


def pd_index(names: list[str]) -> pd.Index[str]:
    """Names as the index of a DataFrame."""
    import pandas as pd

    index: pd.Index[str] = pd.Index(names, name="name")
    return index


def html_table(rows: list[tuple[str, str]], caption: str) -> str:
    """Names and values as a small HTML table."""
    from html import escape

    cells = "".join(f"<tr><th style='text-align:left'>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
    return f"<table><caption style='text-align:left'>{escape(caption)}</caption>{cells}</table>"


def shown(value: object) -> str:
    """A value formatted for display."""
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)
