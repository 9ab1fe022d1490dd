"""The notebooks run from first to last, and show what they should. They are kept without outputs, which would be stale."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest
from conftest import REPOSITORY

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")
pytest.importorskip("pandas")

FOLDER = REPOSITORY / "python" / "notebooks"


def executed(name: str):
    notebook = nbformat.read(FOLDER / name, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "kept without outputs: clear them"
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(FOLDER)}}).execute()
    return notebook


@pytest.fixture(scope="module")
def notebooks():
    """The notebooks by name, which run side by side."""
    with ThreadPoolExecutor() as pool:
        yield {path.name: pool.submit(executed, path.name) for path in FOLDER.glob("*.ipynb")}


def shown(notebook) -> list[dict]:
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output.get("name") == "stderr"]
    return [output.get("data", {"text/plain": output.get("text", "")}) for output in outputs]


def test_the_papers_figures(notebooks):
    notebook = notebooks["figures.ipynb"].result()
    lines = [line for cell in notebook.cells if cell.cell_type == "code" for line in cell.source.splitlines() if line.strip()]
    assert len(lines) <= 20
    data = shown(notebook)
    assert sum("image/png" in one for one in data) == 4
    assert any("image/svg+xml" in one for one in data)
    assert any("22.0648" in one.get("text/html", "") for one in data)
    assert any("253 cells" in one.get("text/plain", "") for one in data)


def test_ones_own_cue(notebooks):
    data = shown(notebooks["own_cue.ipynb"].result())
    assert sum("image/png" in one for one in data) == 2
    assert any("c_elegans-cue-2" in one.get("text/html", "") for one in data)
    assert any("one L_h is" in one.get("text/plain", "") for one in data)


def test_a_clock(notebooks):
    data = shown(notebooks["clock.ipynb"].result())
    assert sum("image/png" in one for one in data) == 2
    assert any("founder" in one.get("text/html", "") for one in data)
    assert any("part for good" in one.get("text/plain", "") for one in data)
