//! How much data and numbers count: sizes of cells, given errors, numbers without effect, data beside χ.

use super::noise::aicc;
use super::scores::own_deviance;
use super::tests::{coarse, left_out, noise_of, table, tested};
use super::*;
use crate::fit::ChiResidual;
use crate::fit::chain::{Kin, Model};
use furrow_lineage::Lineage;

/// Only one embryo has a division of P2. The scores do not depend on the unit of volumes. NumPy gives the same scores for errors by F.10
/// with the sizes of all rows.
#[test]
fn a_cell_of_one_embryo_keeps_her_size_in_any_unit() {
    let rows = [
        ("e1,P0,0.18", 24000.0),
        ("e1,P1,0.10", 9840.0),
        ("e2,P0,0.20", 24000.0),
        ("e2,P1,0.15", 9600.0),
        ("e3,P0,0.17", 24000.0),
        ("e3,P1,0.13", 9960.0),
        ("e4,P0,0.19", 24000.0),
        ("e4,P1,0.17", 9720.0),
        ("e4,P2,0.15", 4033.8),
    ];
    let chi = [0.18477223510466567, 0.12697773999919504, 0.10932026915253057].map(Some);
    let expected = [5.2971134172889744, 4.742010728192969, 4.995380839041763, 6.28902482525559];
    for unit in [1.0, 0.03, 1.0 / 24000.0] {
        let text: String = rows.iter().map(|(row, volume)| format!("{row},{}\n", volume * unit)).collect();
        let observations = table(&format!("embryo,mother,chi,mother_um3\n{text}"));
        let noise = noise_of(&observations, NoiseKind::Replicates);
        assert!((noise.exponent - 0.93409).abs() < 1e-5, "{noise:?}");
        for (part, expected) in expected.into_iter().enumerate() {
            let found = left_out(&observations, &noise, part, &chi);
            assert!((found - expected).abs() < 1e-4, "{unit} {part}: {found}");
        }
    }
    // Replicates of one size alone do not determine how errors grow.
    let one = table("embryo,mother,chi,mother_um3\na,P0,0.18,100\nb,P0,0.20,110\na,P1,0.1,40\n");
    assert_eq!(noise_of(&one, NoiseKind::Replicates).exponent, 0.0);
}

/// With given errors of ±0.1, ±0.001 and ±0.1 the mean is weighted.
#[test]
fn means_are_weighted_by_the_errors_of_the_table() {
    let observations = table("embryo,mother,chi,chi_sd\ne1,P0,0.30,0.10\ne2,P0,0.19,0.001\ne3,P0,0.10,0.10\n");
    let found = tested(&observations, None, &["none"], "none", 1);
    let CellScore { measured, interval: Some([low, high]), .. } = found.hypotheses[0].cells[0] else { panic!() };
    let (mean, error) = (0.19000199960008, 0.0009999000149975004);
    assert!((measured - mean).abs() < 1e-12 && (0.5 * (low + high) - mean).abs() < 1e-12, "{measured}");
    assert!((high - low - 2.0 * 1.959_963_984_540_054 * error).abs() < 1e-12, "{low} {high}");
}

#[test]
fn a_number_without_effect_is_not_counted() {
    let observations =
        table("embryo,mother,chi,chi_sd\na,P0,0.17,0.02\na,P1,0.13,0.02\nb,P0,0.21,0.02\nb,P1,0.09,0.02\n");
    let cue = ["tension:gradient,amplitude=-0.1"];
    let [alone, beside] =
        ["cue.amplitude", "cue.amplitude,epsilon@somatic"].map(|free| tested(&observations, None, &cue, free, 1));
    let [alone, beside] = [&alone, &beside].map(|found| &found.hypotheses[0]);
    assert!(beside.parameters[1].without_effect && alone.k == 1 && beside.k == 1, "{beside:?}");
    let Some(FitTest::ChiSquared { degrees_of_freedom: 3, .. }) = beside.fit else { panic!("{beside:?}") };
    assert_eq!(beside.aicc, aicc(beside.log_likelihood, 1, 4));
}

/// The measured AB divides about equally, as in the model; P0 does not.
#[test]
fn cells_are_named_in_which_errors_look_like_a_cue() {
    let text = "embryo,mother,chi\na,P0,0.17\na,AB,0.01\nb,P0,0.19\nb,AB,0.03\n";
    let found = tested(&table(text), None, &["none"], "none", 1);
    assert_eq!(found.near_zero, ["AB"]);
}

/// Beside rounds a fit is searched by −2 ln L = n (ln 2πσ² + 1) of χ, with the most likely σ of each candidate.
#[test]
fn a_common_error_beside_rounds_is_fitted_to_each_candidate() {
    let lineage = Lineage::c_elegans().unwrap();
    let alone = table("embryo,mother,chi\na,P0,0.1\nb,P0,0.2\na,P1,0.3\n");
    let rounds = Others::rounds(&lineage, 0.5, "--rounds").unwrap();
    let beside = Observations { others: vec![rounds], ..alone.clone() };
    let noise = noise_of(&alone, NoiseKind::Common);
    assert!(own_deviance(&alone, &alone.rows, &noise).is_none());
    let deviance = own_deviance(&beside, &beside.rows, &noise).unwrap();
    let of = |cell: &str, chi: f64| ChiResidual {
        cell: cell.to_owned(),
        r0: None,
        measured: 0.0,
        sd: 1.0,
        computed: Some(chi),
        residual: None,
        has_cue: false,
    };
    // Deviations of 0.05, 0.05 and 0.1.
    let expected = 3.0 * ((std::f64::consts::TAU * 0.005).ln() + 1.0);
    let found = deviance(&[of("P0", 0.15), of("P1", 0.2)]);
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

#[test]
fn a_band_has_a_mirror_image_where_its_place_is_free() {
    let (lineage, settings, cancel) = (Lineage::c_elegans().unwrap(), coarse(), false.into());
    let image = |cue: &str, free: &str, value: f64| {
        let free: Vec<String> = free.split(',').map(str::to_owned).collect();
        let free = free::Free::list(&free, &lineage, "--free").unwrap();
        let named = Named::list(&[cue.to_owned()], "--cue").unwrap();
        let all = Hypothesis::all(&named, Some(&free), &lineage, &settings.cell, ["--cue", "--free"]).unwrap();
        let Hypothesis { template, unknowns, .. } = &all[0];
        let (run, kin) = (FitRun::new(&lineage, &settings, 1, &cancel), Kin::default());
        let model = Model { run, template, unknowns: unknowns.clone(), kin, memo: None };
        model.mirror_image(&[value])
    };
    let band = "kappa:band,u0=0.25,omega=0.0577,amplitude=0.1";
    assert_eq!(image(band, "cue.u0", 0.25).unwrap(), "kappa:band,u0=0.75,omega=0.0577,amplitude=0.1");
    assert_eq!(image(band, "cue.amplitude", 0.1), None);
    assert_eq!(image(band, "cue.u0=0.1..0.5", 0.25), None);
    assert_eq!(image("kappa:step,u0=0.465,omega=0.0577,amplitude=0.1", "cue.u0", 0.25), None);
}
