"""HTML for notebooks, readable on light and on dark pages."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

# Colours are the page's own; lines and badges are half transparent over them.
_STYLE = (
    "<style>"
    ".pinode{color:inherit;font-size:0.95em;line-height:1.45;max-width:60em;overflow-x:auto}"
    ".pinode table{border-collapse:collapse;margin:0.5em 0;color:inherit;background:none}"
    ".pinode th,.pinode td{padding:0.2em 0.8em;text-align:right;background:none;"
    "border-bottom:1px solid rgba(128,128,128,0.35)}"
    ".pinode th:first-child,.pinode td:first-child{text-align:left}"
    ".pinode td{font-variant-numeric:tabular-nums}"
    ".pinode .verdict{padding:0.1em 0.6em;border-radius:0.7em;font-weight:600;"
    "background:rgba(128,128,128,0.25)}"
    ".pinode .good{background:rgba(0,158,115,0.35)}"
    ".pinode .with_care{background:rgba(230,159,0,0.4)}"
    ".pinode .not_usable,.pinode .damage{background:rgba(213,94,0,0.4)}"
    "</style>"
)
# Words of programs and documents for the grades.
_WORDS = {"with_care": "usable with care", "not_usable": "not usable"}


def text(value: Any) -> str:
    """Returns a value as tables show it. Numbers have four digits."""
    if isinstance(value, float):
        return f"{value:.4g}" if math.isfinite(value) else "-"
    return "-" if value is None else str(value)


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    lines = ["<tr>" + "".join(f"<td>{escape(text(v))}</td>" for v in row) + "</tr>" for row in rows]
    if not lines:
        return ""
    head = "".join(f"<th>{escape(h)}</th>" for h in header)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def plain_table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> list[str]:
    """Returns the lines of a table in a terminal. The first column is aligned to the
    left.
    """
    cells = [list(header), *([text(v) for v in row] for row in rows)]
    if len(cells) == 1:
        return []
    widths = [max(len(row[i]) for row in cells) for i in range(len(header))]
    return [
        "  ".join([row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:]))])
        .rstrip()
        for row in cells
    ]


def sentences(title: str, texts: Iterable[str]) -> str:
    items = "".join(f"<li>{escape(str(t))}</li>" for t in texts)
    return f"<p>{escape(title)}</p><ul>{items}</ul>" if items else ""


def badge(verdict: str) -> str:
    """Returns a verdict in its colour."""
    words = _WORDS.get(verdict, verdict.replace("_", " "))
    return f'<p><span class="verdict {escape(verdict)}">{escape(words)}</span></p>'


def section(title: str, *parts: str, verdict: str | None = None) -> str:
    mark = "" if verdict is None else badge(verdict)
    # A verdict may have many sentences, of which the first is the answer.
    first, _, others = title.partition(". ")
    heading = f"<p><b>{escape(first)}{'.' if others else ''}</b></p>"
    rest = f"<p>{escape(others)}</p>" if others else ""
    return f'{_STYLE}<div class="pinode">{mark}{heading}{rest}{"".join(parts)}</div>'
