//! Shell constants from thresholds.

use furrow::calibration::{Targets, Threshold, Unknown, calibrate, sensitivity};
use furrow::cortex::{Cue, Numerics, Parameter, Physics};
use furrow::shapes::symmetric::{BranchOptions, first_pitchfork};

fn numerics() -> Numerics {
    Numerics { intervals: 32, ..Numerics::default() }
}

fn threshold(physics: &Physics, r0: f64, epsilon: f64) -> Threshold {
    let physics = Physics { epsilon, ..*physics };
    let found = first_pitchfork(&physics, &numerics(), r0, &BranchOptions::default()).unwrap();
    Threshold { r0, epsilon, xi_s: found.point.xi_s, weight: 1.0 }
}

fn unknown(parameter: Parameter, start: f64) -> Unknown {
    Unknown { parameter, start: Some(start) }
}

const CELLS: [(f64, f64); 6] = [(1.64, 0.87), (2.0, 0.87), (2.22, 0.64), (2.22, 0.88), (3.0, 0.87), (2.22, 0.8)];

/// Started from a/b = 1.3, P0 = 0.1, w = 0.14, g = 0.5, the search returns to the constants the thresholds come from,
/// whether there are as many thresholds as constants or more.
#[test]
fn round_trip_to_the_preset() {
    let preset = Physics::GAO2026;
    let thresholds: Vec<Threshold> = CELLS.iter().map(|&(r0, epsilon)| threshold(&preset, r0, epsilon)).collect();
    for count in [4, 6] {
        let targets = Targets {
            unknowns: vec![
                unknown(Parameter::Aspect, 1.3),
                unknown(Parameter::P0, 0.1),
                unknown(Parameter::W, 0.14),
                unknown(Parameter::Gain, 0.5),
            ],
            thresholds: thresholds[..count].to_vec(),
        };
        let found = calibrate(&targets, &preset, &numerics()).unwrap();
        for (control, value) in &found.parameters {
            let exact = control.get(&preset, 1.0, &Cue::None);
            assert!((value / exact - 1.0).abs() < 1e-6, "{control:?}: {value} against {exact} from {count}");
        }
        assert!(found.combinations.iter().all(|c| c.determined));
    }
}

/// The paper's four thresholds are fitted at least as well as by the preset.
#[test]
fn the_papers_thresholds() {
    let published = [25.796, 22.006, 6.24, 21.94];
    let thresholds: Vec<Threshold> = CELLS
        .iter()
        .zip(published)
        .map(|(&(r0, epsilon), xi_s)| Threshold { r0, epsilon, xi_s, weight: 1.0 })
        .collect();
    let rms = |list: &[Threshold]| {
        let sum: f64 =
            list.iter().map(|t| (threshold(&Physics::GAO2026, t.r0, t.epsilon).xi_s / t.xi_s - 1.0).powi(2)).sum();
        (sum / list.len() as f64).sqrt()
    };
    let preset = rms(&thresholds);
    let shell = vec![unknown(Parameter::Aspect, 1.3), unknown(Parameter::P0, 0.1), unknown(Parameter::W, 0.14)];
    let mut all = shell.clone();
    all.push(unknown(Parameter::Gain, 0.5));
    for unknowns in [shell, all] {
        let targets = Targets { unknowns, thresholds: thresholds.clone() };
        let found = calibrate(&targets, &Physics::GAO2026, &numerics()).unwrap();
        assert!(found.rms <= preset, "{} against {preset}", found.rms);
    }
}

/// Sensitivities against differences of thresholds.
#[test]
fn sensitivities_are_exact() {
    let physics = Physics { epsilon: 0.8, ..Physics::GAO2026 };
    let at = first_pitchfork(&physics, &numerics(), 2.22, &BranchOptions::default()).unwrap();
    for control in
        [Parameter::Aspect, Parameter::P0, Parameter::W, Parameter::Gain, Parameter::Kappa, Parameter::XiRatio]
    {
        let slope = sensitivity(&physics, 2.22, &at.shape, control).unwrap();
        let value = control.get(&physics, 2.22, &Cue::None);
        let h = 1e-4 * value.abs();
        let shifted = |by: f64| {
            let mut p = physics;
            control.set(value + by, &mut p, &mut 1.0, &mut Cue::None);
            first_pitchfork(&p, &numerics(), 2.22, &BranchOptions::default()).unwrap().point.xi_s
        };
        let difference = (shifted(h) - shifted(-h)) / (2.0 * h);
        assert!((slope - difference).abs() < 1e-5 * slope.abs(), "{control:?}: {slope} {difference}");
        if control == Parameter::Gain {
            assert!((slope + at.point.xi_s / value).abs() < 1e-7 * slope.abs());
        }
    }
}

/// κ, P0 and g enter only through their ratios: one combination of the three stays open, and the search says which.
#[test]
fn what_the_thresholds_leave_open() {
    let targets = Targets {
        unknowns: vec![unknown(Parameter::Kappa, 1.1), unknown(Parameter::P0, 0.12), unknown(Parameter::Gain, 0.5)],
        thresholds: CELLS[..4].iter().map(|&(r0, epsilon)| threshold(&Physics::GAO2026, r0, epsilon)).collect(),
    };
    let found = calibrate(&targets, &Physics::GAO2026, &numerics()).unwrap();
    assert!(found.rms < 1e-9);
    let open: Vec<_> = found.combinations.iter().filter(|c| !c.determined).collect();
    assert_eq!(open.len(), 1);
    for component in &open[0].components {
        assert!((component - 3f64.sqrt().recip()).abs() < 1e-5, "{:?}", open[0]);
    }
    let value = |k: usize| found.parameters[k].1;
    assert!((value(1) / value(0) / 0.123 - 1.0).abs() < 1e-7 && (value(2) / value(0) / 0.5 - 1.0).abs() < 1e-7);
}
