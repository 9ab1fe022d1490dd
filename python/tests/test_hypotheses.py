"""Hypotheses beside each other, beside the command line."""

from __future__ import annotations

import pytest

import furrow

TABLE = {
    "embryo": [embryo for embryo in "abcd" for _ in range(2)],
    "mother": ["P0", "P1"] * 4,
    "chi": [0.21, 0.12, 0.23, 0.09, 0.18, 0.11, 0.22, 0.13],
}
SAMPLED = ("--samples", "20", "--posterior", "samples.csv")
SEARCH = ("--particles", "2", "--moves", "1", "--set", "intervals=32")
CUES = {"nothing": "none", "falling": "tension:gradient,amplitude=-0.3"}


def test_hypotheses_are_those_of_the_command_line(cli, memo):
    rows = zip(*TABLE.values(), strict=True)
    (cli.folder / "chi.csv").write_text("embryo,mother,chi\n" + "".join(f"{e},{m},{chi}\n" for e, m, chi in rows))
    cues = [option for name, cue in CUES.items() for option in ("--cue", f"{name}={cue}")]
    theirs = cli.json("test", "chi.csv", *cues, "--free", "cue.amplitude", "--noise", "replicates", *SAMPLED, *SEARCH)
    options = {"free": ["cue.amplitude"], "noise": "replicates", "particles": 2, "moves": 1, "intervals": 32, "samples": 20}
    ours = furrow.test(TABLE, CUES, memo=memo, **options)
    assert ours.to_dict() == {name: theirs[name] for name in ours}
    assert set(theirs) - set(ours) <= {"seed", "elapsed_s"}
    assert ours.to_pandas()["k"].tolist() == [0, 1]
    assert ours.pairs_to_pandas()["distinguishable"].tolist() == [True]
    assert ours.cells_to_pandas()["cell"].tolist() == ["P0", "P1"] * 2 and "<svg" in ours.drawing.svg()
    sampled = ours.samples_to_pandas("falling")
    written = [line.split(",") for line in (cli.folder / "samples.csv").read_text().splitlines()]
    assert written[0] == ["hypothesis", "cue[0].amplitude"] and len(written) == 22
    assert sampled["cue[0].amplitude"].tolist() == [float(value) for name, value in written[1:] if name == "falling"]
    with pytest.raises(furrow.InputError, match="one of nothing, falling"):
        ours.samples_to_pandas("rising")
    # A file and a list of cues are the same.
    again = furrow.test(cli.folder / "chi.csv", [f"{name}={cue}" for name, cue in CUES.items()], memo=memo, **options)
    assert again.to_dict() == ours.to_dict()


def test_wrong_arguments_are_named(memo):
    for arguments, reason in [
        ({"cues": "none"}, "a list of texts"),
        ({"cues": []}, "at least one cue"),
        ({"cues": ["none"], "free": ["epsilon@neurons"]}, "a class of cells"),
        ({"cues": ["none"], "noise": "loud"}, "given, common, replicates"),
        ({"cues": ["none"], "cells": ["E"]}, "measured cells of the lineage: P0, P1"),
        ({"cues": ["none", "none"]}, "names that differ"),
    ]:
        with pytest.raises(furrow.InputError, match=reason):
            furrow.test(TABLE, memo=memo, **arguments)
