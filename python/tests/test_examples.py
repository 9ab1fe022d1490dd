"""Examples run, are typed, and the stubs say what is there; a cluster gives what one machine gives."""

from __future__ import annotations

import dataclasses
import importlib
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY

import furrow

PYTHON = REPOSITORY / "python"
EXAMPLES = sorted((PYTHON / "examples").glob("*.py"))


def load(path: Path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def test_examples_run(capsys):
    load(PYTHON / "examples" / "founders.py").main()
    printed = capsys.readouterr().out
    assert "253 cells, of which 127 are terminal" in printed and "AB: 6.25 rounds, observed 9.05" in printed
    load(PYTHON / "examples" / "own_cue.py").main()
    printed = capsys.readouterr().out
    assert printed.count("χ = ") == 11 and "omega = -1" in printed


def test_a_cluster_gives_what_one_machine_gives(cli, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    # Workers import it by its name, from where this process does.
    monkeypatch.syspath_prepend(PYTHON / "examples")
    import spread_dask

    sizes = np.linspace(1.6, 3.0, 30)
    cells = [furrow.Cell(r0=float(r0), cue="germline") for r0 in sizes]
    # Workers that are processes of their own: cells and divisions travel as they would between machines.
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0")
    with cluster, distributed.Client(cluster) as client:
        divisions = spread_dask.spread(cells, client)
    listed = ", ".join(repr(cell.r0) for cell in cells)
    text = f'Sweep(kind: division, axes: [(parameter: "r0", list: [{listed}])], cue: "germline")'
    (tmp_path / "sweep.ron").write_text(text)
    cli.text("sweep", "sweep.ron", "--out", "out")
    rows = [line.split(",") for line in (tmp_path / "out" / "results.csv").read_text().splitlines()[1:]]
    assert len(rows) == len(divisions) == 30
    for row, division in zip(rows, divisions, strict=True):
        assert row[1] == division.outcome
        assert row[2] == "" if division.chi is None else float(row[2]) == division.chi
        assert float(row[4]) == division.t_end


def test_joblib_spreads_cells():
    joblib = pytest.importorskip("joblib")
    cells = [furrow.Cell(r0) for r0 in (2.0, 2.4, 2.8)]
    found = joblib.Parallel(n_jobs=2)(joblib.delayed(cell.divide)() for cell in cells)
    assert [division.chi for division in found] == [cell.divide().chi for cell in cells]


def start(*arguments: str, folder: Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", *arguments]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(done: subprocess.Popen[str]) -> None:
    out, _ = done.communicate()
    assert done.returncode == 0, out


def test_types_are_right(tmp_path):
    pytest.importorskip("mypy")
    examples = (str(path.relative_to(PYTHON)) for path in EXAMPLES)
    # From another folder, so that the checker sees the installed package.
    settings = ("--mypy-config-file", str(PYTHON / "pyproject.toml"))
    stubs = start("mypy.stubtest", "--ignore-disjoint-bases", *settings, "furrow._furrow", folder=tmp_path)
    finish(start("mypy", "--strict", "furrow", *examples, "benches/cost.py", "tests/typed_calls.py", folder=PYTHON))
    finish(stubs)


def test_every_public_function_is_called_with_types():
    importlib.import_module("furrow.plot")
    functions = {f"furrow.{name}": getattr(furrow, name) for name in furrow.__all__}
    for module in (furrow.cache, furrow.compare, furrow.fit, furrow.plot):
        mine = {name: value for name, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__}
        functions |= {f"{module.__name__}.{name}": value for name, value in mine.items() if not name.startswith("_")}
    text = (PYTHON / "tests" / "typed_calls.py").read_text(encoding="utf-8").replace("plot.", "furrow.plot.")
    names = [name for name, value in functions.items() if inspect.isroutine(value)]
    assert len(names) > 40 and not [name for name in names if f"{name}(" not in text]


def test_every_public_name_is_explained():
    importlib.import_module("furrow.plot")
    for module in (furrow, furrow.cache, furrow.compare, furrow.fit, furrow.plot):
        assert module.__doc__
        # A constant has the help of its type.
        for name, value in vars(module).items():
            if not name.startswith("_") and getattr(value, "__module__", "").startswith("furrow"):
                explained(name, value)


def explained(name: str, value) -> None:
    if inspect.isroutine(value) or isinstance(value, type):
        assert value.__doc__, name
    if dataclasses.is_dataclass(value):
        fields = [field.name for field in dataclasses.fields(value) if not field.name.startswith("_")]
        assert not [field for field in fields if f"``{field}``: " not in value.__doc__], name


def test_style():
    pytest.importorskip("ruff")
    finish(start("ruff", "check", ".", folder=PYTHON))
    finish(start("ruff", "format", "--check", ".", folder=PYTHON))
