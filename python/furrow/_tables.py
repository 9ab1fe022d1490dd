"""Tables for pandas, which is optional."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


def frame(columns: Mapping[str, Any]) -> pd.DataFrame:
    """Columns as a DataFrame."""
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError("to_pandas needs pandas: pip install pandas") from error
    table: pd.DataFrame = pd.DataFrame(dict(columns))
    return table


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
