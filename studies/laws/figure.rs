//! The figure of the study.

use furrow_figures::drawing::Canvas;
use furrow_figures::plot::curves::{self, Curves, Measured, Note, Series};

use super::embryo::{self, RING_SPEEDS};
use super::{Curve, SHARES, SIZES};

/// The lines of a curve over R0, broken where cells do not divide.
fn over_size(curve: &Curve, of: impl Fn(usize) -> f64) -> Vec<Series> {
    let indices: Vec<usize> = (0..SIZES.len()).collect();
    let runs = indices.split(|k| !curve.rows[*k].divided).filter(|run| !run.is_empty());
    let series = |run: &[usize]| Series {
        name: curve.law.name().to_owned(),
        points: run.iter().map(|k| [SIZES[*k], of(*k)]).collect(),
        dashed: curve.cued,
    };
    runs.map(series).collect()
}

/// Speeds between shares, relative to the mean from the first share to the last.
fn relative(speeds: [f64; 4]) -> Vec<[f64; 2]> {
    let time: f64 = (0..4).map(|k| (SHARES[k] - SHARES[k + 1]) / speeds[k]).sum();
    let mean = (SHARES[0] - SHARES[4]) / time;
    (0..4).map(|k| [0.5 * (SHARES[k] + SHARES[k + 1]), speeds[k] / mean]).collect()
}

/// Draws times, speeds and χ.
pub fn draw(curves: &[Curve], measured: &[embryo::Measured]) -> Canvas {
    let size = || ("radius R0 (L_h)".to_owned(), [1.7, 5.5]);
    let times = Curves {
        title: "Four laws of active stress\ntime of pinch-off over the size of the cell, speed of the zygote's ring over its radius, χ over the size"
            .to_owned(),
        axes: [size(), ("pinch-off (τ)".to_owned(), [0.2, 100.0])],
        logarithmic: true,
        series: curves.iter().flat_map(|curve| over_size(curve, |k| curve.rows[k].t_end)).collect(),
        ..Curves::default()
    };
    let zygote = |curve: &Curve| Series {
        name: curve.law.name().to_owned(),
        points: relative(curve.rows[SIZES.len() - 1].speeds()),
        dashed: curve.cued,
    };
    let place = |at| Measured { at, sd: 0.0, open: false };
    let speeds = Curves {
        axes: [
            ("radius of the ring over the first".to_owned(), [0.9, 0.1]),
            ("speed over its mean".to_owned(), [0.0, 2.0]),
        ],
        series: curves.iter().filter(|curve| curve.rows[SIZES.len() - 1].divided).map(zygote).collect(),
        measured: relative(RING_SPEEDS).into_iter().map(place).collect(),
        ..Curves::default()
    };
    let of_mother = |of: &embryo::Measured| Measured { at: [of.r0, of.mean], sd: of.sd, open: !of.germline };
    let chi = Curves {
        axes: [size(), ("χ".to_owned(), [0.0, 1.0])],
        series: curves.iter().flat_map(|curve| over_size(curve, |k| curve.rows[k].chi)).collect(),
        measured: measured.iter().map(of_mother).collect(),
        ..Curves::default()
    };
    let notes = [
        (Note::Dashes, "with a cue at u = 0.465"),
        (Note::Disc, "embryos; in χ their germline, which has the cue"),
        (Note::Ring, "their other cells"),
    ];
    curves::stack(&[times, speeds, chi], &notes)
}
