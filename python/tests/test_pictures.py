"""Pictures say what was computed."""

from __future__ import annotations

import numpy as np
import pytest

import furrow

matplotlib = pytest.importorskip("matplotlib")

from furrow import plot  # noqa: E402


def texts(figure) -> str:
    return " ".join(text.get_text() for text in figure.findobj(matplotlib.text.Text))


def test_a_division(tmp_path):
    division = furrow.Cell(4, cue="germline").divide(frames=True)
    figure = division.plot(path=str(tmp_path / "division.png"))
    assert (tmp_path / "division.png").stat().st_size > 20_000
    assert "χ = 0.12" in texts(figure) and len(figure.axes) == plot.STILLS + 2
    lines = {line.get_label(): line for line in figure.axes[-1].get_lines()}
    assert set(plot.FORCES) <= set(lines)
    neck = figure.axes[-2].get_lines()[0].get_ydata()
    assert neck[-1] < 1e-3
    # The cue is drawn where it is, and in the first shape not.
    strips = [axes.collections for axes in figure.axes[: plot.STILLS]]
    assert not strips[0] and strips[3]
    with pytest.raises(furrow.InputError, match="frames"):
        furrow.Cell(4).divide().plot()


def test_a_cell_at_rest():
    figure = furrow.Cell(1.5).divide(frames=True).plot()
    assert "stays at rest" in texts(figure)


def test_a_branch_is_dashed_where_it_is_unstable():
    branch = furrow.Cell(2).branch(xi_max=30)
    figure = branch.plot()
    above = figure.axes[0]
    solid = [line for line in above.get_lines() if line.get_linestyle() == "-" and len(line.get_xdata()) > 1]
    reach = max(line.get_xdata().max() for line in solid if line.get_color() == plot.SYMMETRIC)
    assert reach < branch.pitchforks[0].xi_s
    assert "pitchfork" in texts(figure) and len(figure.axes) == 2
    assert len(furrow.Cell(2, cue="germline").branch(xi_max=10).plot().axes) == 1


def test_rounds_and_ranges():
    figure = furrow.tree().plot()
    assert "terminal cells" in texts(figure) and "P4" in texts(figure)
    table = "aspect,p0,w,gain,weight\n1.5,0.123,0.1445,0.5,0.5\n1.49,0.122,0.144,0.5,0.5\n"
    constants = furrow.Constants(("aspect",), np.array([[1.5], [1.49]]), np.array([0.5, 0.5]), 2.0, 2, {}, table)
    figure = furrow.tree('(name: "S", founders: [(name: "S", r0: 2.4)])', constants=constants).plot()
    assert "2 sets" in texts(figure)


def test_measured_volumes_and_outlines():
    found = furrow.compare.volumes()
    figure = found.plot()
    assert "model" in texts(figure) and "P3" in texts(figure)
    division = furrow.Cell(4, cue="germline").divide(frames=0.2)
    half = division.frames[3].contour.points
    ring = np.concatenate((half, half[::-1] * [-1, 1]))
    assert "|A∩B|/|A| = 1.000" in texts(furrow.compare.contours([ring], division).plot())
