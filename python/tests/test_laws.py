"""Laws of active stress of one's own."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

import furrow

PAPER = """Law(
    name: "as text",
    constants: { "a": (value: 1.0) },
    stress_uu: "a*gain*(xi_s*(c1 - c2)/2 + xi_b*C)",
    stress_phiphi: "a*gain*(xi_b*C - xi_s*(c1 - c2)/2)",
)"""


def test_the_papers_law_as_text_gives_the_same(tmp_path: Path) -> None:
    built_in, own = furrow.Cell(2.0), furrow.Cell(2.0, law=PAPER)
    assert own.divide().chi == pytest.approx(built_in.divide().chi, rel=1e-8)
    assert own.pitchfork().coefficient == pytest.approx(built_in.pitchfork().coefficient, rel=1e-8)
    file = tmp_path / "paper.ron"
    file.write_text(PAPER, encoding="utf-8")
    assert furrow.Cell(2.0, law=file) == own
    assert furrow.Cell(2.0, law="paper") == built_in
    assert pickle.loads(pickle.dumps(own)) == own
    assert built_in.law is None
    assert own.law is not None and own.law.startswith('"as text"')


def test_constants_of_a_law_are_parameters() -> None:
    stronger = furrow.Cell(2.0, law=PAPER, **{"law.a": 1.1})
    assert stronger.pitchfork().xi_s == pytest.approx(furrow.Cell(2.0).pitchfork().xi_s / 1.1, rel=1e-6)
    tree = furrow.tree(law=PAPER, r0=2.2)
    assert len(tree) == len(furrow.tree(r0=2.2))


def test_wrong_laws_are_refused() -> None:
    with pytest.raises(furrow.InputError, match="law:4:17: stress_uu: unknown name"):
        furrow.Cell(2.0, law=PAPER.replace("a*gain*(xi_s", "b*gain*(xi_s"))
    with pytest.raises(furrow.InputError, match=r"law\.b"):
        furrow.Cell(2.0, law=PAPER, **{"law.b": 1.1})
    ring = PAPER.replace("a*gain*(xi_s", "a*phi*gain*(xi_s").replace("a*gain*(xi_b", "a*phi*gain*(xi_b")
    with pytest.raises(furrow.InputError, match="it uses phi"):
        furrow.Cell(2.0, law=ring, modes=4)


def test_a_law_that_reads_a_regulator() -> None:
    carried = PAPER.replace("a*gain*(xi_s*(c1 - c2)/2 + xi_b*C)", "a*gain*xi_s*2*(1 + phi)^2/(1 + (1 + phi)^2)")
    carried = carried.replace("a*gain*(xi_b*C - xi_s*(c1 - c2)/2)", "a*gain*xi_s*2*(1 + phi)^2/(1 + (1 + phi)^2)")
    with pytest.warns(UserWarning, match="names phi, but the cell has no regulator"):
        furrow.Cell(2.0, law=carried)
    cell = furrow.Cell(2.0, law=carried, cue="regulator:none,turnover=1,diffusion=1,activity=0")
    (hopf, *_) = cell.branch(xi_max=12.0).hopf
    assert (hopf.branch, hopf.grows_beyond) == ("symmetric", True)
    assert hopf.xi_s == pytest.approx(9.5645, abs=1e-3)
    assert hopf.period == pytest.approx(15.27, abs=0.01)
    assert cell.pitchfork().beyond_fold is None


def test_the_papers_law_as_text_bends_a_cell() -> None:
    built_in = furrow.Cell(2.0, modes=2).divide()
    own = furrow.Cell(2.0, law=PAPER, modes=2).divide()
    assert own.chi == pytest.approx(built_in.chi, abs=1e-8)
    assert own.t_end == pytest.approx(built_in.t_end, rel=1e-8)


def test_a_cell_names_its_law() -> None:
    own = furrow.Cell(2.0, law=PAPER, **{"law.a": 1.5})
    assert own.parameters()["law.a"] == own.to_dict()["law.a"] == 1.5
    assert own.parameters()["law"] == own.law
    assert 'law="as text" (' in repr(own) and "a = 1.5" in repr(own)
    plain = furrow.Cell(2.0)
    assert plain.parameters()["law"] is None and "law" not in repr(plain)
    assert furrow.Cell(**plain.parameters()) == plain
    # The law can be replaced, too.
    assert own.replace(law=None) == own.replace(law="paper") == plain
    assert plain.replace(law=PAPER, **{"law.a": 1.5}) == own
