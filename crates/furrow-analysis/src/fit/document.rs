//! What fits found, as JSON and as configuration files.

use serde_json::{Map, Value, json};

use super::{Evaluated, FittedConstants, Targets};

impl FittedConstants {
    /// As `furrow fit constants --json` prints it.
    pub fn document(&self, targets: &Targets) -> Value {
        let sharpness = self.sharpness.iter().zip(&self.plateau).map(|(sharp, (_, plateau))| {
            let mut row = json!(sharp);
            row["plateau"] = json!(plateau);
            row
        });
        let constants =
            self.best.constants.iter().map(|(parameter, value)| (parameter.to_string(), Value::from(*value)));
        json!({
            "constants": constants.collect::<Map<_, _>>(),
            "misfit": self.best.misfit,
            "residuals": residuals(&self.best, targets),
            "at_limit": self.at_limit,
            "best": self.best,
            "start": self.start,
            "front": self.front,
            "sharpness": sharpness.collect::<Vec<_>>(),
            "tried": self.tried,
        })
    }
}

/// Numbers of the model beside the observed ones.
fn residuals(best: &Evaluated, targets: &Targets) -> Vec<Value> {
    let residual = |founder: &str, quantity: &str, observed: f64, computed: Option<f64>| -> Value {
        json!({ "founder": founder, "quantity": quantity, "observed": observed, "computed": computed })
    };
    let mut out = Vec::new();
    for founder in best.founders.iter().filter(|founder| targets.founders.contains(&founder.name)) {
        let mean = founder.observed_mean.unwrap_or(f64::NAN);
        out.push(residual(&founder.name, "mean_rounds", mean, founder.rounds.map(|r| r.mean)));
        let (observed, computed) = (founder.observed_terminal.unwrap_or(0), founder.rounds.map(|r| r.terminal.into()));
        out.push(residual(&founder.name, "terminal_cells", observed.into(), computed));
    }
    for chi in &targets.chi {
        let computed = best.founders.iter().find(|founder| founder.name == chi.cell).and_then(|founder| founder.chi);
        out.push(residual(&chi.cell, "chi", chi.mean, computed));
    }
    out
}

impl Evaluated {
    /// Its constants as a configuration file.
    pub fn as_ron(&self) -> String {
        let lines: String = self.constants.iter().map(|(p, value)| format!("        {p}: {value},\n")).collect();
        format!("// Found by furrow fit constants.\nConfig(\n    physics: (\n{lines}    ),\n)\n")
    }
}
