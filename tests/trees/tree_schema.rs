//! Written trees follow the published JSON Schema of `tree.json`, `docs/tree.schema.json`.

use furrow_formats::{tree_from_json, tree_to_json};
use std::collections::{BTreeMap, BTreeSet};

use crate::common::cases::check_cases;
use crate::common::stand_in::{division, fake, grown, small_tree_file};
use crate::complaints::changed;
use furrow_cell::{Cell, Cue};
use furrow_formats::TREE_SCHEMA;
use furrow_lineage::{
    CueRule, Daughter, Founder, FounderPhysics, Length, Limits, Lineage, ObservedRounds, TerminalReason, Tree, Units,
};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome};
use serde_json::{Value, json};

/// A founder with nothing but its name, mother and side.
fn plain(name: &str, mother: Option<&str>, daughter: Option<Daughter>) -> Founder {
    Founder {
        name: name.to_owned(),
        mother: mother.map(str::to_owned),
        daughter,
        cue: None,
        inherit: true,
        cue_rules: vec![],
        r0: None,
        physics: FounderPhysics::default(),
        letters: vec![],
        observed: None,
    }
}

/// A lineage in which every field is given. Its parts are written out in full, so that a new field does not compile until it
/// stands here too, and then the schema has to know it.
fn everything() -> Lineage {
    let observed = ObservedRounds {
        min: Some(1),
        mean: Some(2.5),
        max: Some(4),
        full_doublings: Some(1),
        terminal: Some(9),
        deaths: Some(1),
    };
    let one = Some(1.0);
    let physics = FounderPhysics {
        xi_s: Some(26.0),
        xi_ratio: Some(-0.1),
        gain: Some(0.5),
        epsilon: Some(0.86),
        aspect: Some(1.4),
        p0: Some(0.12),
        w: Some(0.14),
        kappa: one,
        eta_b: one,
        eta_s: one,
        friction: one,
        tension: Some(0.0),
    };
    let rule = CueRule {
        cue: "sum".to_owned(),
        from_generation: 1,
        to_generation: Some(9),
        below_r0: Some(9.0),
        above_r0: Some(0.1),
    };
    let first = Founder {
        cue: Some("kappa".to_owned()),
        inherit: false,
        r0: Some(Length::Micrometres(17.0)),
        observed: Some(observed),
        ..plain("S", None, None)
    };
    let larger = Founder {
        cue_rules: vec![rule.clone()],
        physics,
        letters: vec![('l', 'r')],
        r0: Some(Length::Natural(5.0)),
        ..plain("L", Some("S"), Some(Daughter::Larger))
    };
    let fields = ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];
    let profiles = ["band,u0=0.4,omega=0.1,", "step,u0=0.6,omega=0.3Lh,", "gradient,"];
    let cue = |k: usize| format!("{}:{}amplitude=0.1", fields[k], profiles[k % 3]).parse::<Cue>().unwrap();
    let mut cues: BTreeMap<String, Cue> = (0..fields.len()).map(|k| (fields[k].to_owned(), cue(k))).collect();
    cues.insert(
        "sum".to_owned(),
        "kappa:u0=0.4,omega=0.1,amplitude=0.1+tension:gradient,amplitude=0.2".parse().unwrap(),
    );
    let lineage = Lineage {
        name: "everything".to_owned(),
        citation: Some("nobody".to_owned()),
        naming: ('a', 'p'),
        units: Some(Units { length_um: Some(3.0), time_min: Some(2.0) }),
        limits: Limits { max_depth: 6, max_cells: 60 },
        cues,
        cue_rules: vec![rule],
        founders: vec![first, larger, plain("T", Some("S"), Some(Daughter::Smaller))],
    };
    lineage.check("everything").unwrap();
    lineage
}

/// Trees in which cells end for every reason there is, with every field that a cell can have.
fn documents() -> Vec<Value> {
    let slow = |input: &DivisionInput| -> Result<Division, DivisionError> {
        let r0 = input.cell.r0;
        match r0 < 2.0 {
            true => Ok(division(r0, Outcome::Arrested, 0.0)),
            false => Ok(Division { slow_growth_rate: Some(1e-4), ..division(r0, Outcome::Asymmetric, 0.3) }),
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
    let lineage = everything();
    let deep = Lineage { limits: Limits { max_depth: 200, max_cells: 1000 }, ..lineage.clone() };
    let c_elegans = Lineage::c_elegans().unwrap();
    let trees = [
        grown(&lineage, &|_| None, slow),
        grown(&Lineage { limits: Limits { max_depth: 3, max_cells: 1000 }, ..lineage.clone() }, &|_| None, slow),
        grown(&deep, &|_| None, slow),
        grown(&deep, &below, slow),
        grown(&c_elegans, &below, fake),
        grown(&c_elegans, &|_| None, undecided),
        // Scenarios: the same with another cue, and a founder that is never born.
        grown(&c_elegans.carrying("tension:gradient,amplitude=0.3").unwrap(), &|_| None, fake),
        grown(&c_elegans.carrying("none").unwrap(), &below, fake),
        grown(&Lineage { limits: Limits { max_depth: 2, max_cells: 1000 }, ..c_elegans }, &|_| None, fake),
    ];
    let text = |tree: &Tree| tree_to_json(tree).unwrap();
    trees.iter().for_each(|tree| assert_eq!(text(&tree_from_json(&text(tree)).unwrap()), text(tree)));
    trees.iter().map(|tree| serde_json::from_str(&text(tree)).unwrap()).collect()
}

/// Holds documents against a schema. It knows the words that ours is made of and no others, and is stricter than a validator: a
/// field that the schema does not name is wrong. An independent validator is asked in `tests/trees/exchange.rs`, where there is one.
struct Validator {
    root: Value,
    /// Which properties and alternatives of the schema have been met, by where they stand in it.
    met: BTreeSet<String>,
}

const WORDS: &str = "$schema $defs $ref title description type properties required additionalProperties propertyNames items minItems \
                     maxItems minProperties maxProperties minLength maxLength minimum maximum exclusiveMinimum exclusiveMaximum enum \
                     const anyOf";

impl Validator {
    /// Checks a value against the schema at `at`; gives the names of the fields that it may have.
    fn check(&mut self, at: &str, value: &Value, place: &str) -> Result<BTreeSet<String>, String> {
        let schema = self.root.pointer(at).unwrap_or_else(|| panic!("{at} is not in the schema")).clone();
        let schema = schema.as_object().unwrap();
        let wrong = |what: &str| Err(format!("{place}: {value} is against {what} of {at}"));
        for word in schema.keys() {
            assert!(WORDS.split_whitespace().any(|known| known == word), "{at}: {word} is a word that is not checked");
        }
        let mut fields = BTreeSet::new();
        if let Some(target) = schema.get("$ref").and_then(Value::as_str) {
            fields.extend(self.check(target.strip_prefix('#').unwrap(), value, place)?);
        }
        if schema.get("type").is_some_and(|kinds| !of_kind(value, kinds)) {
            return wrong("type");
        }
        if schema.get("const").is_some_and(|only| only != value) {
            return wrong("const");
        }
        if schema.get("enum").is_some_and(|allowed| !allowed.as_array().unwrap().contains(value)) {
            return wrong("enum");
        }
        let limit = |word: &str| schema.get(word).and_then(Value::as_f64);
        let size = match value {
            Value::String(text) => Some(("Length", text.chars().count())),
            Value::Array(list) => Some(("Items", list.len())),
            Value::Object(map) => Some(("Properties", map.len())),
            _ => None,
        };
        if let Some((of, size)) = size {
            let (least, most) = (limit(&format!("min{of}")), limit(&format!("max{of}")));
            if least.is_some_and(|least| (size as f64) < least) || most.is_some_and(|most| size as f64 > most) {
                return wrong("its size");
            }
        }
        type Compare = fn(&f64, &f64) -> bool;
        let outside: [(&str, Compare); 4] =
            [("minimum", f64::lt), ("maximum", f64::gt), ("exclusiveMinimum", f64::le), ("exclusiveMaximum", f64::ge)];
        let is_outside =
            |number: f64| outside.iter().any(|(word, is)| limit(word).is_some_and(|end| is(&number, &end)));
        if value.as_f64().is_some_and(is_outside) {
            return wrong("its range");
        }
        if schema.contains_key("items") {
            for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                self.check_whole(&format!("{at}/items"), item, &format!("{place}[{k}]"))?;
            }
        }
        fields.extend(self.check_alternatives(at, schema, value, place)?);
        fields.extend(self.check_fields(at, schema, value, place)?);
        Ok(fields)
    }

    /// Checks a whole value: it has no fields that the schema does not name.
    fn check_whole(&mut self, at: &str, value: &Value, place: &str) -> Result<(), String> {
        let fields = self.check(at, value, place)?;
        match value.as_object().and_then(|map| map.keys().find(|key| !fields.contains(*key))) {
            Some(key) => Err(format!("{place}: the field {key:?} is not in {at}")),
            None => Ok(()),
        }
    }

    fn check_alternatives(
        &mut self,
        at: &str,
        schema: &serde_json::Map<String, Value>,
        value: &Value,
        place: &str,
    ) -> Result<BTreeSet<String>, String> {
        let Some(alternatives) = schema.get("anyOf").and_then(Value::as_array) else { return Ok(BTreeSet::new()) };
        let mut said = vec![];
        for k in 0..alternatives.len() {
            let one = format!("{at}/anyOf/{k}");
            match self.check(&one, value, place) {
                Ok(fields) => {
                    self.met.insert(one);
                    return Ok(fields);
                }
                Err(error) => said.push(error),
            }
        }
        Err(said.join("; "))
    }

    fn check_fields(
        &mut self,
        at: &str,
        schema: &serde_json::Map<String, Value>,
        value: &Value,
        place: &str,
    ) -> Result<BTreeSet<String>, String> {
        let Some(map) = value.as_object() else { return Ok(BTreeSet::new()) };
        for name in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
            let name = name.as_str().unwrap();
            map.get(name).ok_or_else(|| format!("{place}: {name} of {at} is missing"))?;
        }
        let named: BTreeSet<String> = schema
            .get("properties")
            .and_then(Value::as_object)
            .into_iter()
            .flat_map(|map| map.keys().cloned())
            .collect();
        let mut fields = named.clone();
        for (key, field) in map {
            let place = format!("{place}.{key}");
            if named.contains(key) {
                let one = format!("{at}/properties/{key}");
                self.check_whole(&one, field, &place)?;
                self.met.insert(one);
            } else if schema.get("additionalProperties").is_some() {
                self.check_whole(&format!("{at}/additionalProperties"), field, &place)?;
                fields.insert(key.clone());
            }
            if schema.contains_key("propertyNames") {
                self.check(&format!("{at}/propertyNames"), &json!(key), &place)?;
            }
        }
        Ok(fields)
    }
}

fn of_kind(value: &Value, kinds: &Value) -> bool {
    let one = |kind: &str| match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("there is no type {other}"),
    };
    match kinds {
        Value::String(kind) => one(kind),
        kinds => kinds.as_array().unwrap().iter().any(|kind| one(kind.as_str().unwrap())),
    }
}

/// Where all properties and alternatives of a schema stand in it.
fn parts(value: &Value, at: &str, found: &mut BTreeSet<String>) {
    let Some(map) = value.as_object() else { return };
    for (word, inside) in map {
        let here = format!("{at}/{word}");
        match (word.as_str(), inside) {
            ("properties", Value::Object(named)) => {
                for (key, property) in named {
                    found.insert(format!("{here}/{key}"));
                    parts(property, &format!("{here}/{key}"), found);
                }
            }
            ("anyOf", Value::Array(list)) => {
                for (k, one) in list.iter().enumerate() {
                    found.insert(format!("{here}/{k}"));
                    parts(one, &format!("{here}/{k}"), found);
                }
            }
            ("$defs", Value::Object(named)) => {
                named.iter().for_each(|(key, inside)| parts(inside, &format!("{here}/{key}"), found));
            }
            _ => parts(inside, &here, found),
        }
    }
}

/// Every field that a tree of ours has is in the schema, and every field and alternative of the schema is in one of ours.
#[test]
fn the_schema_is_that_of_the_trees_that_are_written() {
    let root: Value = serde_json::from_str(TREE_SCHEMA).unwrap();
    let mut all = BTreeSet::new();
    parts(&root, "", &mut all);
    assert!(all.len() > 100, "{}", all.len());
    let mut validator = Validator { root, met: BTreeSet::new() };
    for document in documents() {
        validator.check_whole("", &document, "tree").unwrap();
    }
    let missing: Vec<&String> = all.difference(&validator.met).collect();
    assert!(missing.is_empty(), "no tree has {missing:?}");
}

/// The check above would tell.
#[test]
fn the_schema_refuses_what_is_no_tree() {
    let mut validator = Validator { root: serde_json::from_str(TREE_SCHEMA).unwrap(), met: BTreeSet::new() };
    let good: Value = serde_json::from_str(&small_tree_file()).unwrap();
    validator.check_whole("", &good, "tree").unwrap();
    check_cases("trees/complaints/schema.txt", |case| {
        validator.check_whole("", &changed(&good, case), "tree").unwrap_err()
    });
}
