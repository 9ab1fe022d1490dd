//! Simulation-based calibration with divisions: posteriors and p values of synthetic embryos with known numbers.

use furrow_cell::Cue;
use furrow_lineage::Lineage;
use furrow_lineage::batch::{Memo, Quantisation};
use furrow_measured::significance::chi_squared_tail;
use rand_mt::Mt64;

use super::fit_test::fit_test;
use super::free::Free;
use super::observations::Observation;
use super::posterior::{log_density_of, posterior};
use super::tests::{SETS, agrees, coarse, synthetic};
use super::*;
use crate::ensemble::{normal, uniform};
use crate::fit::chain::{Kin, Model};
use crate::sample::seed_of;
use crate::tempering::sample;

/// Cells and errors of the synthetic embryos.
const CELLS: [&str; 2] = ["P0", "P1"];
const SD: f64 = 0.03;
const EMBRYOS: usize = 3;
/// Points of each sample: with 200 places for the truth among them, 180 are inside the 90 % interval.
const POINTS: usize = 199;

/// χ of a hypothesis's cells at a place of the unit cube.
fn chi_at(model: &Model<'_>, place: &[f64]) -> Vec<Option<f64>> {
    let cells = CELLS.map(str::to_owned);
    model.chi(&model.values(place), &cells)
}

fn observed(random: &mut Mt64, truth: &[f64]) -> Observations {
    let observations = synthetic(random, EMBRYOS, truth, SD);
    Observations { cells: CELLS.map(str::to_owned).to_vec(), ..observations }
}

/// Calls `then` with each hypothesis and its model.
fn with_hypotheses(cues: &[&str], free: &[&str], then: impl FnOnce(&[Hypothesis], &[Model<'_>], &FitRun<'_>, &Memo)) {
    let (lineage, settings, cancel) = (Lineage::c_elegans().unwrap(), coarse(), false.into());
    let memo = Memo::new(Quantisation::EXACT);
    let texts = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
    let free = Free::list(&texts(free), &lineage, "--free").unwrap();
    let named = Named::list(&texts(cues), "--cue").unwrap();
    let hypotheses = Hypothesis::all(&named, Some(&free), &lineage, &settings.cell, ["--cue", "--free"]).unwrap();
    let run = FitRun::new(&lineage, &settings, 0, &cancel);
    let of = |hypothesis: &'_ Hypothesis| -> (Cue, Kin) {
        (hypothesis.template.clone(), Kin::of(&hypothesis.lineage, CELLS))
    };
    let parts: Vec<(Cue, Kin)> = hypotheses.iter().map(of).collect();
    let models: Vec<Model<'_>> = hypotheses
        .iter()
        .zip(&parts)
        .map(|(hypothesis, (template, kin))| Model {
            run: FitRun { lineage: &hypothesis.lineage, ..run },
            template,
            unknowns: hypothesis.unknowns.clone(),
            kin: kin.clone(),
            memo: Some(&memo),
        })
        .collect();
    then(&hypotheses, &models, &run, &memo);
}

/// χ of the cells over one or two free numbers, at evenly spaced places of the unit cube and straight between them: 200 posteriors ask
/// for χ a million times.
struct Tabulated {
    nodes: usize,
    chi: Vec<Vec<Option<f64>>>,
}

impl Tabulated {
    fn of(model: &Model<'_>, nodes: usize) -> Tabulated {
        let dimensions = model.unknowns.len();
        let place = |k: usize| -> Vec<f64> {
            (0..dimensions).map(|d| (k / nodes.pow(d as u32) % nodes) as f64 / (nodes - 1) as f64).collect()
        };
        Tabulated { nodes, chi: scheduler::in_parallel(nodes.pow(dimensions as u32), |k| chi_at(model, &place(k))) }
    }

    /// χ of each cell. Where a cell rests at one of the places around, the nearest place decides.
    fn at(&self, place: &[f64]) -> Vec<Option<f64>> {
        let last = self.nodes - 1;
        let (mut corners, mut stride) = (vec![(0, 1.0)], 1);
        for x in place {
            let low = ((x * last as f64) as usize).min(last - 1);
            let share = x * last as f64 - low as f64;
            let (below, above) = (low * stride, (low + 1) * stride);
            let both =
                |&(at, weight): &(usize, f64)| [(at + below, weight * (1.0 - share)), (at + above, weight * share)];
            corners = corners.iter().flat_map(both).collect();
            stride *= self.nodes;
        }
        let of = |cell: usize| {
            let all = corners.iter().map(|(at, weight)| Some(weight * self.chi[*at][cell]?));
            let nearest = || self.chi[corners.iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0][cell];
            all.sum::<Option<f64>>().or_else(nearest)
        };
        (0..CELLS.len()).map(of).collect()
    }

    /// χ at a place where all cells divide.
    fn divided(&self, place: &[f64]) -> Option<Vec<f64>> {
        self.at(place).into_iter().collect()
    }
}

/// The rank of the true number among the points of its posterior is even (χ² at 1 %), and 90 % intervals hold it in 90 ± 4 % of 200
/// synthetic sets of embryos; the truth is drawn from the prior. Each set has two free numbers.
#[test]
#[ignore = "takes minutes"]
fn ranks_of_true_numbers_are_even_with_divisions() {
    with_hypotheses(&["germline"], &["cue.amplitude", "epsilon=0.8..0.9"], |hypotheses, models, _, _| {
        let (tabulated, names) = (Tabulated::of(&models[0], 17), &hypotheses[0].unknowns);
        let (mut bins, mut covered) = ([[0usize; 10]; 2], [0usize; 2]);
        for set in 0..SETS as u64 {
            let mut random = Mt64::new(seed_of(b"true numbers", 11, set));
            // Cells that rest have no χ to observe.
            let (truth, chi) = loop {
                let place = [uniform(&mut random), uniform(&mut random)];
                if let Some(chi) = tabulated.divided(&place) {
                    break (place, chi);
                }
            };
            let observations = observed(&mut random, &chi);
            let noise = Noise::of(&observations, None, false, ("t.csv", "--noise")).unwrap();
            let likelihood = |place: &[f64]| {
                let chi = tabulated.at(place);
                Some((log_density_of(&observations.rows, &chi, &noise), ()))
            };
            let found = sample(2, Sampling { particles: POINTS, seed: set }, &likelihood).unwrap();
            for k in 0..2 {
                let rank = found.particles.iter().filter(|particle| particle.place[k] < truth[k]).count();
                bins[k][rank / 20] += 1;
                covered[k] += usize::from((10..=189).contains(&rank));
            }
        }
        let expected = SETS as f64 / 10.0;
        for k in 0..2 {
            let chi_squared: f64 = bins[k].iter().map(|n| (*n as f64 - expected).powi(2) / expected).sum();
            let share = covered[k] as f64 / SETS as f64;
            println!("{}: ranks {:?}, χ² {chi_squared:.1} on 9, covered {share}", names[k].name(), bins[k]);
            // χ² with 9 degrees of freedom exceeds 21.67 in 1 % of the cases.
            assert!(chi_squared < 21.67 && (share - 0.9).abs() <= 0.04, "{k}: {bins:?} {covered:?}");
        }
    });
}

/// The right cue, with its strength fitted, has p below 0.05 in one of twenty of 200 synthetic sets; a wrong one as often as χ² with the
/// deviation of its best fit to the truth.
#[test]
fn a_wrong_cue_is_rejected_and_the_right_one_kept_at_the_rates_of_p_with_divisions() {
    let cues = ["right=germline", "wrong=tension:gradient,amplitude=-0.3"];
    with_hypotheses(&cues, &["cue.amplitude"], |_, models, _, _| {
        let tabulated = [0, 1].map(|k| Tabulated::of(&models[k], 65));
        let truth = tabulated[0].divided(&[0.5]).unwrap();
        // χ² of the best strength, and its degrees of freedom and p.
        let tested = |observations: &Observations, k: usize| {
            let noise = Noise::of(observations, None, false, ("t.csv", "--noise")).unwrap();
            let fits = (0..=2000).filter_map(|j| {
                let chi = tabulated[k].at(&[f64::from(j) / 2000.0]);
                match fit_test(observations, &noise, &chi, 1)? {
                    FitTest::ChiSquared { statistic, degrees_of_freedom, p } => {
                        Some((statistic, degrees_of_freedom, p?))
                    }
                    FitTest::LackOfFit { .. } => None,
                }
            });
            fits.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };
        let noiseless = observed(&mut Mt64::new(1), &truth);
        let rows = noiseless.rows.iter().map(|row| Observation { chi: truth[row.cell], ..row.clone() }).collect();
        let (shift, freedom, _) = tested(&Observations { rows, ..noiseless }, 1);
        let mut random = Mt64::new(5);
        let draws = 20_000;
        let above = (0..draws).filter(|_| {
            let first = normal(&mut random) + shift.sqrt();
            let others: f64 = (1..freedom).map(|_| normal(&mut random).powi(2)).sum();
            chi_squared_tail(first * first + others, freedom).unwrap() < 0.05
        });
        let power = above.count() as f64 / f64::from(draws);
        let mut rejected = [0; 2];
        for set in 0..SETS as u64 {
            let observations = observed(&mut Mt64::new(seed_of(b"cues", 3, set)), &truth);
            for (k, rejected) in rejected.iter_mut().enumerate() {
                *rejected += usize::from(tested(&observations, k).2 < 0.05);
            }
        }
        println!("right rejected {} of {SETS}, wrong {} of {SETS}, expected {power:.3}", rejected[0], rejected[1]);
        assert!(agrees(rejected[0], 0.05) && agrees(rejected[1], power), "{rejected:?} {power}");
        assert!(power > 0.3, "{power}: the wrong cue should be told apart at times");
    });
}

/// ε varies between embryos: the sample finds the mean, the standard deviation and ε of each embryo.
#[test]
#[ignore = "takes minutes"]
fn a_number_that_differs_between_embryos_is_found() {
    with_hypotheses(&["germline"], &["epsilon@embryo=0.8..0.92"], |hypotheses, models, _, memo| {
        let (model, mut random) = (&models[0], Mt64::new(8));
        assert!(hypotheses[0].is_by_embryo());
        let (centre, scatter) = (0.5, 0.15);
        let places: Vec<f64> = (0..10).map(|_| centre + scatter * normal(&mut random)).collect();
        let truth: Vec<Vec<f64>> =
            places.iter().map(|place| chi_at(model, &[*place]).into_iter().map(Option::unwrap).collect()).collect();
        let start = synthetic(&mut random, places.len(), &truth[0], 0.005);
        let of = |row: &Observation| Observation {
            chi: row.chi - truth[0][row.cell] + truth[row.unit][row.cell],
            ..row.clone()
        };
        let rows = start.rows.iter().map(of).collect();
        let observations = Observations { cells: CELLS.map(str::to_owned).to_vec(), rows, ..start };
        let noise = Noise::of(&observations, None, false, ("t.csv", "--noise")).unwrap();
        let sampling = Sampling { particles: 40, seed: 2 };
        let question = Question {
            observations: &observations,
            hypotheses,
            noise: &noise,
            effort: Effort::default(),
            sampling: Some(sampling),
            memo,
        };
        question.check("--free").unwrap();
        let found = posterior(&question, (model, hypotheses[0].by_embryo), sampling).unwrap();
        let [common, spread] = &found.parameters[..] else { panic!("{found:?}") };
        assert_eq!((common.name.as_str(), spread.name.as_str()), ("epsilon", "epsilon@embryo"));
        // Quantiles of the number and its scatter, in the unit of ε: a share of the range of 0.12.
        assert!((common.mean - (0.8 + 0.12 * centre)).abs() < 3.0 * 0.12 * scatter / 10f64.sqrt(), "{common:?}");
        assert!((0.4..2.0).contains(&(spread.mean / (0.12 * scatter))), "{spread:?}");
        let off = |(embryo, place): (&EmbryoNumber, &f64)| {
            (embryo.mean - (0.8 + 0.12 * place)).abs() / (0.003 + 3.0 * embryo.sd)
        };
        assert!(found.embryos.iter().zip(&places).map(off).all(|off| off < 1.0), "{:?} {places:?}", found.embryos);
        let without = Question { sampling: None, ..question };
        let refusal = without.check("--free").unwrap_err().to_string();
        assert_eq!(refusal, "--free: free = @embryo: must be used with a sample of the posterior: give samples");
    });
}
