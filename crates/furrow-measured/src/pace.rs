//! Embryos beside each other: how fast each develops, when its clock begins, how large it is.
//!
//! * \[time factor\] lifetimes of embryo e are t_ec = f_e t_c: f by least squares of ln t_ec over the cells that several embryos have, with
//!   a geometric mean of 1;
//! * \[shift\] births are b_ec = s_e + b_c, in the same way, with 0 for the first embryo;
//! * \[size factor\] volumes are V_ec = v_e V_c, as lifetimes.

use std::collections::HashMap;

/// Values of cells in embryos: the embryo, the cell, the value.
pub(crate) type InEmbryos<'a> = Vec<(usize, &'a str, f64)>;

/// What each embryo adds to the values of its cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shares {
    /// By embryo, with a mean of 0; `None` for an embryo that shares no cell with others.
    pub(crate) of: Vec<Option<f64>>,
    /// Standard deviation of the residuals, by embryo; `None` below two shared cells.
    pub(crate) scatter: Vec<Option<f64>>,
    /// Cells that it shares with others, by embryo.
    pub(crate) shared: Vec<usize>,
}

/// Rounds of the least squares, and the change at which they end.
const ROUNDS: usize = 10_000;
const SMALLEST: f64 = 1e-13;

/// The least squares of value = share of the embryo + value of the cell.
pub(crate) fn shares(values: &InEmbryos<'_>, embryos: usize) -> Shares {
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut counts: Vec<usize> = Vec::new();
    for (_, cell, _) in values {
        let place = *places.entry(cell).or_insert(counts.len());
        if place == counts.len() {
            counts.push(0);
        }
        counts[place] += 1;
    }
    // Cells of one embryo say nothing of it beside others.
    let rows = values.iter().map(|(embryo, cell, value)| (*embryo, places[cell], *value));
    let rows: Vec<(usize, usize, f64)> = rows.filter(|(_, cell, _)| counts[*cell] > 1).collect();
    let mut shared = vec![0; embryos];
    rows.iter().for_each(|(embryo, ..)| shared[*embryo] += 1);
    let (mut of, mut cells) = (vec![0.0; embryos], vec![0.0; counts.len()]);
    for _ in 0..ROUNDS {
        cells = means(counts.len(), rows.iter().map(|(embryo, cell, value)| (*cell, value - of[*embryo])));
        let mut next = means(embryos, rows.iter().map(|(embryo, cell, value)| (*embryo, value - cells[*cell])));
        let known = shared.iter().filter(|shared| **shared > 0).count().max(1) as f64;
        let middle = next.iter().sum::<f64>() / known;
        next.iter_mut().zip(&shared).filter(|(_, shared)| **shared > 0).for_each(|(next, _)| *next -= middle);
        let change = next.iter().zip(&of).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        of = next;
        if change < SMALLEST {
            break;
        }
    }
    let mut squares = vec![0.0; embryos];
    rows.iter().for_each(|(embryo, cell, value)| squares[*embryo] += (value - of[*embryo] - cells[*cell]).powi(2));
    let scatter = squares.iter().zip(&shared);
    let scatter = scatter.map(|(sum, n)| (*n > 1).then(|| (sum / (*n as f64 - 1.0)).sqrt())).collect();
    let of = of.into_iter().zip(&shared).map(|(share, n)| (*n > 0).then_some(share)).collect();
    Shares { of, scatter, shared }
}

/// Means of values by place; 0 for places without values.
fn means(places: usize, values: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0_u32); places];
    for (place, value) in values {
        sums[place].0 += value;
        sums[place].1 += 1;
    }
    sums.into_iter().map(|(sum, count)| sum / f64::from(count.max(1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_and_cells_are_recovered() {
        let (factors, lives): ([f64; 3], [f64; 4]) = ([0.8, 1.0, 1.25], [20.0, 30.0, 25.0, 40.0]);
        let names = ["a", "b", "c", "d"];
        // The second embryo lacks a cell; the fourth embryo shares no cell.
        let mut values: InEmbryos<'_> = Vec::new();
        for (e, factor) in factors.iter().enumerate() {
            for (c, life) in lives.iter().enumerate().filter(|(c, _)| (e, *c) != (1, 2)) {
                values.push((e, names[c], (factor * life).ln()));
            }
        }
        values.push((3, "e", 1.0));
        let found = shares(&values, 4);
        for (share, factor) in found.of.iter().zip(factors) {
            assert!((share.unwrap().exp() - factor).abs() < 1e-12, "{found:?}");
        }
        assert_eq!((found.of[3], &found.shared[..]), (None, &[4, 3, 4, 0][..]));
        assert!(found.scatter[0].unwrap() < 1e-12);
    }
}
