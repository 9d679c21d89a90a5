"""The tutorials run from their first to their last cell, and show their figures."""

import os
import pathlib

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

FOLDER = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "pinode" / "python" / "tutorials"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_some():
    assert len(NOTEBOOKS) >= 6


@pytest.fixture(autouse=True)
def plain_jupyter(monkeypatch):
    """As whoever opens a notebook has it, who has chosen no backend."""
    monkeypatch.delenv("MPLBACKEND", raising=False)


def run(book, folder):
    nbclient.NotebookClient(book, timeout=120, kernel_name="python3",
                            resources={"metadata": {"path": str(folder)}}).execute()


def pictures(cell):
    return [output["data"]["image/png"] for output in cell.outputs
            if "image/png" in output.get("data", {})]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path, tmp_path):
    book = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "kept without outputs"
    words = sum(len(cell.source.split()) for cell in book.cells)
    assert words < 2000  # ten minutes of reading
    run(book, tmp_path)
    for cell in book.cells:
        if cell.cell_type != "code":
            continue
        last = cell.source.splitlines()[-1]
        assert len(pictures(cell)) == (".figures()[" in last), cell.source
        if last.endswith(".structure()"):
            assert cell.outputs[-1]["data"]["text/html"].startswith("<iframe")
        errors = "".join(output.text for output in cell.outputs
                         if output.output_type == "stream" and output.name == "stderr")
        # A bar, which leaves nothing.
        assert not errors.rstrip("\r").split("\r")[-1].strip() and "Warning" not in errors


def test_most_of_them_have_figures():
    figures = [path.stem for path in NOTEBOOKS if ".figures()[" in path.read_text()]
    assert len(figures) >= 5 and ".structure()" in "".join(p.read_text() for p in NOTEBOOKS)


SETTING_UP = """
import pinode
model = pinode.Model([[1.0]], [[100.0]], [[0.5]])
fit = pinode.Case(model, groups=[pinode.Group("k", [[100.0]])],
                  modes=[pinode.Mode(1.6)]).identify()
fit.figures()["parameters"]
"""


@pytest.mark.parametrize("backend, first", [
    (None, ""), ("Agg", ""), (None, "%matplotlib inline"), (None, "import matplotlib.pyplot"),
    (None, "%config InlineBackend.figure_formats = ['retina']\n%matplotlib inline")],
    ids=["plain", "Agg", "inline", "pyplot", "retina"])
def test_a_figure_is_shown_once(backend, first, tmp_path, monkeypatch):
    if backend:
        monkeypatch.setenv("MPLBACKEND", backend)
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(first + SETTING_UP)])
    run(book, tmp_path)
    (cell,) = book.cells
    shown = [output for output in cell.outputs if output.output_type != "stream"]
    assert len(shown) == 1 and len(pictures(cell)) == 1
