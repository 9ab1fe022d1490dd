"""What tests share: the command line that results are held against, and a memo of their own."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

import furrow

REPOSITORY = Path(__file__).resolve().parents[2]


def _program() -> Path | None:
    named = os.environ.get("FURROW_PROGRAM")
    if named:
        return Path(named)
    built = (REPOSITORY / "target" / profile / "furrow" for profile in ("release", "debug"))
    return next((program for program in built if program.exists()), None)


class CommandLine:
    """The program ``furrow``."""

    def __init__(self, program: Path, folder: Path, store: Path) -> None:
        self.program = program
        self.folder = folder
        self.store = store

    def text(self, *arguments: str) -> str:
        command = [str(self.program), *arguments, "--cache", str(self.store), "--quiet"]
        return subprocess.run(command, cwd=self.folder, check=True, capture_output=True, text=True).stdout

    def json(self, *arguments: str) -> dict:
        return json.loads(self.text(*arguments, "--json"))


def without_commit(text: str) -> str:
    """A file without the commit of the program that wrote it: the two that are compared may be built from others."""
    return re.sub(r'"git_commit": [^\n]*', '"git_commit"', text)


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Divisions of the command line alone, so that it solves each once; Python never reads it."""
    return tmp_path_factory.mktemp("store")


@pytest.fixture
def cli(tmp_path: Path, store: Path) -> CommandLine:
    program = _program()
    if program is None:
        pytest.skip("the program furrow is not built: cargo build --release, or name it in FURROW_PROGRAM")
    return CommandLine(program, tmp_path, store)


@pytest.fixture
def memo() -> furrow.Memo:
    """A memo that knows nothing."""
    return furrow.Memo()


@pytest.fixture
def known() -> furrow.Memo:
    """The memo of all tests, for those that are not about what is solved."""
    return furrow.memo()
