//! Scenarios: every lineage with every cue, grown in one run.

use std::fs;
use std::path::{Path, PathBuf};

use furrow_analysis::scenarios::{Scenario, Source, combine, grow};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Length, Lineage, Tree, TreeSettings};
use furrow_mechanics::division::divide;
use furrow_report as report;
use serde_json::Value;

use crate::common::command::{furrow, json, names, refusal};

const CUES: [&str; 3] = ["germline", "none", "tension:gradient,amplitude=0.3"];
const NAMES: [&str; 3] = ["shallow-germline", "shallow-none", "shallow-cue-3"];

/// A folder with a lineage of three generations, to keep the tests short.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = "(base: \"c_elegans\", limits: (max_depth: 2, max_cells: 100))";
    fs::write(folder.path().join("shallow.ron"), text).unwrap();
    folder
}

/// What `furrow tree` says on stdout and on stderr.
fn tree(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = furrow(folder, &[&["tree"], arguments, &["--no-cache"]].concat());
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success(), "{err}");
    (out, err)
}

fn answer(folder: &Path, arguments: &[&str]) -> Value {
    json(folder, &[&["tree"], arguments, &["--no-cache"]].concat())
}

/// The three scenarios of the shallow lineage, with further arguments.
fn three<'a>(further: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["shallow.ron"];
    CUES.iter().for_each(|cue| arguments.extend(["--cue", cue]));
    arguments.extend(further);
    arguments
}

/// Files below a folder, by their paths in it.
fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![PathBuf::new()];
    while let Some(inside) = open.pop() {
        for entry in fs::read_dir(folder.join(&inside)).unwrap() {
            let path = inside.join(entry.unwrap().file_name());
            if folder.join(&path).is_dir() { open.push(path) } else { found.push(path.to_str().unwrap().to_owned()) }
        }
    }
    found.sort();
    found
}

#[test]
fn the_answer_has_every_scenario_and_the_folder_every_file() {
    let folder = folder();
    let document = answer(folder.path(), &three(&["--out", "out"]));
    let scenarios = document["scenarios"].as_array().unwrap();
    for (scenario, (name, cue)) in scenarios.iter().zip(NAMES.iter().zip(CUES)) {
        assert_eq!(
            (&scenario["name"], &scenario["cue"], &scenario["lineage"]),
            (&(*name).into(), &cue.into(), &"shallow".into())
        );
        assert_eq!(scenario["cells"], 7);
        assert_eq!(scenario["founders"].as_array().unwrap().len(), 11);
    }
    assert_eq!(scenarios.len(), 3);
    assert!(document["divisions_solved"].as_u64().unwrap() > 3 && document["memo_hits"].is_u64());
    assert!(document["elapsed_s"].is_f64() && document["out"] == "out");
    let mut expected = vec!["report.html".to_owned(), "run.json".to_owned(), "scenarios.csv".to_owned()];
    NAMES.iter().for_each(|name| expected.extend(["nwk", "json", "svg"].map(|kind| format!("{name}/tree.{kind}"))));
    expected.sort();
    assert_eq!(files(&folder.path().join("out")), expected);
    // P0 as it is in the answer, and one row for each founder of each scenario.
    let csv = fs::read_to_string(folder.path().join("out/scenarios.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!(rows.len(), 1 + 3 * 11);
    let columns = "scenario,lineage,cue,founder,r0,outcome,chi,min,mean,max,full_doublings,terminal,observed_min,observed_mean,observed_max,observed_full_doublings,observed_terminal";
    assert_eq!(rows[0], columns);
    let first = &scenarios[1]["founders"][0];
    let chi = first["chi"].as_f64().unwrap();
    let outcome = first["outcome"].as_str().unwrap();
    assert_eq!(rows[12], format!("shallow-none,shallow,none,P0,5.4,{outcome},{chi},2,2,2,2,4,5,9.754,12,5,671"));
    assert!(rows[23].starts_with("shallow-cue-3,shallow,\"tension:gradient,amplitude=0.3\",P0,5.4,"), "{}", rows[23]);
}

/// The trees of one run are those of separate runs, bit for bit, at any number of threads.
#[test]
fn scenarios_are_the_trees_that_grow_alone() {
    let folder = folder();
    for threads in ["1", "2"] {
        tree(folder.path(), &three(&["--threads", threads, "--out", threads]));
    }
    let read = |path: &str| fs::read(folder.path().join(path)).unwrap();
    for file in files(&folder.path().join("1")).iter().filter(|file| *file != "run.json") {
        assert!(read(&format!("1/{file}")) == read(&format!("2/{file}")), "{file}");
    }
    for (name, cue) in NAMES.iter().zip(CUES) {
        tree(folder.path(), &["shallow.ron", "--cue", cue, "--out", "alone"]);
        for file in ["tree.json", "tree.nwk", "tree.svg"] {
            assert!(read(&format!("alone/{file}")) == read(&format!("1/{name}/{file}")), "{name}/{file}");
        }
    }
}

#[test]
fn what_scenarios_share_is_solved_once() {
    let folder = folder();
    // P2 without a cue: all before its division is alike. One generation more, so that it divides.
    let text = |cue| {
        format!(
            "(base: \"c_elegans\", limits: (max_depth: 3, max_cells: 100), founders: [(name: \"P2\", cue: \"{cue}\")])"
        )
    };
    fs::write(folder.path().join("a.ron"), text("germline")).unwrap();
    fs::write(folder.path().join("b.ron"), text("none")).unwrap();
    let solved = |arguments: &[&str]| answer(folder.path(), arguments)["divisions_solved"].as_u64().unwrap();
    let (a, b) = (solved(&["a.ron"]), solved(&["b.ron"]));
    assert_eq!(a, b);
    assert_eq!(solved(&["a.ron", "b.ron"]), a + 1);
}

#[test]
fn the_table_fits_marks_differences_and_has_what_was_observed() {
    let folder = folder();
    let cues = ["kappa:u0=0.465,omega=0.0577,amplitude=0.2", "activity:u0=0.4,omega=0.1,amplitude=0.1"];
    let arguments = three(&["--cue", cues[0], "--cue", cues[1], "--out", "out"]);
    let (table, _) = tree(folder.path(), &arguments);
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("P0 ")).collect();
    // Three scenarios at a time.
    assert_eq!(rows.len(), 2, "{table}");
    assert!(table.lines().all(|line| line.chars().count() <= 120), "{table}");
    assert!(rows.iter().all(|row| row.ends_with("|   5 9.75  12   671")), "{table}");
    assert!(table.contains("* another number than in scenario 1."));
    let groups: Vec<&str> = rows[0].split('|').collect();
    // Of the first nothing is marked; without the cue P0 has another χ and the rounds that two generations allow.
    assert!(!groups[1].contains('*') && groups[1].contains("0.209"), "{table}");
    assert_eq!(groups[2].matches('*').count(), 1, "{table}");
    assert!(table.contains("3 shallow-cue-3") && table.contains("cue tension:gradient,amplitude=0.3"), "{table}");
    // Each line of a block has its bars in the same places.
    let bars =
        |line: &str| line.chars().enumerate().filter(|(_, c)| "|+".contains(*c)).map(|(k, _)| k).collect::<Vec<_>>();
    let block: Vec<&str> = table.lines().skip_while(|line| !line.starts_with(' ')).take(8).collect();
    assert!(block.iter().all(|line| bars(line) == bars(block[0])), "{table}");
}

#[test]
fn a_folder_that_cannot_take_the_files_is_refused_before_the_work() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("taken/shallow-none/tree.json")).unwrap();
    let taken = refusal(folder.path(), &[&["tree"], &three(&["--out", "taken"])[..]].concat());
    assert!(taken.contains("must be a folder that can be written to"), "{taken}");
    assert_eq!(files(&folder.path().join("taken")), [""; 0]);
}

#[test]
fn earlier_scenarios_are_overwritten_and_other_files_stay() {
    let folder = folder();
    let out = folder.path().join("out");
    let run = |arguments: &[&str]| {
        assert_eq!(tree(folder.path(), &[arguments, &["--out", "out"]].concat()).1, "");
        files(&out)
    };
    let before = run(&three(&[]));
    assert_eq!(run(&three(&["--seed", "1"])), before);
    let note = out.join("shallow-cue-3/note.txt");
    fs::write(&note, "mine").unwrap();
    run(&["shallow.ron", "--cue", "germline", "--cue", "none"]);
    assert_eq!(fs::read_to_string(note).unwrap(), "mine");
}

fn shallow(lineage: Lineage, label: &str) -> Source {
    let mut lineage = lineage;
    lineage.limits.max_depth = 3;
    Source { label: label.to_owned(), lineage, settings: TreeSettings::default() }
}

fn grown(sources: &[Source]) -> (Vec<Scenario>, Vec<Tree>) {
    let scenarios = combine(sources, &[]).unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let (trees, _) = grow(&scenarios, EndRule::Dynamics, &memo, SchedulerOptions::default(), divide).unwrap();
    (scenarios, trees)
}

/// The files that ship: each says what it says it does, and grows.
#[test]
fn the_scenarios_that_ship_grow() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("lineages");
    let mut names = names(&root);
    names.retain(|name| name.starts_with("c_elegans"));
    assert_eq!(names.len(), 8, "{names:?}");
    let sources: Vec<Source> = names
        .iter()
        .map(|name| shallow(Lineage::read(&root.join(name)).unwrap(), name.trim_end_matches(".ron")))
        .collect();
    let (scenarios, trees) = grown(&sources);
    let of = |name: &str| &trees[scenarios.iter().position(|s| s.name == format!("c_elegans{name}")).unwrap()];
    let chi = |name: &str, founder: usize| {
        let tree = of(name);
        tree.cell(tree.founder_cell(founder).unwrap()).fate.chi().unwrap()
    };
    for (scenario, tree) in scenarios.iter().zip(&trees) {
        assert_eq!(tree.lineage.founders.len(), 11, "{}", scenario.name);
        assert!(tree.lineage.founders.iter().all(|founder| founder.observed.is_some()), "{}", scenario.name);
        assert!(tree.len() >= 13, "{} has {} cells", scenario.name, tree.len());
    }
    assert!((0..11).all(|founder| !of("_no_cue").lineage.gives_cue(founder)));
    // P1's asymmetry follows its cue.
    assert!(chi("_cue_half", 2) < chi("", 2) && chi("", 2) < chi("_cue_twice", 2));
    let r0 = |founder| of("_equalised").cell(of("_equalised").founder_cell(founder).unwrap()).r0;
    assert_eq!((r0(1), r0(2)), (4.286, 4.286));
    assert!((2.0 * r0(1).powi(3) / 5.4_f64.powi(3) - 1.0).abs() < 1e-4);
}

/// Discs and lines stay inside the drawings of the page, which scale with their places.
#[test]
fn drawings_on_the_page_do_not_overflow() {
    let wide = Lineage::parse(
        "(name: \"x\", limits: (max_depth: 3), founders: [(name: \"a-rather-long-name<&>\", r0: 5.0)])",
        "wide.ron",
    );
    let (scenarios, trees) = grown(&[shallow(Lineage::c_elegans().unwrap(), "worm"), shallow(wide.unwrap(), "wide")]);
    let page = report::scenarios_page(&scenarios, &trees);
    assert!(page.contains("figure svg{display:block;width:100%;height:auto}") && !page.contains("name<&>"));
    let drawings: Vec<&str> = page.split("<svg ").skip(1).map(|rest| rest.split("</svg>").next().unwrap()).collect();
    assert_eq!(drawings.len(), 2);
    for (drawing, tree) in drawings.iter().zip(&trees) {
        let numbers = |text: &str| text.split(' ').map(|n| n.parse().unwrap()).collect::<Vec<f64>>();
        let size = numbers(drawing.split("viewBox=\"0 0 ").nth(1).unwrap().split('"').next().unwrap());
        let discs: Vec<&str> = drawing.split("<circle ").skip(1).collect();
        assert_eq!(discs.len(), tree.len());
        for disc in discs {
            let value = |name: &str| -> f64 {
                disc.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
            };
            let r = value("r") + 1.0;
            assert!(value("cx") - r > 0.0 && value("cx") + r < size[0], "{disc}");
            assert!(value("cy") - r > 0.0 && value("cy") + r + 3.0 < size[1], "{disc}");
        }
    }
    // A founder that a scenario does not have leaves its columns empty, and the text of the table knows both.
    let table = report::scenarios_table(&scenarios, &trees);
    assert!(table.lines().any(|line| line.starts_with("a-rather-long-name<&>")), "{table}");
    assert!(table.lines().all(|line| line.chars().count() <= 120), "{table}");
}

#[test]
fn a_file_with_a_base_says_what_differs() {
    let read = |text: &str| Lineage::parse(text, "my.ron");
    let worm = Lineage::c_elegans().unwrap();
    assert_eq!(read("Lineage(base: \"c_elegans\")").unwrap(), worm);
    let changed = read(
        "(base: \"c_elegans\", name: \"mine\", naming: ('l', 'r'), units: (length_um: 3.0), cues: {\"pulled\": tension(profile: gradient, amplitude: 0.1)},
          founders: [(name: \"P1\", cue: \"pulled\", r0: \"12um\"), (name: \"E\", physics: (xi_s: 20)), (name: \"P0\", inherit: false),
                     (name: \"Ea\", mother: \"E\", daughter: larger), (name: \"Ep\", mother: \"E\", daughter: smaller)])",
    )
    .unwrap();
    let founder = |name: &str| changed.founders.iter().find(|founder| founder.name == name).unwrap();
    assert_eq!((changed.name.as_str(), changed.naming, changed.cues.len()), ("mine", ('l', 'r'), 2));
    let p1 = founder("P1");
    assert_eq!(
        (p1.cue.as_deref(), p1.r0, p1.mother.as_deref()),
        (Some("pulled"), Some(Length::Micrometres(12.0)), Some("P0"))
    );
    assert_eq!((founder("P1").observed, founder("E").physics.xi_s), (worm.founders[2].observed, Some(20.0)));
    assert!(!founder("P0").inherit && founder("P0").cue.as_deref() == Some("germline"));
    assert_eq!(changed.founders[11..].iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["Ea", "Ep"]);
    // Rules take the place of a cue.
    let ruled =
        read("(base: \"c_elegans\", founders: [(name: \"P1\", cue_rules: [(cue: \"germline\", to_generation: 0)])])")
            .unwrap();
    assert_eq!((ruled.founders[2].cue.as_deref(), ruled.founders[2].cue_rules.len()), (None, 1));
}
