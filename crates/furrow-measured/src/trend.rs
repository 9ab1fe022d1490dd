//! χ by the mother's volume: by decades, each held against the one of larger cells beside it.

use serde::Serialize;

use crate::events::Division;
use crate::statistics::{BoxPlot, RankSum, box_plot, mean, rank_sum, sd, stars};

/// Divisions of mothers in one decade of volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeBin {
    /// Volumes from here, in the unit of the table.
    pub from: f64,
    /// To below here.
    pub to: f64,
    /// Divisions.
    pub n: usize,
    /// Mean |χ|.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: Option<f64>,
    /// Its box.
    pub box_plot: Option<BoxPlot>,
    /// |χ| of each.
    #[serde(skip)]
    pub chi: Vec<f64>,
}

/// A test of whether |χ| of the smaller cells tends to be larger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AdjacentTest {
    /// The bin of the smaller cells.
    pub a: String,
    /// That of the larger.
    pub b: String,
    /// Divisions in it.
    pub n_a: usize,
    /// Divisions in the other.
    pub n_b: usize,
    /// The rank sums.
    #[serde(flatten)]
    pub test: RankSum,
    /// Its stars.
    pub stars: &'static str,
}

impl VolumeBin {
    /// How it is called.
    pub fn name(&self) -> String {
        format!("{}..{}", self.from, self.to)
    }
}

/// Bins from the largest volumes to the smallest, those without a division left out. `edges` rise; without them they are powers
/// of ten.
pub fn volume_bins(divisions: &[Division], edges: Option<&[f64]>) -> Vec<VolumeBin> {
    let volumes = || divisions.iter().map(Division::mother_volume);
    if divisions.is_empty() {
        return Vec::new();
    }
    let decades = || {
        let least = volumes().fold(f64::INFINITY, f64::min).log10().floor();
        let most = volumes().fold(0.0, f64::max).log10().floor();
        // Powers with an exponent from the list: 10^3 is 1000 exactly.
        (least as i32..=most as i32 + 1).map(|power| 10_f64.powi(power)).collect()
    };
    let edges = edges.map_or_else(decades, <[f64]>::to_vec);
    let bin = |pair: &[f64]| {
        let inside = |division: &&Division| (pair[0]..pair[1]).contains(&division.mother_volume());
        let chi: Vec<f64> = divisions.iter().filter(inside).map(Division::chi).collect();
        let (mean, sd, box_plot) = (mean(&chi), sd(&chi), box_plot(&chi));
        (!chi.is_empty()).then(|| VolumeBin { from: pair[0], to: pair[1], n: chi.len(), mean, sd, box_plot, chi })
    };
    edges.windows(2).rev().filter_map(bin).collect()
}

/// Each bin beside the next one of larger cells.
pub fn adjacent_tests(bins: &[VolumeBin]) -> Vec<AdjacentTest> {
    let of = |pair: &[VolumeBin]| {
        let [large, small] = pair else { return None };
        let test = rank_sum(&small.chi, &large.chi)?;
        let (n_a, n_b) = (small.n, large.n);
        Some(AdjacentTest { a: small.name(), b: large.name(), n_a, n_b, test, stars: stars(test.p) })
    };
    bins.windows(2).filter_map(of).collect()
}
