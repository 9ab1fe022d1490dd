"""README's Python section runs as it is written, and prints what the command line prints."""

from __future__ import annotations

import re
import subprocess
import sys

from conftest import REPOSITORY


def lines_of(file: str) -> str:
    text = (REPOSITORY / file).read_text(encoding="utf-8")
    return "\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL))


def test_readme_prints_the_founders_and_chi_of_the_command_line(cli, tmp_path):
    script = lines_of("README.md")
    assert len(script.strip().splitlines()) <= 12
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=True, capture_output=True, text=True, encoding="utf-8"
    )
    table = cli.text("tree", "--out", "out")
    table = table[: table.rindex("\n", 0, len(table) - 1) + 1]
    assert table in done.stdout
    chi = cli.json("divide", "--r0", "5.4", "--cue", "germline")["chi"]
    assert f"\n{chi!r}\n" in f"\n{done.stdout}"


def test_the_packages_own_readme_runs(tmp_path):
    script = lines_of("python/README.md")
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=True, capture_output=True, text=True, encoding="utf-8"
    )
    assert "Caenorhabditis elegans: 253 cells" in done.stdout


def test_the_guide_runs(tmp_path):
    script = lines_of("docs/book/src/python.md")
    assert script.count("furrow.") > 12
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
