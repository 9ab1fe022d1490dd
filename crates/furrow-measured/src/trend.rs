//! χ by the mother's volume: by decades, each held against the one of larger cells beside it.

use serde::Serialize;

use crate::events::Division;
use crate::statistics::{
    BoxPlot, Line, RankCorrelation, RankSum, box_plot, grouped, line_of, mean, rank_correlation, rank_sum, sd, stars,
};

/// Divisions of mothers in one decade of volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeBin {
    /// Volumes from here, in the unit of the table.
    pub from: f64,
    /// To below here.
    pub to: f64,
    /// Divisions.
    pub n: usize,
    /// Mean volume of the mothers.
    pub mother_volume: f64,
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
    /// The bin of the larger cells.
    pub b: String,
    /// Divisions in `a`.
    pub n_a: usize,
    /// Divisions in `b`.
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
        let volumes: Vec<f64> = divisions.iter().filter(inside).map(Division::mother_volume).collect();
        let (mean, sd, box_plot) = (mean(&chi), sd(&chi), box_plot(&chi));
        (!chi.is_empty()).then(|| VolumeBin {
            from: pair[0],
            to: pair[1],
            n: chi.len(),
            mother_volume: crate::statistics::mean(&volumes),
            mean,
            sd,
            box_plot,
            chi,
        })
    };
    edges.windows(2).rev().filter_map(bin).collect()
}

/// χ over log₁₀ of the mother's volume, of pairs of both; its slope is per decade.
pub fn volume_line(points: &[[f64; 2]]) -> Option<Line> {
    line_of(&points.iter().map(|[volume, chi]| [volume.log10(), *chi]).collect::<Vec<_>>(), [1.0, 0.0])
}

/// The trend of χ over the mother's volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeTrend {
    /// χ over log₁₀ of the volume.
    pub line: Option<Line>,
    /// Rank correlation of volume and χ.
    pub spearman: Option<RankCorrelation>,
    /// The line of each embryo, in the order of the table: a trend over all may be one between embryos.
    pub embryos: Vec<EmbryoTrend>,
    /// Divisions beyond the first one of each mother; all tests take them for independent.
    pub repeats: usize,
}

/// The trend within an embryo.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbryoTrend {
    /// The embryo.
    pub embryo: String,
    /// χ over log₁₀ of the volume.
    pub line: Line,
}

/// The trend of some divisions, over all and within embryos.
pub fn volume_trend(divisions: &[Division]) -> VolumeTrend {
    let point = |division: &Division| [division.mother_volume(), division.chi()];
    let all: Vec<[f64; 2]> = divisions.iter().map(point).collect();
    let embryos = grouped(divisions.iter().map(|division| (division.embryo.as_str(), point(division))));
    let of = |(embryo, points): (&str, Vec<[f64; 2]>)| {
        Some(EmbryoTrend { embryo: embryo.to_owned(), line: volume_line(&points)? })
    };
    let embryos = embryos.into_iter().filter_map(of).collect();
    let cells = grouped(divisions.iter().map(|division| (division.mother.as_str(), ())));
    let repeats = divisions.len() - cells.len();
    VolumeTrend { line: volume_line(&all), spearman: rank_correlation(&all), embryos, repeats }
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
