//! Shell constants from thresholds.

use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::calibration::{Targets, Threshold, Unknown, calibrate, sensitivity};
use furrow_mechanics::equilibria::{BranchOptions, Pitchfork, pitchfork};

fn numerics() -> Numerics {
    Numerics { intervals: 32, ..Numerics::default() }
}

fn first(cell: &Cell) -> Pitchfork {
    pitchfork::first(cell, &numerics(), &BranchOptions::default()).unwrap()
}

fn threshold(r0: f64, epsilon: f64) -> Threshold {
    Threshold {
        r0,
        epsilon,
        xi_s: first(&Cell { epsilon, ..Cell::gao2026_thresholds(r0) }).point.xi_s,
        weight: None,
        tolerance: 0.003,
    }
}

fn unknown(parameter: Parameter, start: f64) -> Unknown {
    Unknown { parameter, start: Some(start) }
}

const CELLS: [(f64, f64); 6] = [(1.64, 0.87), (2.0, 0.87), (2.22, 0.64), (2.22, 0.88), (3.0, 0.87), (2.22, 0.8)];

/// Started from a/b = 1.3, P0 = 0.1, w = 0.14, g = 0.5, the search returns to the constants the thresholds come from,
/// whether there are as many thresholds as constants or more.
#[test]
fn round_trip_to_the_preset() {
    let preset = Cell::gao2026_thresholds(1.0);
    let thresholds: Vec<Threshold> = CELLS.iter().map(|&(r0, epsilon)| threshold(r0, epsilon)).collect();
    for count in [4, 6] {
        let targets = Targets {
            unknowns: vec![
                unknown(Parameter::Aspect, 1.3),
                unknown(Parameter::P0, 0.1),
                unknown(Parameter::W, 0.14),
                unknown(Parameter::Gain, 0.5),
            ],
            thresholds: thresholds[..count].to_vec(),
            ..Targets::default()
        };
        let found = calibrate(&targets, &preset, &numerics()).unwrap();
        for (parameter, value) in &found.parameters {
            let exact = parameter.get(&preset);
            assert!((value / exact - 1.0).abs() < 1e-6, "{parameter:?}: {value} against {exact} from {count}");
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
        .map(|(&(r0, epsilon), xi_s)| Threshold { r0, epsilon, xi_s, weight: None, tolerance: 0.003 })
        .collect();
    let rms = |list: &[Threshold]| {
        let sum: f64 = list.iter().map(|t| (threshold(t.r0, t.epsilon).xi_s / t.xi_s - 1.0).powi(2)).sum();
        (sum / list.len() as f64).sqrt()
    };
    let preset = rms(&thresholds);
    let shell = vec![unknown(Parameter::Aspect, 1.3), unknown(Parameter::P0, 0.1), unknown(Parameter::W, 0.14)];
    let mut all = shell.clone();
    all.push(unknown(Parameter::Gain, 0.5));
    for unknowns in [shell, all] {
        let targets = Targets { unknowns, thresholds: thresholds.clone(), ..Targets::default() };
        let found = calibrate(&targets, &Cell::gao2026_thresholds(1.0), &numerics()).unwrap();
        assert!(found.rms <= preset, "{} against {preset}", found.rms);
    }
}

/// Sensitivities against differences of thresholds.
#[test]
fn sensitivities_are_exact() {
    let cell = Cell { epsilon: 0.8, ..Cell::gao2026_thresholds(2.22) };
    let at = first(&cell);
    for parameter in
        [Parameter::Aspect, Parameter::P0, Parameter::W, Parameter::Gain, Parameter::Kappa, Parameter::XiRatio]
    {
        let slope = sensitivity(&cell, &at.shape, parameter).unwrap();
        let value = parameter.get(&cell);
        let h = 1e-4 * value.abs();
        let shifted = |by: f64| {
            let mut moved = cell.clone();
            parameter.set(&mut moved, value + by);
            first(&moved).point.xi_s
        };
        let difference = (shifted(h) - shifted(-h)) / (2.0 * h);
        assert!((slope - difference).abs() < 1e-5 * slope.abs(), "{parameter:?}: {slope} {difference}");
        if parameter == Parameter::Gain {
            assert!((slope + at.point.xi_s / value).abs() < 1e-7 * slope.abs());
        }
    }
}

/// κ, P0 and g enter only through their ratios: one combination of the three stays open, and the search says which.
#[test]
fn what_the_thresholds_leave_open() {
    let targets = Targets {
        unknowns: vec![unknown(Parameter::Kappa, 1.1), unknown(Parameter::P0, 0.12), unknown(Parameter::Gain, 0.5)],
        thresholds: CELLS[..4].iter().map(|&(r0, epsilon)| threshold(r0, epsilon)).collect(),
        ..Targets::default()
    };
    let found = calibrate(&targets, &Cell::gao2026_thresholds(1.0), &numerics()).unwrap();
    assert!(found.rms < 1e-9);
    let open: Vec<_> = found.combinations.iter().filter(|c| !c.determined).collect();
    assert_eq!(open.len(), 1);
    for component in &open[0].components {
        assert!((component - 3f64.sqrt().recip()).abs() < 1e-5, "{:?}", open[0]);
    }
    let value = |k: usize| found.parameters[k].1;
    assert!((value(1) / value(0) / 0.123 - 1.0).abs() < 1e-7 && (value(2) / value(0) / 0.5 - 1.0).abs() < 1e-7);
}
