//! A number that differs between embryos: their values scatter about a common one with a standard deviation that is sampled too.
//!
//! * \[F.17 by embryo\] ln L = Σ_e ln ∫ φ(z) Π_i p(χ_i | x + s z) dz over embryos e and their divisions i, with φ the standard normal
//!   density, x the place of the common value in its range, and s the standard deviation, both as shares of the range.
//!
//! χ is computed at some values and interpolated between them, so that all embryos share the divisions.

use std::f64::consts::TAU;

use furrow_measured::statistics::mean;
use serde::Serialize;

use super::noise::Noise;
use super::observations::Observations;
use crate::ensemble::relative_weights;
use crate::fit::chain::Model;

/// The largest standard deviation, as a share of the range.
const WIDEST: f64 = 0.25;
/// The integral ends at this number of standard deviations.
const REACH: f64 = 3.0;
/// Values at which χ is computed, and between two of them steps of the integral.
const NODES: usize = 9;
const BETWEEN: usize = 8;
/// Distance of two nodes, in standard deviations.
const WIDTH: f64 = 2.0 * REACH / (NODES - 1) as f64;

/// The number of an embryo over the sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbryoNumber {
    /// The embryo.
    pub embryo: String,
    /// The mean.
    pub mean: f64,
    /// The standard deviation.
    pub sd: f64,
}

/// The standard deviation at a place of its own unit interval, in the unit of the number, of its logarithm where that is searched.
pub(super) fn spread(model: &Model<'_>, k: usize, share: f64) -> f64 {
    WIDEST * share * model.unknowns[k].length()
}

/// A point of the integral.
struct Step {
    /// Distance from the common value, in standard deviations.
    z: f64,
    /// ln of its weight.
    log_weight: f64,
    /// The node before it, and its distance from that node as a share of the interval.
    node: usize,
    share: f64,
}

/// Distance of a node from the common value, in standard deviations.
fn node(j: usize) -> f64 {
    -REACH + WIDTH * j as f64
}

/// The points of the integral.
fn steps() -> Vec<Step> {
    let density = |z: f64| (-0.5 * z * z).exp() / TAU.sqrt();
    let at = |i: usize| {
        let (node, share) = ((i / BETWEEN).min(NODES - 2), i as f64 / BETWEEN as f64);
        (-REACH + WIDTH * share, node, share - node as f64)
    };
    let points: Vec<(f64, usize, f64)> = (0..=(NODES - 1) * BETWEEN).map(at).collect();
    let all: f64 = points.iter().map(|(z, ..)| density(*z)).sum();
    let step = |(z, node, share)| Step { z, log_weight: (density(z) / all).ln(), node, share };
    points.into_iter().map(step).collect()
}

/// χ between two nodes. Where one of the two comes to rest, the nearer one decides.
fn between(pair: [Option<f64>; 2], share: f64) -> Option<f64> {
    match pair {
        [Some(a), Some(b)] => Some(a + share * (b - a)),
        pair => pair[usize::from(share >= 0.5)],
    }
}

/// The log likelihood of χ if the number `k` differs between embryos, and for each embryo the mean of the number and the mean of its
/// square. The last coordinate of `place` is the place of its standard deviation.
pub(super) fn by_embryo(
    model: &Model<'_>,
    k: usize,
    place: &[f64],
    (observations, noise): (&Observations, &Noise),
) -> (f64, Vec<[f64; 2]>) {
    let Observations { rows, cells, units, .. } = observations;
    let Some((share, place)) = place.split_last() else { return (0.0, Vec::new()) };
    let at = |z: f64| {
        let mut place = place.to_vec();
        place[k] = (place[k] + WIDEST * share * z).clamp(0.0, 1.0);
        model.values(&place)
    };
    let nodes: Vec<Vec<Option<f64>>> = (0..NODES).map(|j| model.chi(&at(node(j)), cells)).collect();
    let steps = steps();
    let values: Vec<f64> = steps.iter().map(|step| at(step.z)[k]).collect();
    let sds = noise.sds(rows);
    let of = |unit: usize| {
        let own = || rows.iter().zip(&sds).filter(move |(row, _)| row.unit == unit);
        let log = |Step { log_weight, node, share, .. }: &Step| {
            let chi = |cell: usize| between([nodes[*node][cell], nodes[node + 1][cell]], *share);
            own().map(|(row, sd)| noise.log_density(row, chi(row.cell), *sd)).sum::<f64>() + log_weight
        };
        let logs: Vec<f64> = steps.iter().map(log).collect();
        let (weights, most) = relative_weights(logs.into_iter(), 1.0);
        let sum: f64 = weights.iter().sum();
        let moment = |power: i32| weights.iter().zip(&values).map(|(w, x)| w * x.powi(power)).sum::<f64>() / sum;
        (most + sum.ln(), [moment(1), moment(2)])
    };
    let (logs, moments): (Vec<f64>, Vec<[f64; 2]>) = (0..units.len()).map(of).unzip();
    (logs.iter().sum(), moments)
}

/// The number of each embryo over the points of a sample.
pub(super) fn numbers<'a>(
    units: &[String],
    points: impl Iterator<Item = &'a Vec<[f64; 2]>> + Clone,
) -> Vec<EmbryoNumber> {
    let of = |(unit, embryo): (usize, &String)| {
        let over = |power: usize| mean(&points.clone().map(|moments| moments[unit][power]).collect::<Vec<_>>());
        let (mean, squares) = (over(0), over(1));
        EmbryoNumber { embryo: embryo.clone(), mean, sd: (squares - mean * mean).max(0.0).sqrt() }
    };
    units.iter().enumerate().map(of).collect()
}
