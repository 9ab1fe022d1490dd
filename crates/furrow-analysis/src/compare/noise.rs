//! How much of a trend of χ over size the noise of the measurement makes.
//!
//! Two equal daughters have χ above 0 once their volumes are measured with errors, and χ rises as cells shrink if their relative
//! errors do. The null hypothesis is that every division is equal and that errors of volumes are independent and log-normal. Their
//! size comes from the same table: a mother and her two daughters together have the same volume, so that
//!
//! * \[spread\] ln(V_mother/(V₁ + V₂)) spreads by σ√(1 + ½), where σ is the relative error of one volume and daughters are
//!   about equal.
//!
//! The spread is 1.4826 times the median absolute deviation from the median, which outliers do not widen, in groups of equally many
//! divisions. Each draw has other σ, as uncertain as the spread of so few divisions: the estimate over the spread of as many standard
//! normal numbers. Growth and lasting differences between embryos widen the spread too, which makes σ larger than the noise is.

use furrow_measured::events::Division;
use furrow_measured::statistics::{Line, mean, median};
use furrow_measured::trend::{VolumeBin, volume_line};
use ordered_float::OrderedFloat;
use rand_mt::Mt64;
use serde::Serialize;

use crate::ensemble::normal;

/// Draws of the null hypothesis.
pub(crate) const DRAWS: usize = 1000;
/// Most groups by which noise is estimated, and fewest divisions in one.
const GROUPS: usize = 8;
const FEWEST: usize = 20;
/// What makes the median absolute deviation of normal numbers their standard deviation.
const NORMAL: f64 = 1.482_602_218_505_602;

/// A group of divisions by volume, and the noise of volumes in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseGroup {
    /// Smallest mother, as large as her daughters together, in the unit of the table.
    pub from: f64,
    /// Largest mother.
    pub to: f64,
    /// Divisions.
    pub n: usize,
    /// Median of ln(V_mother/(V₁ + V₂)).
    pub median: f64,
    /// Its spread.
    pub spread: f64,
    /// Relative error of one volume.
    pub relative_error: f64,
}

/// Mean and central 95 % of the draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Mean.
    pub mean: f64,
    /// 2.5 % lie below.
    pub low: f64,
    /// 97.5 % lie below.
    pub high: f64,
}

impl Interval {
    fn of(mut values: Vec<f64>) -> Interval {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        Interval { mean: mean(&values), low: at(0.025), high: at(0.975) }
    }
}

/// χ of a bin, and what noise makes of equal divisions there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseBin {
    /// The bin.
    pub bin: String,
    /// Measured mean χ.
    pub measured: f64,
    /// Mean χ of equal divisions with noise; `None` if draws left the bin empty.
    pub null: Option<Interval>,
}

/// A trend of χ beside the one that noise makes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseNull {
    /// Divisions with a measured mother.
    pub n: usize,
    /// Seed of the draws, from the volumes.
    pub seed: u64,
    /// Number of draws.
    pub draws: usize,
    /// The noise by size, from the smallest mothers on.
    pub groups: Vec<NoiseGroup>,
    /// Measured χ over log₁₀ of the mother's volume.
    pub measured: Line,
    /// Its slope for equal divisions.
    pub null_slope: Interval,
    /// Mean null slope over the measured one.
    pub share: f64,
    /// Share of the draws and the measurement with a trend at least as steep as the measured one, in its direction.
    pub p: f64,
    /// χ by bin.
    pub bins: Vec<NoiseBin>,
}

/// A division as the null hypothesis has it: equal halves of a volume with relative errors.
struct Equal {
    volume: f64,
    group: usize,
}

/// The null hypothesis beside the divisions with measured mothers, in these bins; `None` with fewer than twenty, or without
/// a trend.
pub(crate) fn noise_null(divisions: &[Division], bins: &[VolumeBin]) -> Option<NoiseNull> {
    let mut known: Vec<&Division> = divisions.iter().filter(|d| d.mother_measured.is_some()).collect();
    known.sort_by_cached_key(|item| OrderedFloat(item.mother_volume()));
    let points: Vec<[f64; 2]> = known.iter().map(|d| [d.mother_volume(), d.chi()]).collect();
    let measured = volume_line(&points).filter(|line| line.n >= FEWEST && line.slope != 0.0)?;
    let groups = noise_groups(&known);
    let of = groups.iter().enumerate().flat_map(|(k, group)| std::iter::repeat_n(k, group.n));
    let equals: Vec<Equal> =
        known.iter().zip(of).map(|(d, group)| Equal { volume: d.mother_volume(), group }).collect();
    let seed = seed(&known);
    let mut random = Mt64::new(seed);
    let (mut slopes, mut means) = (Vec::with_capacity(DRAWS), vec![Vec::new(); bins.len()]);
    for _ in 0..DRAWS {
        let errors: Vec<f64> = groups.iter().map(|group| group.draw_error(&mut random)).collect();
        let drawn: Vec<[f64; 2]> = equals.iter().map(|equal| equal.draw(errors[equal.group], &mut random)).collect();
        slopes.push(volume_line(&drawn)?.slope);
        for (bin, means) in bins.iter().zip(&mut means) {
            let inside = |point: &&[f64; 2]| (bin.from..bin.to).contains(&point[0]);
            let chi: Vec<f64> = drawn.iter().filter(inside).map(|point| point[1]).collect();
            means.extend((!chi.is_empty()).then(|| mean(&chi)));
        }
    }
    let way = measured.slope.signum();
    let as_steep = slopes.iter().filter(|slope| way * **slope >= way * measured.slope).count();
    let null_slope = Interval::of(slopes);
    let bin = |(bin, means): (&VolumeBin, Vec<f64>)| NoiseBin {
        bin: bin.name(),
        measured: bin.mean,
        null: (!means.is_empty()).then(|| Interval::of(means)),
    };
    Some(NoiseNull {
        n: known.len(),
        seed,
        draws: DRAWS,
        groups,
        measured,
        share: null_slope.mean / measured.slope,
        null_slope,
        p: (as_steep + 1) as f64 / (DRAWS + 1) as f64,
        bins: bins.iter().zip(means).map(bin).collect(),
    })
}

impl Equal {
    /// Measured volume of the mother and χ.
    fn draw(&self, error: f64, random: &mut Mt64) -> [f64; 2] {
        let [a, b] = [(); 2].map(|()| 0.5 * self.volume * (error * normal(random)).exp());
        [a + b, (a - b).abs() / (a + b)]
    }
}

impl NoiseGroup {
    /// A relative error that may have given the estimated one.
    fn draw_error(&self, random: &mut Mt64) -> f64 {
        let normals: Vec<f64> = (0..self.n).map(|_| normal(random)).collect();
        self.relative_error / spread(&normals)
    }
}

/// 1.4826 times the median absolute deviation from the median.
fn spread(values: &[f64]) -> f64 {
    let middle = median(values);
    NORMAL * median(&Vec::from_iter(values.iter().map(|value| (value - middle).abs())))
}

/// Noise by size, of divisions in the order of their volume.
fn noise_groups(known: &[&Division]) -> Vec<NoiseGroup> {
    let count = (known.len() / FEWEST).clamp(1, GROUPS);
    // As equal as whole numbers allow, the first ones larger.
    let (each, more) = (known.len() / count, known.len() % count);
    let start = |k: usize| k * each + k.min(more);
    let group = |k: usize| {
        let part = &known[start(k)..start(k + 1)];
        let ratio = |d: &&Division| d.mother_measured.map(|mother| (mother / d.mother_volume()).ln());
        let ratios: Vec<f64> = part.iter().filter_map(ratio).collect();
        let spread = spread(&ratios);
        NoiseGroup {
            from: part[0].mother_volume(),
            to: part[part.len() - 1].mother_volume(),
            n: part.len(),
            median: median(&ratios),
            spread,
            relative_error: spread / 1.5_f64.sqrt(),
        }
    };
    (0..count).map(group).collect()
}

/// A seed from the volumes: the same table gives the same draws.
fn seed(known: &[&Division]) -> u64 {
    let mut hasher = blake3::Hasher::new();
    known.iter().flat_map(|d| d.volumes).for_each(|volume| {
        hasher.update(&volume.to_le_bytes());
    });
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
    // 53 bits, which JSON numbers hold.
    u64::from_le_bytes(bytes) >> 11
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_measured::trend::volume_bins;

    /// Divisions of mothers of 100 and 10,000 with relative errors of `noise` at either size, and true χ.
    fn made(noise: [f64; 2], chi: [f64; 2]) -> Vec<Division> {
        let mut random = Mt64::new(7);
        let sizes = [100.0, 10_000.0];
        let of = |k: usize| {
            let (volume, noise, chi) = (sizes[k % 2] * (1.0 + 1e-4 * k as f64), noise[k % 2], chi[k % 2]);
            let mut measured = |true_volume: f64| true_volume * (noise * normal(&mut random)).exp();
            let [a, b] = [0.5 * (1.0 + chi), 0.5 * (1.0 - chi)].map(|share| measured(share * volume));
            Division {
                embryo: "e".into(),
                mother: k.to_string(),
                volumes: [a.max(b), a.min(b)],
                chi_signed: (a - b).abs() / (a + b),
                mother_measured: Some(measured(volume)),
                ..Division::default()
            }
        };
        (0..800).map(of).collect()
    }

    fn null(divisions: &[Division]) -> NoiseNull {
        noise_null(divisions, &volume_bins(divisions, Some(&[1.0, 1000.0, 100_000.0]))).unwrap()
    }

    /// Equal divisions with noise have the trend that the null hypothesis gives them, unequal ones without noise have not.
    #[test]
    fn noise_explains_the_trend_that_it_makes_and_no_other() {
        let equal = null(&made([0.2, 0.05], [0.0, 0.0]));
        assert!((equal.share - 1.0).abs() < 0.1 && equal.p > 0.02 && equal.p < 0.98, "{equal:?}");
        // Four groups of either size; a group by volume holds a part of its errors alone.
        let error = |groups: &[NoiseGroup]| mean(&groups.iter().map(|group| group.relative_error).collect::<Vec<_>>());
        let (small, large) = (error(&equal.groups[..4]), error(&equal.groups[4..]));
        assert!((small - 0.2).abs() < 0.03 && (large - 0.05).abs() < 0.01, "{small} {large}");
        // Of two errors σ the mean χ is σ/√π; the estimate by the spread of 100 standard normal numbers has the mean 1.0221 (NumPy).
        let chi = equal.bins[0].null.unwrap();
        assert!((chi.mean * std::f64::consts::PI.sqrt() / (1.0221 * large) - 1.0).abs() < 0.01 && chi.low < chi.mean);
        let unequal = null(&made([0.02, 0.02], [0.2, 0.05]));
        assert!(unequal.share.abs() < 0.1 && unequal.p == 1.0 / (DRAWS + 1) as f64, "{unequal:?}");
        assert_eq!(null(&made([0.2, 0.05], [0.0, 0.0])), equal);
    }

    /// Where noise is the same at all sizes, a trend of either direction is as steep as one draw in twenty in one table of ten. With the
    /// estimated errors taken for known it would be in three.
    #[test]
    fn a_true_null_is_rejected_as_often_as_p_says() {
        let mut random = Mt64::new(3);
        let mut table = || {
            let of = |k: usize| {
                let volume = 10.0_f64.powf(2.0 + 3.0 * k as f64 / 40.0);
                let [a, b, mother] = [0.5, 0.5, 1.0].map(|share| share * volume * (0.1 * normal(&mut random)).exp());
                let chi_signed = (a - b) / (a + b);
                Division {
                    volumes: [a.max(b), a.min(b)],
                    chi_signed,
                    mother_measured: Some(mother),
                    ..Division::default()
                }
            };
            (0..40).map(of).collect::<Vec<_>>()
        };
        let rejected = (0..100).filter(|_| noise_null(&table(), &[]).unwrap().p < 0.05).count();
        assert!((2..=19).contains(&rejected), "{rejected}");
    }

    #[test]
    fn without_mothers_there_is_no_null() {
        let mut divisions = made([0.2, 0.05], [0.0, 0.0]);
        divisions.iter_mut().for_each(|division| division.mother_measured = None);
        assert!(noise_null(&divisions, &[]).is_none());
    }
}
