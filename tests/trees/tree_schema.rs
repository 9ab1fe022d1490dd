//! Written trees and the published JSON Schema of `tree.json`, `docs/tree.schema.json`, have the same fields. An independent
//! validator holds trees against the schema in `tests/command/exchange.py`.

use std::collections::{BTreeMap, BTreeSet};

use furrow_cell::Cell;
use furrow_formats::{TREE_SCHEMA, tree_from_json, tree_to_json};
use furrow_lineage::{Limits, Lineage, TerminalReason, TreeSettings};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome, SecondNeck};
use serde_json::Value;

use crate::common::stand_in::{division, fake, grow, grown};

/// A lineage in which every field is given.
const EVERYTHING: &str = r#"Lineage(
    name: "everything", citation: "nobody", naming: ('a', 'p'), units: (length_um: 3, time_min: 4),
    limits: (max_depth: 6, max_cells: 40), dies: ["L*lll", "nobody"],
    clock: (lifetime_min: 24, at_volume: 0.5, exponent: 0.28, volumes: (0.6, 1), tau_min: 4, origin: birth("S"), lifetimes: {"S": 20}),
    cues: {
        "kappa": "kappa:u0=0.4,omega=0.1,amplitude=0.1", "activity": "activity:step,u0=0.6,omega=0.3Lh,amplitude=0.1",
        "xi_s": "xi_s:gradient,amplitude=0.1", "xi_b": "xi_b:u0=0.4,omega=0.1,amplitude=0.1",
        "eta_b": "eta_b:step,u0=0.6,omega=0.3Lh,amplitude=0.1", "eta_s": "eta_s:gradient,amplitude=0.1",
        "viscosity": "viscosity:u0=0.4,omega=0.1,amplitude=0.1", "tension": "tension:gradient,amplitude=0.1",
        "friction": "friction:step,u0=0.6,omega=0.3Lh,amplitude=0.1",
        "sum": "kappa:u0=0.4,omega=0.1,amplitude=0.1+tension:gradient,amplitude=0.2",
        "carried": "regulator:u0=0.4,omega=0.1,amplitude=1,turnover=0.05/s,diffusion=0.1um2/s,activity=0.3",
        "saturating": "tension:gradient,amplitude=0.2+regulator:step,u0=0.4,omega=1um,amplitude=1,turnover=5,diffusion=1,diluted=false,kappa=0.3,tension=30,tension.half=10",
    },
    cue_rules: [(cue: "sum", from_generation: 1, to_generation: 9, below_r0: 9, above_r0: 0.1)],
    physics_rules: [(parameter: "xi_s", value: 25, factor: 0.97, add: 0.1, per: generation, to_generation: 9, below_r0: 99, above_r0: 0.1),
                    (parameter: "epsilon", from_mother: true, factor: 0.999)],
    founders: [
        (name: "S", cue: "kappa", inherit: false, r0: "17um",
         observed: (min: 1, mean: 2.5, max: 4, full_doublings: 1, terminal: 9, deaths: 1)),
        (name: "L", mother: "S", daughter: larger, r0: 5, letters: [('l', 'r')],
         clock: (lifetime_min: 30, at_volume: 0.5, exponent: 0.3),
         cue_rules: [(cue: "sum", from_generation: 1, to_generation: 9, below_r0: 9, above_r0: 0.1)],
         shell_profile: (name: "egg", aspect: 1.4, error: 0.001, series: [1]),
         physics: (xi_s: 26, xi_ratio: -0.1, gain: 0.5, epsilon: 0.86, aspect: 1.4, p0: 0.12, w: 0.14, shell_flattening: 0.9, kappa: 1, eta_b: 1,
                   eta_s: 1, friction: 1, tension: 0, spontaneous_curvature: 0.1, normal_friction: 0.1),
         physics_rules: [(parameter: "xi_ratio", add: 0.01), (parameter: "gain", value: 0.5), (parameter: "epsilon", add: -0.01),
                         (parameter: "aspect", value: 1.4), (parameter: "p0", value: 0.12), (parameter: "w", value: 0.14), (parameter: "shell_flattening", value: 0.9),
                         (parameter: "kappa", value: 1), (parameter: "eta_b", value: 1), (parameter: "eta_s", value: 1),
                         (parameter: "friction", value: 1), (parameter: "tension", add: 0.01),
                         (parameter: "spontaneous_curvature", add: 0.01), (parameter: "normal_friction", add: 0.01)]),
        (name: "T", mother: "S", daughter: smaller, shell_profile: "ellipsoid", most_rounds: 2, growth: 1.1, cue: "kappa", cue_passes_to: smaller,
         rounds_without_cue: 3),
    ],
)"#;

/// Trees in which cells end for every reason there is, with every field that a cell can have.
fn documents() -> Vec<Value> {
    let slow = |input: &DivisionInput| -> Result<Division, DivisionError> {
        let r0 = input.cell.r0;
        match r0 < 2.0 {
            true => Ok(division(r0, Outcome::Arrested, 0.0)),
            false => Ok(Division {
                slow_growth_rate: Some(1e-4),
                phi: Some(0.1),
                neck_offset: Some(0.3),
                second_neck: Some(SecondNeck { u: 0.7, radius: 0.01, share: 0.2 }),
                ..division(r0, Outcome::Asymmetric, 0.3)
            }),
        }
    };
    let undecided = |input: &DivisionInput| match input.cell.r0 < 3.0 {
        true => Err(DivisionError::Undecided { r0: input.cell.r0, epsilon: input.cell.epsilon, t_max: 1.0 }),
        false => fake(input),
    };
    let below = |cell: &Cell| match (cell.cue.is_none(), cell.r0 < 1.7) {
        (true, true) => Some(TerminalReason::BelowPitchfork { r0_c: 1.7 }),
        (false, true) => Some(TerminalReason::BelowCuedFold { r0: 1.7 }),
        _ => None,
    };
    let lineage = Lineage::parse(EVERYTHING, "everything").unwrap();
    let to = |max_depth| Lineage { limits: Limits { max_depth, max_cells: 1000 }, ..lineage.clone() };
    let c_elegans = Lineage::c_elegans().unwrap();
    let trees = [
        grown(&lineage, &|_| None, slow),
        grown(&to(3), &|_| None, slow),
        grown(&to(200), &|_| None, slow),
        grown(&to(200), &below, slow),
        grown(&c_elegans, &below, fake),
        grown(&c_elegans, &|_| None, undecided),
        // Scenarios: the same with another cue, and a founder that is never born.
        grown(&c_elegans.carrying("tension:gradient,amplitude=0.3", &Cell::new(5.4)).unwrap(), &|_| None, fake),
        grown(&c_elegans.carrying("none", &Cell::new(5.4)).unwrap(), &below, fake),
        grown(&Lineage { limits: Limits { max_depth: 2, max_cells: 1000 }, ..c_elegans }, &|_| None, fake),
    ];
    let mut trees = trees;
    trees[0].settings.cell.shell.flattening = 0.8;
    trees[0].settings.cell.material.spontaneous_curvature = 0.2;
    trees[0].settings.cell.material.normal_friction = 0.2;
    // A shell of another profile, and a law with every field, seen from the other pole.
    let law = r#"Law(name: "x", constants: { "a": (value: 1, unit: "1/L_h") }, stress_uu: "a*xi_s*u", stress_phiphi: "a*xi_s*u",
        moment: "a", normal_force: "a")"#;
    let law = furrow_cell::Law::parse(law, "law.ron").unwrap().mirrored();
    let egg = r#"{ "name": "egg", "aspect": 1.4, "error": 0.001, "series": [1] }"#;
    let cell = Cell::new(3.0).with_shell_profile(serde_json::from_str(egg).unwrap()).with_law(law);
    let settings = TreeSettings { cell, ..TreeSettings::default() };
    let with_law = grow(&lineage, &settings, 1, &|_| None, fake).0;
    let texts = trees.iter().chain([&with_law]).map(|tree| tree_to_json(tree).unwrap()).collect::<Vec<_>>();
    texts.iter().for_each(|text| assert_eq!(tree_to_json(&tree_from_json(text).unwrap()).unwrap(), *text));
    texts.iter().map(|text| serde_json::from_str(text).unwrap()).collect()
}

/// The places of the fields that a schema allows, with their definitions; `*` is any name and any entry of a list.
fn allowed(root: &Value, schema: &Value, [at, defined]: [&str; 2], found: &mut BTreeMap<String, String>) {
    if let Some(target) = schema["$ref"].as_str() {
        allowed(root, root.pointer(&target[1..]).unwrap(), [at, target], found);
    }
    for alternative in schema["anyOf"].as_array().into_iter().flatten() {
        allowed(root, alternative, [at, defined], found);
    }
    let named = schema["properties"].as_object().into_iter().flatten();
    let others = ["items", "additionalProperties"].into_iter().filter_map(|word| Some(("*", schema.get(word)?)));
    for (name, inside) in named.map(|(name, inside)| (name.as_str(), inside)).chain(others) {
        let [place, defined] = [at, defined].map(|above| format!("{above}/{name}"));
        allowed(root, inside, [&place, &defined], found);
        found.insert(place, defined);
    }
}

/// The places of a document's fields, as in its schema.
fn written(value: &Value, at: &str, known: &BTreeMap<String, String>, found: &mut BTreeSet<String>) {
    let fields = value.as_object().into_iter().flatten().map(|(name, inside)| (name.as_str(), inside));
    for (name, inside) in fields.chain(value.as_array().into_iter().flatten().map(|entry| ("*", entry))) {
        let any = format!("{at}/*");
        let place = if known.contains_key(&any) { any } else { format!("{at}/{name}") };
        written(inside, &place, known, found);
        found.insert(place);
    }
}

#[test]
fn the_schema_has_the_fields_of_the_trees_that_are_written_and_no_others() {
    let schema = serde_json::from_str(TREE_SCHEMA).unwrap();
    let (mut all, mut seen) = (BTreeMap::new(), BTreeSet::new());
    allowed(&schema, &schema, ["", "#"], &mut all);
    documents().iter().for_each(|document| written(document, "", &all, &mut seen));
    let unknown: Vec<_> = seen.iter().filter(|place| !all.contains_key(*place)).collect();
    assert!(unknown.is_empty(), "the schema lacks {unknown:?}");
    let defined: BTreeSet<&String> = all.values().collect();
    let missing: Vec<_> = defined.difference(&seen.iter().map(|place| &all[place]).collect()).copied().collect();
    assert!(missing.is_empty() && defined.len() > 100, "no tree has {missing:?} of {}", defined.len());
}
