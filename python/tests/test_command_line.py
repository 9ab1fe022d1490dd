"""Every command and option of the command line beside its Python name, or the reason why it has none."""

from __future__ import annotations

import inspect
import os
import re
import subprocess
from collections.abc import Iterator

import furrow

#: Options of the program itself, and of every command.
PROGRAM = {
    "--help": "help() of Python",
    "--version": "furrow.__version__",
    "--json": "results are objects; to_dict() gives the same keys",
    "--quiet": "nothing is printed unless progress is asked for",
    "--verbose": "warnings are part of results",
    "--no-cache": "without furrow.use_store() nothing is stored",
    "--cache": "furrow.use_store(folder)",
    "--r0-step": "furrow.Memo(r0_step)",
    "--set": "keywords of every function, such as aspect=1.4",
    "--preset": "preset=, of every function",
    "--config": "config=, of every function",
    "--law": "law=, of every function that computes cells with it",
    "--threads": "threads=, of every function that solves several divisions",
}
#: Options that select a cell, for any computation.
RESTING = {
    "--r0": "furrow.Cell(r0)",
    "--epsilon": "epsilon=, as --set",
    "--cue": "furrow.Cell(cue)",
    "--lineage": "furrow.Cell(lineage)",
}
AXIS = {"--three-dimensional": "modes=4, as --set", "--modes": "modes=, as --set"}
CELL = RESTING | {"--xi": "xi_s=, as --set"}
VARY = {"--vary": "{}(vary)", "--from": "{}(first)", "--to": "{}(last)"}
FIRST = {"--epsilon": "epsilon=, as --set", "--xi": "xi_s=, as --set", "--r0": "{}(r0)"}
SEARCH = {f"--{name}": f"{{}}({name})" for name in ("particles", "moves", "seed", "targets", "lineage")}


def _of(name: str, *tables: dict[str, str], **options: str) -> dict[str, str]:
    found = {option: text.format(name) for table in tables for option, text in table.items()}
    return {**found, **{f"--{option.replace('_', '-')}": text for option, text in options.items()}}


#: Commands: their Python name, and their options' names. A name is ``furrow.NAME``, with a parameter in parentheses; every other
#: text is a reason.
COMMANDS: dict[str, tuple[str, dict[str, str]]] = {
    "": ("furrow", {}),
    "tree": (
        "furrow.tree",
        _of(
            "furrow.tree",
            FIRST,
            AXIS,
            seed="furrow.tree(seed)",
            cue="furrow.scenarios(cues)",
            replicates="furrow.tree_ensemble(replicates)",
            constants="furrow.tree_ensemble(constants)",
            dynamics="furrow.tree(dynamics)",
            out="furrow.Tree.save(path)",
            time_axis="furrow.Tree.svg(time_axis)",
            plot="furrow.Tree.plot(path)",
        )
        | {"[LINEAGE.ron]": "furrow.tree(lineage)"},
    ),
    "divide": (
        "furrow.Cell.divide",
        _of(
            "",
            CELL,
            AXIS,
            seed="furrow.Cell.divide(seed)",
            replicates="furrow.Cell.divide(replicates)",
            from_steady="furrow.Cell.perturb",
            until="furrow.Cell.perturb(until)",
            frames="furrow.Cell.write_frames(folder)",
            frame_step="furrow.Cell.write_frames(every)",
            plot="furrow.Cell.draw",
            movie="furrow.Cell.movie(path)",
            movie_frames="furrow.Cell.movie(frames)",
        ),
    ),
    "steady": (
        "furrow.Cell.steady",
        _of(
            "",
            CELL,
            AXIS,
            azimuthal="furrow.Cell.steady(azimuthal)",
            plot="the result has the contour; growth rates are in azimuthal",
        ),
    ),
    "branch": (
        "furrow.Cell.branch",
        _of(
            "",
            RESTING,
            AXIS,
            xi_max="furrow.Cell.branch(xi_max)",
            max_step="furrow.Cell.branch(max_step)",
            azimuthal="furrow.Cell.branch(azimuthal)",
            reduced_volume="furrow.Cell.branch(reduced_volume)",
            points="the curves have all points",
            csv="furrow.Branch.to_pandas",
            plot="furrow.Branch.plot(path)",
        ),
    ),
    "pitchfork": ("furrow.Cell.pitchfork", _of("", RESTING, xi_max="furrow.Cell.pitchfork(xi_max)")),
    "boundary": (
        "furrow.Cell.boundary",
        _of(
            "furrow.Cell.boundary",
            CELL,
            VARY,
            AXIS,
            critical="furrow.Cell.boundary(critical)",
            no_folds="furrow.Cell.boundary(folds)",
            azimuthal="furrow.Cell.boundary(azimuthal)",
            points="the result has all points",
            csv="furrow.Boundary.to_pandas",
            plot="furrow.Boundary.save(path)",
            write="prepares the boundary that a preset of furrow itself has stored",
        ),
    ),
    "polarity": (
        "furrow.polarity",
        _of(
            "furrow.polarity",
            FIRST,
            lineage="furrow.polarity(lineage)",
            par="furrow.polarity(par)",
            length_um="furrow.polarity(length_um)",
            profile="furrow.polarity(profile)",
            amplitude="furrow.polarity(amplitude)",
            out="furrow.Polarity.profiles_to_pandas",
        ),
    ),
    "phase": (
        "furrow.Cell.phase",
        _of(
            "furrow.Cell.phase",
            RESTING,
            VARY,
            AXIS,
            points="furrow.Cell.phase(points)",
            xi_from="furrow.Cell.phase(xi_s)",
            xi_to="furrow.Cell.phase(xi_s)",
            xi_points="furrow.Cell.phase(xi_points)",
            seed="furrow.Cell.phase(seed)",
            azimuthal="furrow.Cell.phase(azimuthal)",
            plot="furrow.Phase.save(path)",
        ),
    ),
    "sweep": (
        "furrow.sweep",
        {"<SWEEP.ron>": "furrow.sweep(file)", "--out": "furrow.sweep(out)", "--shard": "furrow.sweep(shard)"}
        | {"--plot": "furrow.Sweep.to_pandas"}
        | AXIS,
    ),
    "merge": ("furrow.merge", {"<PART>": "furrow.merge(parts)", "--out": "furrow.merge(out)"}),
    "solve": (
        "furrow.solve",
        {f"--{name}": f"furrow.solve({name.replace('-', '_')})" for name in ("chi", "chi-signed", "u", "t", "points", "seed")}
        | AXIS
        | {"--from": "furrow.solve(range)", "--to": "furrow.solve(range)", "--for": "furrow.solve(unknown)"}
        | {"--cue": "furrow.solve(cue)", "--lineage": "furrow.solve(lineage)", "--r0": "r0=, as --set"}
        | {name: CELL[name] for name in ("--epsilon", "--xi")},
    ),
    "export": (
        "furrow.Tree.export",
        {"[TREE.json|EMBRYO]": "furrow.read_tree(path), or furrow.export_observed(embryo)"}
        | {"--to": "furrow.Tree.export(format)", "--out": "furrow.Tree.export(path)"}
        | {"--branch-lengths": "furrow.Tree.export(lengths)", "--schema": "furrow.tree_schema"}
        | {"--subtree": "furrow.Tree.export(subtree)"}
        | {
            f"--{name}": f"furrow.export_observed({name.replace('-', '_')})"
            for name in ("lineage", "volumes", "frame-minutes", "voxel", "names", "root")
        },
    ),
    "calibrate": (
        "furrow.calibrate",
        {"<TARGETS.ron>": "furrow.calibrate(targets)", "--unknowns": "furrow.calibrate(unknowns)"}
        | {"--ensemble": "furrow.ensemble(members)", "--seed": "furrow.ensemble(seed)", "--front": "furrow.front(members)"}
        | {"--out": "furrow.tree_ensemble(constants) takes the result", "--plot": "furrow.Calibration.to_pandas"},
    ),
    "fit": ("furrow.fit", {}),
    "fit constants": (
        "furrow.fit.constants",
        _of("furrow.fit.constants", SEARCH, out="furrow.fit.Constants has ron", plot="furrow.fit.Constants.save(path)"),
    ),
    "fit activity": (
        "furrow.fit.activity",
        _of(
            "",
            lineage="furrow.fit.activity(lineage)",
            rounds="furrow.fit.activity(rounds)",
            xi_from="furrow.fit.activity(range)",
            xi_to="furrow.fit.activity(range)",
            plot="furrow.fit.Activities.save(path)",
        ),
    ),
    "fit cue": ("furrow.fit.cue", _of("furrow.fit.cue", SEARCH, cue="furrow.fit.cue(cue)", plot="furrow.fit.Cue.save(path)")),
    "fit clock": (
        "furrow.fit.clock",
        {"[TABLE]": "furrow.fit.clock(table)", "--out": "furrow.fit.Clock.ron", "--plot": "furrow.fit.Clock.save(path)"}
        | {
            f"--{name}": f"furrow.fit.clock({name.replace('-', '_')})"
            for name in ("volumes", "lineage", "frame-minutes", "common-pace", "common-size", "names", "root")
        },
    ),
    "test": (
        "furrow.test",
        {"<TABLE>": "furrow.test(table)", "--cue": "furrow.test(cues)", "--plot": "furrow.Hypotheses.save(path)"}
        | {"--samples": "furrow.test(samples)", "--posterior": "furrow.Hypotheses.save_samples(path)"}
        | {
            f"--{name}": f"furrow.test({name})"
            for name in ("free", "noise", "cells", "population", "voxel", "unit", "lineage", "particles", "moves", "seed")
        }
        | {f"--{name}": f"furrow.test({name})" for name in ("names", "root", "hypotheses", "rounds", "lifetimes", "folded")}
        | {"--lifetime-sd": "furrow.test(lifetime_sd)", "--shard": "furrow.test(shard)"}
        | {"--class": "furrow.test(class_columns)"},
    ),
    "compare": ("furrow.compare", {}),
    "compare counts": (
        "furrow.compare.counts",
        {"[TREE.json|LINEAGE.ron]": "furrow.compare.counts(tree)", "--measured": "furrow.compare.counts(measured)"}
        | {"--names": "furrow.compare.counts(names)", "--root": "furrow.compare.counts(root)"}
        | {"--plot": "furrow.Tree.plot(path)"},
    ),
    "compare volumes": (
        "furrow.compare.volumes",
        {"[FILE]": "furrow.compare.volumes(table)", "--plot": "furrow.compare.VolumesComparison.plot(path)"}
        | {"--out": "furrow.compare.VolumesComparison.to_pandas"}
        | {
            f"--{name}": f"furrow.compare.volumes({name.replace('-', '_')})"
            for name in ("published", "against", "voxel", "unit", "regress", "population", "bins", "constants", "lineage")
        }
        | {"--length-scale": "furrow.compare.volumes(length_scale)"}
        | {"--names": "furrow.compare.volumes(names)", "--root": "furrow.compare.volumes(root)"},
    ),
    "compare lifetimes": (
        "furrow.compare.lifetimes",
        {"[TABLE]": "furrow.compare.lifetimes(table)", "--plot": "furrow.compare.Lifetimes.to_pandas"}
        | {
            f"--{name}": f"furrow.compare.lifetimes({name.replace('-', '_')})"
            for name in ("tree", "volumes", "frame-minutes", "common-pace", "common-size", "names", "root")
        },
    ),
    "compare contour": (
        "furrow.compare.contours",
        {"<MEASURED>": "furrow.compare.contours(measured)", "--frames": "furrow.compare.contours(model)"}
        | {"--length-scale": "furrow.compare.contours(length_scale)", "--label": "outlines are arrays, not images"}
        | {"--out": "furrow.compare.ContoursComparison.to_dict", "--plot": "furrow.compare.ContoursComparison.plot(path)"},
    ),
    "compare dose": (
        "furrow.compare.dose",
        {f"--{name}": f"furrow.compare.dose({name})" for name in ("bins", "r0", "cue", "lineage")}
        | {"[FILE]": "furrow.compare.dose(table)", "--plot": "furrow.compare.Dose.to_pandas"},
    ),
    "reproduce": (
        "furrow.reproduce",
        {f"--{name}": f"furrow.reproduce({name})" for name in ("out", "format", "table", "data")}
        | AXIS
        | {"[FIGURE]": "furrow.reproduce(figures)"},
    ),
    "explore": (
        "furrow.explore",
        _of("furrow.explore", FIRST, out="furrow.explore(path)", seed="furrow.explore(seed)")
        | {"[LINEAGE.ron]": "furrow.explore(lineage)"},
    ),
    "new-lineage": (
        "furrow.new_lineage",
        {"<FILE.ron>": "furrow.new_lineage(path)", "--first-cell": "the lineage's r0 and units, which take µm"},
    ),
    "cache": ("furrow.cache", {}),
    "cache stat": ("furrow.cache.stat", {}),
    "cache verify": ("furrow.cache.verify", {"--repair": "furrow.cache.verify(repair)"}),
    "cache clear": ("furrow.cache.clear", {}),
    "completions": ("a shell's completions have no use in Python", {"<SHELL>": "of a shell"}),
}

NAME = re.compile(r"furrow((?:\.\w+)*)(?:\((\w+)\))?$")


def _commands(program: str, path: tuple[str, ...] = ()) -> Iterator[tuple[str, set[str]]]:
    """Every command with its arguments and options, from its help."""
    text = subprocess.run([program, *path, "--help"], capture_output=True, text=True, check=True, encoding="utf-8").stdout

    def section(name: str) -> str:
        found = re.search(rf"^{name}:\n((?:  .*\n|\n)+)", text, re.MULTILINE)
        return found[1] if found else ""

    arguments = re.findall(r"^  ([\[<][^\]>]+[\]>])", section("Arguments"), re.MULTILINE)
    options = re.findall(r"^  +(?:-\w, )?(--[a-z][\w-]*)", text, re.MULTILINE)
    yield " ".join(path), {*arguments, *options}
    for command in re.findall(r"^  ([a-z][\w-]*)(?:\s|$)", section("Commands"), re.MULTILINE):
        if command != "help":
            yield from _commands(program, (*path, command))


def test_every_command_and_option_has_a_python_name_or_a_reason(cli):
    found = dict(_commands(os.fspath(cli.program)))
    assert len(found) > 25 and "--azimuthal" in found["boundary"]
    assert not found.keys() - COMMANDS.keys(), "commands without a Python name"
    missing = {name: options - COMMANDS[name][1].keys() - PROGRAM.keys() for name, options in found.items()}
    assert not {name: options for name, options in missing.items() if options}, "options without a Python name"
    gone = {name: options.keys() - found.get(name, set()) for name, (_, options) in COMMANDS.items()}
    assert not {name: options for name, options in gone.items() if options}, "options that are no more"


def _resolved(text: str) -> None:
    match = NAME.match(text)
    if match is None:
        assert len(text) > 5 and not text.startswith("furrow.tree("), f"no reason: {text!r}"
        return
    target = furrow
    for part in match[1].split(".")[1:]:
        target = getattr(target, part)
    if match[2]:
        signature = inspect.signature(target)
        assert match[2] in signature.parameters, text


def test_every_python_name_exists():
    for name, options in COMMANDS.values():
        _resolved(name)
        for text in options.values():
            _resolved(text)
