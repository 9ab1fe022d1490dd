//! Compares stationary shapes with those of `scipy.integrate.solve_bvp` (`peer.py`), whose solver and equations share nothing
//! with these. Ignored, since it needs SciPy; `.ci/run` runs it where SciPy is there. `FURROW_PYTHON` names the Python.

use std::io::Write;
use std::process::{Command, Stdio};

use furrow_cell::Cell;
use furrow_mechanics::cortex::equations::{M, PSI, Q, R, T, V, Z};
use furrow_verification::contour::Computed;
use furrow_verification::report::within;
use furrow_verification::states::{resting, uneven_cell};
use serde_json::{Map, Value, json};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peer.py");

/// Names of the components in the exchanged file.
const NAMES: [(&str, usize); 7] = [("r", R), ("z", Z), ("psi", PSI), ("m", M), ("q", Q), ("v", V), ("t", T)];

fn python() -> String {
    std::env::var("FURROW_PYTHON").unwrap_or_else(|_| "python3".to_owned())
}

/// A cell and its shape at the nodes, as the peer reads them.
fn question(state: &Computed) -> Value {
    let nodes = |component: usize| -> Vec<f64> {
        (0..=state.shape.intervals()).map(|i| state.shape.node(i)[component]).collect()
    };
    let shape: Map<String, Value> =
        NAMES.map(|(name, component)| (name.to_owned(), nodes(component).into())).into_iter().collect();
    json!({"cell": state.cell, "length": state.length(), "pressure": state.pressure(), "u": state.shape.mesh, "shape": shape})
}

/// The answer of a script to a question.
pub fn ask(script: &str, question: &Value) -> Value {
    let mut command = Command::new(python());
    let mut child = command
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("Python starts");
    child.stdin.take().unwrap().write_all(question.to_string().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The numbers of a list.
fn numbers(list: &Value) -> impl Iterator<Item = f64> {
    list.as_array().unwrap().iter().map(|number| number.as_f64().unwrap())
}

/// Cells with the preset's and with other constants, with and without a cue like the germline's.
#[test]
#[ignore = "needs Python with SciPy"]
fn shapes_at_rest_are_those_of_another_solver() {
    let band = "kappa:band,u0=0.465,omega=0.1,amplitude=0.1";
    let cells = [
        Cell { xi_s: 10.0, ..Cell::gao2026_thresholds(2.0) },
        Cell { xi_s: 8.0, epsilon: 0.7, ..Cell::gao2026_thresholds(1.5) },
        Cell { xi_s: 9.0, ..Cell::gao2026_thresholds(2.0).with_cue(band.parse().unwrap()) },
        uneven_cell(2.0, 9.0, band).unwrap(),
    ];
    for cell in cells {
        let state = resting(&cell).unwrap();
        let name = format!("R0 = {}, ξ_s = {}, {}", cell.r0, cell.xi_s, cell.cue);
        let answer = ask(SCRIPT, &question(&state));
        let off = |key: &str, here: f64| (answer[key].as_f64().unwrap() - here).abs();
        let mut largest = off("length", state.length()).max(off("pressure", state.pressure()));
        // The shell fixes the position along the axis, so z is comparable too.
        for (component, index) in NAMES {
            for (u, found) in numbers(&answer["u"]).zip(numbers(&answer["shape"][component])) {
                let i = state.shape.mesh.partition_point(|node| *node < u);
                let here = state.shape.node(i)[index];
                largest = largest.max((found - here).abs() / (1.0 + here.abs()));
            }
        }
        println!("{name}: solve_bvp takes {} nodes", answer["nodes"]);
        within(&format!("{name}: solve_bvp"), largest, 1e-5);
    }
}
