#!/usr/bin/env python3
"""Puts the small errors of mutants.toml into a copy of the repository, one at a time, and runs the test that must fail.

    crates/furrow-verification/mutations.py              # all mutants
    crates/furrow-verification/mutations.py friction     # mutants whose names contain a word
    crates/furrow-verification/mutations.py --write      # also writes the table in docs/mutations.md
    crates/furrow-verification/mutations.py --check      # only: every mutant applies, its test exists, the table lists it

The copy and its build are kept in target/mutations. A mutant that does not apply or does not compile stops the run, and so does a
test that fails without a mutant. Needs Python 3.11 or later.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COPY = ROOT / "target/mutations/tree"
PAGE = ROOT / "docs/mutations.md"
BEGIN = "<!-- begin: written by `crates/furrow-verification/mutations.py --write` -->"
END = "<!-- end -->"
# A test that takes longer is stopped; its mutant counts as killed.
PATIENCE = 300


def changed(tree, mutant):
    """The files of a mutant with their new texts. Each old text must occur exactly once."""
    texts = {}
    for edit in mutant["edits"]:
        file = tree / edit["file"]
        text = texts.get(file) or file.read_text()
        if text.count(edit["old"]) != 1 or edit["old"] == edit["new"]:
            sys.exit(f"{mutant['name']}: {edit['file']} has `{edit['old']}` {text.count(edit['old'])} times, not once")
        texts[file] = text.replace(edit["old"], edit["new"])
    return texts


def row(mutant):
    file, test = mutant["killed_by"]
    return f"| {mutant['name']} | {mutant['means']} | `{file}`: `{test}` |"


def check(mutants):
    """Every mutant applies, has a test, and is in the table; the table has no others."""
    if len({mutant["name"] for mutant in mutants}) < len(mutants):
        sys.exit("two mutants have one name")
    for mutant in mutants:
        changed(ROOT, mutant)
        file, test = mutant["killed_by"]
        if f"#[test]\nfn {test}(" not in (HERE / f"tests/verification/{file}.rs").read_text():
            sys.exit(f"{mutant['name']}: there is no test {test} in {file}")
        if row(mutant) not in PAGE.read_text():
            sys.exit(f"docs/mutations.md lacks `{row(mutant)}`: run mutations.py --write")
    # Other tables follow the one of the model.
    rows = PAGE.read_text().split(END)[0].count("`: `")
    if rows != len(mutants):
        sys.exit(f"docs/mutations.md has {rows} mutants, mutants.toml {len(mutants)}")


def copy():
    """Copies the sources that differ, so that little is compiled again."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True)
    for name in listed.stdout.decode().splitlines():
        file, there = ROOT / name, COPY / name
        if file.is_file() and (not there.is_file() or file.read_bytes() != there.read_bytes()):
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, there)


def run_test(file, test):
    """Runs one test of the copy; returns what is wrong, or None if it passes."""
    env = os.environ | {"CARGO_TARGET_DIR": str(COPY.with_name("target")), "CARGO_PROFILE_DEV_DEBUG": "0", "RUST_BACKTRACE": "0"}
    cargo = ["cargo", "test", "--quiet", "--locked", "-p", "furrow-verification", "--test", "verification"]
    built = subprocess.run([*cargo, "--no-run"], cwd=COPY, env=env, capture_output=True, text=True)
    if built.returncode:
        sys.exit(f"{file} does not compile\n{built.stderr}")
    # `timeout` ends cargo and the test.
    ended = subprocess.run(
        ["timeout", str(PATIENCE), *cargo, "--", "--exact", f"{file}::{test}", "--nocapture"],
        cwd=COPY, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )
    if "running 1 test" not in ended.stdout:
        sys.exit(f"there is no test {test} in {file}")
    if ended.returncode == 124:
        return "does not end"
    if ended.returncode == 0:
        return None
    if found := re.findall(r": ([^:\n]*), allowed is (.*)", ended.stdout):
        return ", allowed ".join(found[-1]).replace("|", "/")
    message = re.search(r"panicked at .*\n(.*)", ended.stdout)
    message = message[1].replace("|", "/") if message else "fails"
    return f"“{message[:60]}{'…' * (len(message) > 60)}”"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    mutants = tomllib.loads((HERE / "mutants.toml").read_text())["mutant"]
    if options.check:
        return check(mutants)
    chosen = [m for m in mutants if not options.words or any(word in m["name"] for word in options.words)]
    if not chosen:
        sys.exit(f"no mutant's name contains any of {options.words}")
    copy()
    for file, test in sorted({tuple(mutant["killed_by"]) for mutant in chosen}):
        if said := run_test(file, test):
            sys.exit(f"{file}: {test} fails without a mutant: {said}")
    found = {}
    for k, mutant in enumerate(chosen, 1):
        new = changed(COPY, mutant)
        old = {file: file.read_text() for file in new}
        try:
            for file, text in new.items():
                file.write_text(text)
            said = run_test(*mutant["killed_by"])
        finally:
            for file, text in old.items():
                file.write_text(text)
        found[mutant["name"]] = said
        print(f"{k:>3}/{len(chosen)} {'killed' if said else 'SURVIVED':<8} {mutant['name']:<38} {said or 'passes'}", flush=True)
    survivors = [name for name, said in found.items() if not said]
    print(f"{len(found) - len(survivors)} of {len(found)} killed")
    if options.write:
        before, rest = PAGE.read_text().split(BEGIN)
        table, after = rest.split(END, 1)
        rows = ["| mutant | what it does | test that sees it | how far off |", "|---|---|---|---|"]
        for mutant in mutants:
            begins = f"| {mutant['name']} | {mutant['means']} |"
            if mutant["name"] in found:
                said = found[mutant["name"]]
                rows.append(f"{row(mutant)} {said} |" if said else f"{begins} **none** | passes |")
            else:
                # What was not run keeps its row.
                rows += [line for line in table.splitlines() if line.startswith(begins)]
        PAGE.write_text("\n".join([f"{before}{BEGIN}\n", *rows, f"\n{END}{after}"]))
    sys.exit(bool(survivors))


if __name__ == "__main__":
    main()
