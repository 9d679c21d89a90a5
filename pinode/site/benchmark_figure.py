"""Bars of the table of times that the page of benchmarks has."""

import pathlib

from matplotlib.figure import Figure

PAGE = pathlib.Path("tests/benchmarks/README.md")
FILE = "times.svg"
HEADER = "| case | storeys, samples, sensors, groups | pinode, CPU s | reference |"
BLUE, GREY = "#0072B2", "0.67"


def rows_of(text):
    """(case, sizes, seconds of pinode, of the reference), and where the table ends."""
    begin = text.index(HEADER)
    end = text.index("\n\n", begin)
    rows = [[cell.strip() for cell in line.strip("|").split("|")]
            for line in text[begin:end].splitlines()[2:]]
    return [(row[0], row[1], float(row[2]), float(row[3])) for row in rows], end


def draw(rows, path):
    figure = Figure(figsize=(8.0, 0.8 + 0.55 * len(rows)), layout="constrained")
    ax = figure.subplots()
    for place, (_, _, ours, theirs) in enumerate(rows):
        for offset, seconds, colour in ((-0.18, ours, BLUE), (0.18, theirs, GREY)):
            ax.barh(place + offset, seconds, 0.34, color=colour)
            ax.annotate(f"{seconds:g}", (seconds, place + offset), xytext=(3, 0),
                        textcoords="offset points", va="center", size="small")
    ax.margins(x=0.08)
    ax.set_yticks(range(len(rows)), [f"{case}\n{sizes}" for case, sizes, *_ in rows], size="small")
    ax.invert_yaxis()
    ax.set_xlabel("CPU seconds of one thread: pinode (blue), the reference (grey)")
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    figure.savefig(path, metadata={"Date": None})


def with_figure(text, folder):
    """The page with the figure behind its table; the figure goes to `folder`."""
    rows, end = rows_of(text)
    folder.mkdir(parents=True, exist_ok=True)
    draw(rows, folder / FILE)
    words = "CPU seconds of pinode and of the reference, the table above as bars"
    return text[:end] + f"\n\n![{words}]({FILE})" + text[end:]
