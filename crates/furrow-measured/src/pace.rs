//! Embryos beside each other: how fast each develops, when its clock begins, how large it is.
//!
//! * \[time factor\] lifetimes of embryo e are t_ec = f_e t_c: f by least squares of ln t_ec over the cells that several embryos have, with
//!   a geometric mean of 1;
//! * \[shift\] births are b_ec = s_e + b_c, in the same way, with 0 for the first embryo;
//! * \[size factor\] volumes are V_ec = v_e V_c, as lifetimes.
//!
//! Shared cells connect embryos, directly or through other embryos. Embryos without a connection have no common scale. Only the largest
//! set of connected embryos gets factors; of several largest sets, the one with the first embryo.

use std::collections::HashMap;

use crate::statistics::distinct;

/// Values of cells in embryos: the embryo, the cell, the value.
pub(crate) type InEmbryos<'a> = Vec<(usize, &'a str, f64)>;

/// What each embryo adds to the values of its cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shares {
    /// By embryo, with a mean of 0; `None` for an embryo that no shared cells connect with the largest set of embryos.
    pub(crate) of: Vec<Option<f64>>,
    /// Standard deviation of the residuals, by embryo; `None` below two shared cells, and where shares and cells leave no degrees of
    /// freedom. Embryos get the degrees of freedom in proportion to n − 1, with n their shared cells.
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
    let is_known = connected(&rows, embryos, counts.len());
    let rows: Vec<(usize, usize, f64)> = rows.into_iter().filter(|(embryo, ..)| is_known[*embryo]).collect();
    let (mut of, mut cells) = (vec![0.0; embryos], vec![0.0; counts.len()]);
    for _ in 0..ROUNDS {
        cells = means(counts.len(), rows.iter().map(|(embryo, cell, value)| (*cell, value - of[*embryo])));
        let mut next = means(embryos, rows.iter().map(|(embryo, cell, value)| (*embryo, value - cells[*cell])));
        let known = is_known.iter().filter(|is_known| **is_known).count().max(1) as f64;
        let middle = next.iter().sum::<f64>() / known;
        next.iter_mut().zip(&is_known).filter(|(_, is_known)| **is_known).for_each(|(next, _)| *next -= middle);
        let change = next.iter().zip(&of).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        of = next;
        if change < SMALLEST {
            break;
        }
    }
    let mut squares = vec![0.0; embryos];
    rows.iter().for_each(|(embryo, cell, value)| squares[*embryo] += (value - of[*embryo] - cells[*cell]).powi(2));
    let own = |embryo: usize| if is_known[embryo] { shared[embryo] as f64 - 1.0 } else { 0.0 };
    let fitted = distinct(rows.iter().map(|(_, cell, _)| *cell)).len() as f64 - 1.0;
    let all: f64 = (0..embryos).map(own).sum();
    let freedom = |embryo: usize| own(embryo) * (all - fitted) / all;
    let scatter = (0..embryos).map(|k| (freedom(k) > 0.0).then(|| (squares[k] / freedom(k)).sqrt())).collect();
    let of = of.into_iter().zip(is_known).map(|(share, is_known)| is_known.then_some(share)).collect();
    Shares { of, scatter, shared }
}

/// The largest set of embryos that cells connect, of rows of embryos and cells.
fn connected(rows: &[(usize, usize, f64)], embryos: usize, cells: usize) -> Vec<bool> {
    let mut sets: Vec<usize> = (0..embryos).collect();
    loop {
        let before = sets.clone();
        let mut least = vec![embryos; cells];
        rows.iter().for_each(|(embryo, cell, _)| least[*cell] = least[*cell].min(sets[*embryo]));
        rows.iter().for_each(|(embryo, cell, _)| sets[*embryo] = sets[*embryo].min(least[*cell]));
        if sets == before {
            break;
        }
    }
    let mut sizes = vec![0_usize; embryos];
    distinct(rows.iter().map(|(embryo, ..)| *embryo)).into_iter().for_each(|embryo| sizes[sets[embryo]] += 1);
    let largest = sizes.iter().copied().max().filter(|size| *size > 0);
    let largest = largest.and_then(|largest| sizes.iter().position(|size| *size == largest));
    sets.into_iter().map(|set| Some(set) == largest).collect()
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

    /// Of two embryos the scatter of one is the standard deviation of their differences by √2, whatever the cells are.
    #[test]
    fn the_scatter_counts_the_fitted_means_of_cells() {
        let differences: [f64; 4] = [0.1, -0.2, 0.25, 0.05];
        let of = |(differs, cell): (&f64, &'static str)| [(0, cell, 2.0), (1, cell, 2.0 + differs)];
        let values: InEmbryos<'_> = differences.iter().zip(["a", "b", "c", "d"]).flat_map(of).collect();
        let expected = crate::statistics::sd(&differences).unwrap() / 2.0_f64.sqrt();
        for scatter in shares(&values, 2).scatter {
            assert!((scatter.unwrap() - expected).abs() < 1e-12, "{scatter:?} {expected}");
        }
        assert_eq!(shares(&vec![(0, "a", 1.0), (1, "a", 2.0)], 2).scatter, [None, None]);
    }

    /// Only the largest set of connected embryos has shares.
    #[test]
    fn embryos_without_a_common_cell_are_not_compared() {
        let values = vec![(0, "a", 1.0), (1, "a", 2.0), (2, "b", 9.0), (3, "b", 9.0), (3, "c", 5.0), (4, "c", 6.0)];
        let found = shares(&values, 5);
        assert_eq!((&found.of[..2], &found.shared[..]), (&[None, None][..], &[1, 1, 1, 2, 1][..]));
        let known: Vec<f64> = found.of[2..].iter().map(|share| share.unwrap()).collect();
        let expected = [-1.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
        assert!(known.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{known:?}");
    }
}
