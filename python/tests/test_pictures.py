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


def test_a_regulator_is_drawn_on_the_contours_and_over_their_length():
    cue = "germline+regulator:step,u0=0.45,omega=0.1,amplitude=1,turnover=5,diffusion=1,activity=0.3"
    figure = furrow.Cell(3, cue=cue).divide(frames=True).plot()
    assert len(figure.axes) == plot.STILLS + 3
    lines = figure.axes[-1].get_lines()
    # At the start φ is 0.
    assert len(lines) == plot.STILLS and not lines[0].get_ydata().any() and lines[-1].get_ydata().max() > 0.5
    for words in ("regulator φ > 0, to 1", "regulator φ < 0, to −0", "strips from the inside: regulator, rigidity"):
        assert words in texts(figure), words
    strips = [axes.collections for axes in figure.axes[: plot.STILLS]]
    assert not strips[0] and strips[3]


LONG = "tension:gradient,amplitude=0.3+kappa:band,u0=0.465,omega=0.0577,amplitude=0.1"


def test_the_sign_of_a_cue_has_its_colour_and_the_poles_their_names():
    from matplotlib.colors import to_hex

    figure = furrow.Cell(4, cue="tension:gradient,amplitude=0.3").divide(frames=True).plot()
    # Tension is raised at the posterior pole, z > 0, and lowered at the anterior one.
    strips = figure.axes[3].collections[0]
    middles = [path.vertices[:, 0].mean() for path in strips.get_paths()]
    signs = {to_hex(colour): [] for colour in strips.get_facecolors()}
    for z, colour in zip(middles, strips.get_facecolors(), strict=True):
        signs[to_hex(colour)].append(z)
    assert set(signs) == {plot.CUE, plot.CUE_LOWERS}
    assert min(signs[plot.CUE]) > max(signs[plot.CUE_LOWERS])
    for words in ("cue raises tension", "cue lowers tension", "anterior", "posterior"):
        assert words in texts(figure)
    # The force panel runs the same way: anterior, u = 1, on the left.
    assert figure.axes[-1].get_xlim() == (1.0, 0.0)
    germline = furrow.Cell(4, cue="germline").divide(frames=True).plot()
    assert "cue raises rigidity" in texts(germline) and "lowers" not in texts(germline)
    assert "cue raises" not in texts(furrow.Cell(4).divide(frames=True).plot())


def test_long_titles_stay_within_the_figure():
    for figure in (furrow.Cell(4, cue=LONG).divide(frames=True).plot(), furrow.Cell(2, cue=LONG).branch(xi_max=5).plot()):
        figure.canvas.draw()
        title = figure._suptitle
        assert title.get_window_extent().x1 < figure.bbox.x1
        assert LONG in title.get_text().replace("\n", "")
    assert "strips from the inside: tension, rigidity κ" in texts(furrow.Cell(4, cue=LONG).divide(frames=True).plot())


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
    assert "unstable" in texts(figure) and "unstable" not in texts(furrow.Cell(2).branch(xi_max=10).plot())
    assert len(furrow.Cell(2, cue="germline").branch(xi_max=10).plot().axes) == 1


def test_rounds_and_ranges():
    figure = furrow.tree().plot()
    assert "terminal cells" in texts(figure) and "P4" in texts(figure)
    table = "aspect,p0,w,gain,weight\n1.5,0.123,0.1445,0.5,0.5\n1.49,0.122,0.144,0.5,0.5\n"
    constants = furrow.Constants(("aspect",), np.array([[1.5], [1.49]]), np.array([0.5, 0.5]), 2.0, 2, {}, table)
    figure = furrow.tree_ensemble('(name: "S", founders: [(name: "S", r0: 2.4)])', constants=constants).plot()
    assert "2 sets" in texts(figure)


def test_measured_volumes_and_outlines():
    found = furrow.compare.volumes()
    figure = found.plot()
    assert "model" in texts(figure) and "P3" in texts(figure)
    division = furrow.Cell(4, cue="germline").divide(frames=0.2)
    half = division.frames[3].contour.points
    ring = np.concatenate((half, half[::-1] * [-1, 1]))
    assert "|A∩B|/|A| = 1.000" in texts(furrow.compare.contours([ring], division).plot())


def test_a_cue_that_follows_polarity_is_drawn():
    division = furrow.Cell(4, cue="kappa:par_band,amplitude=0.1").divide(frames=True)
    (legend,) = division.plot().legends
    assert [handle.get_label() for handle in legend.legend_handles] == ["cue raises rigidity κ"]
