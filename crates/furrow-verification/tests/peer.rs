//! Compares stationary shapes with those of `scipy.integrate.solve_bvp` (`peer.py`), whose solver and equations share nothing
//! with these. Skipped without SciPy, unless `FURROW_PYTHON` names an interpreter: then a missing SciPy is a failure.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use furrow_cell::Cell;
use furrow_cell::cue::Quantity;
use furrow_mechanics::cortex::equations::{M, PSI, Q, R, T, V, Z};
use furrow_verification::contour::Computed;
use furrow_verification::report::within;
use furrow_verification::states::{resting, uneven_cell};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peer.py");

/// Names of the components in the exchanged file.
const NAMES: [(&str, usize); 7] = [("r", R), ("z", Z), ("psi", PSI), ("m", M), ("q", Q), ("v", V), ("t", T)];

fn python() -> String {
    std::env::var("FURROW_PYTHON").unwrap_or_else(|_| "python3".to_owned())
}

/// Why SciPy is not available, if it is not.
fn missing() -> Option<String> {
    match Command::new(python()).args([SCRIPT, "--installed"]).output() {
        Ok(output) if output.status.success() => None,
        Ok(output) => Some(String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or("").to_owned()),
        Err(error) => Some(format!("{}: {error}", python())),
    }
}

/// A cell and its shape at the nodes, as the peer reads them.
fn question(state: &Computed) -> String {
    let cell = &state.cell;
    let (material, shell) = (&cell.material, &cell.shell);
    let term = cell.cue.terms().first();
    let cue = |quantity| term.and_then(|term| term.quantity(quantity));
    let scalars = [
        ("kappa", material.kappa),
        ("eta_b", material.eta_b),
        ("eta_s", material.eta_s),
        ("friction", material.friction),
        ("tension", material.tension),
        ("gain", material.gain),
        ("xi_ratio", material.xi_ratio),
        ("xi_s", cell.xi_s),
        ("r0", cell.r0),
        ("epsilon", cell.epsilon),
        ("aspect", shell.aspect),
        ("p0", shell.p0),
        ("w", shell.w),
        ("amplitude", cue(Quantity::Amplitude).unwrap_or(0.0)),
        ("u0", cue(Quantity::U0).unwrap_or(0.5)),
        ("omega", cue(Quantity::Omega).unwrap_or(1.0)),
        ("length", state.length()),
        ("pressure", state.pressure()),
    ];
    let mut out = String::new();
    for (name, value) in scalars {
        writeln!(out, "{name} {value:?}").unwrap();
    }
    let row = |values: Vec<f64>| values.iter().map(|v| format!(" {v:?}")).collect::<String>();
    writeln!(out, "u{}", row(state.shape.mesh.clone())).unwrap();
    for (name, component) in NAMES {
        let values = (0..=state.shape.intervals()).map(|i| state.shape.node(i)[component]).collect();
        writeln!(out, "{name}{}", row(values)).unwrap();
    }
    out
}

fn ask(question: &str) -> HashMap<String, Vec<f64>> {
    let mut child = Command::new(python())
        .arg(SCRIPT)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(question.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer = String::from_utf8(output.stdout).unwrap();
    let line = |line: &str| {
        let mut words = line.split_whitespace();
        (words.next().unwrap().to_owned(), words.map(|word| word.parse().unwrap()).collect())
    };
    answer.lines().map(line).collect()
}

/// Cells with the preset's and with other constants, with and without a cue like the germline's.
#[test]
fn shapes_at_rest_are_those_of_another_solver() {
    if let Some(reason) = missing() {
        assert!(std::env::var_os("FURROW_PYTHON").is_none(), "solve_bvp: {reason}");
        println!("solve_bvp is not asked: {reason}");
        return;
    }
    let band = "kappa:band,u0=0.465,omega=0.1,amplitude=0.1";
    let cells = [
        Cell { xi_s: 10.0, ..Cell::new(2.0) },
        Cell { xi_s: 8.0, epsilon: 0.7, ..Cell::new(1.5) },
        Cell { xi_s: 9.0, ..Cell::new(2.0).with_cue(band.parse().unwrap()) },
        uneven_cell(2.0, 9.0, band).unwrap(),
    ];
    for cell in cells {
        let state = resting(&cell).unwrap();
        let name = format!("R0 = {}, ξ_s = {}, {}", cell.r0, cell.xi_s, cell.cue);
        let answer = ask(&question(&state));
        let mut largest =
            (answer["length"][0] - state.length()).abs().max((answer["pressure"][0] - state.pressure()).abs());
        // The shell fixes the position along the axis, so z is comparable too.
        for (component, index) in NAMES {
            for (u, found) in answer["u"].iter().zip(&answer[component]) {
                let i = state.shape.mesh.partition_point(|node| node < u);
                let here = state.shape.node(i)[index];
                largest = largest.max((found - here).abs() / (1.0 + here.abs()));
            }
        }
        println!("{name}: solve_bvp takes {} nodes", answer["nodes"][0]);
        within(&format!("{name}: solve_bvp"), largest, 1e-5);
    }
}
