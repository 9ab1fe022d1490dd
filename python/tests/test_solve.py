"""One unknown from one number."""

from __future__ import annotations

import pytest

import furrow


def test_a_solution_is_that_of_the_command_line(cli, memo):
    options = ("--chi", "0.41", "--r0", "2.977", "--cue", "germline", "--from", "0.85", "--to", "0.9", "--points", "5")
    theirs = cli.json("solve", "--for", "epsilon", *options)
    ours = furrow.solve("epsilon", chi=0.41, r0=2.977, cue="germline", range=(0.85, 0.9), points=5, memo=memo)
    assert ours == {name: theirs[name] for name in ours}
    (root,) = ours["roots"]
    division = furrow.Cell(2.977, epsilon=root["value"], cue="germline").divide(memo=furrow.Memo())
    assert abs(division.chi - 0.41) < 1e-6 and division.chi == root["chi"]


def test_without_a_root_it_says_what_was_seen(memo):
    with pytest.raises(furrow.NoOutcome, match="divides nowhere"):
        furrow.solve("r0", chi=0.5, range=(1.2, 1.5), points=3, memo=memo)


@pytest.mark.parametrize(
    "call",
    [
        lambda: furrow.solve("epsilon", r0=2),
        lambda: furrow.solve("epsilon", chi=0.4, u=0.4, r0=2),
        lambda: furrow.solve("epsilon", chi=1.4, r0=2),
        lambda: furrow.solve("epsilon", chi=0.4),
        lambda: furrow.solve("epsilon", chi=0.4, r0=2, epsilon=0.8),
        lambda: furrow.solve("epsilom", chi=0.4, r0=2),
        lambda: furrow.solve("cue.u0", chi=0.4, r0=2),
        lambda: furrow.solve("epsilon", chi=0.4, r0=2, range=(0.8, 1.2)),
        lambda: furrow.solve("epsilon", chi=0.4, r0=2, range=(0.8,)),
        lambda: furrow.solve("epsilon", chi="x", r0=2),
    ],
)
def test_bad_input_is_refused(call):
    with pytest.raises(furrow.InputError):
        call()
