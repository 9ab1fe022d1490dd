"""Shells of any profile."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import pytest

import furrow


def table(folder: Path, k: float) -> str:
    rows = ["z,r"]
    for i in range(41):
        t = math.pi * i / 40
        r = 0 if i in (0, 40) else math.sin(t) * math.sqrt(1 + k * math.cos(t))
        rows.append(f"{1.505 * math.cos(t)},{r}")
    path = folder / f"egg{k}.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return str(path)


def test_an_ellipse_as_a_table_is_the_built_in_shell(tmp_path: Path) -> None:
    built_in, own = furrow.Cell(4.0, cue="germline"), furrow.Cell(4.0, cue="germline", shell_profile=table(tmp_path, 0))
    assert own.divide().chi == pytest.approx(built_in.divide().chi, rel=1e-8)
    assert own.aspect == pytest.approx(1.505, rel=1e-9)
    assert built_in.shell_profile is None
    assert own.shell_profile is not None and own.shell_profile.startswith('"egg0"')


def test_an_egg_divides_unequally(tmp_path: Path) -> None:
    egg = furrow.Cell(4.0, shell_profile=table(tmp_path, 0.2))
    assert not egg.is_mirror_symmetric
    assert egg.divide().chi == pytest.approx(0.41129, abs=1e-4)
    assert pickle.loads(pickle.dumps(egg)) == egg
    assert egg.replace(epsilon=0.8).shell_profile == egg.shell_profile
    assert egg.replace(shell_profile="ellipsoid", aspect=1.3).shell_profile is None


def test_frames_have_the_wall_of_the_profile(tmp_path: Path) -> None:
    frames = furrow.Cell(3.0, shell_profile=table(tmp_path, 0.2)).divide(frames=True).frames
    assert frames is not None
    r, z = frames.wall.T
    assert z[r.argmax()] > 0.2
    assert z[0] > 0 > z[-1] and r[0] == pytest.approx(0, abs=1e-9)
    plain = furrow.Cell(3.0).divide(frames=True).frames
    assert plain is not None
    along, across = plain.shell
    assert plain.wall[:, 0].max() == pytest.approx(across)
    assert plain.wall[0, 1] == pytest.approx(along)


def test_a_founder_has_a_shell_of_its_own(tmp_path: Path) -> None:
    file = tmp_path / "eggs.ron"
    shell = Path(table(tmp_path, 0.2)).name
    founders = (
        f'(name: "Q", r0: 3, shell_profile: "{shell}"), '
        '(name: "A", mother: "Q", daughter: larger), (name: "B", mother: "Q", daughter: smaller)'
    )
    file.write_text(f'Lineage(name: "x", limits: (max_depth: 2), founders: [{founders}])', encoding="utf-8")
    tree = furrow.tree(file)
    alone = furrow.Cell(3.0, shell_profile=str(tmp_path / shell)).divide()
    assert tree["Q"].chi == alone.chi
    assert tree["A"].chi == pytest.approx(0.0, abs=1e-3)
    egg = furrow.Cell(3.0, shell_profile=str(tmp_path / shell))
    with pytest.raises(furrow.InputError, match="founders of a lineage file"):
        furrow.grow(egg, lambda cell: furrow.Cell(cell.r0))


def test_wrong_tables_are_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.csv"
    bad.write_text("z,r\n1,0\n0,-1\n-1,0\n", encoding="utf-8")
    with pytest.raises(furrow.InputError, match="at least 9"):
        furrow.Cell(4.0, shell_profile=str(bad))
    with pytest.raises(furrow.InputError, match="the file of a table"):
        furrow.Cell(4.0, shell_profile="egg")


def test_a_cell_names_its_shell(tmp_path: Path) -> None:
    egg = furrow.Cell(2.0, shell_profile=Path(table(tmp_path, 0.2)))
    assert egg == furrow.Cell(2.0).replace(shell_profile=table(tmp_path, 0.2))
    assert egg.parameters()["shell_profile"] == egg.shell_profile and f"shell_profile={egg.shell_profile}" in repr(egg)
    plain = furrow.Cell(2.0, shell_profile=None)
    assert plain == furrow.Cell(2.0) and plain.parameters()["shell_profile"] is None
    swept = furrow.sweep(axes={"shell_profile": ["ellipsoid", tmp_path / "egg0.2.csv"]}, r0=2.0)
    assert swept["outcome"][0] == "asymmetric"


def test_an_ellipsoid_that_keeps_the_aspect_of_a_table_says_so(tmp_path: Path) -> None:
    egg = furrow.Cell(2.0).replace(shell_profile=table(tmp_path, 0.2))
    assert egg.aspect != 1.505
    with pytest.warns(UserWarning, match=f"keeps the aspect ratio of the profile, {egg.aspect:.6g}"):
        assert egg.replace(shell_profile="ellipsoid").aspect == egg.aspect
    assert egg.replace(shell_profile=None, aspect=1.505) == furrow.Cell(2.0)


def test_computations_of_the_papers_shell_refuse_others(tmp_path: Path) -> None:
    egg = table(tmp_path, 0.2)
    data = Path(__file__).resolve().parents[2] / "data"
    for call in (
        lambda: furrow.explore(tmp_path / "page.html", shell_profile=egg),
        lambda: furrow.reproduce("S3", shell_profile=egg),
        lambda: furrow.calibrate(data / "thresholds.ron", shell_profile=egg),
        lambda: furrow.ensemble(data / "statements.ron", 2, shell_profile=egg),
        lambda: furrow.fit.constants(shell_profile=egg),
    ):
        with pytest.raises(furrow.InputError, match=r"^furrow: shell_profile = .*ellipsoid"):
            call()
