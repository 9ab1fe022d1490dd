//! Scenarios: the files that ship, the page of several, and files with a base. Others: `tests/command/sessions/scenarios.txt`.

use std::path::Path;

use furrow_analysis::ranges::RoundsRange;
use furrow_analysis::scenarios::{Scenario, Source, combine, growers};
use furrow_analysis::{FounderRange, LineageRanges, Range, scenarios_csv};
use furrow_cell::Cell;
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Length, Lineage, Tree, TreeSettings, grow_together};
use furrow_mechanics::division::divide;
use furrow_report as report;

use crate::common::command::names;

fn shallow(mut lineage: Lineage, label: &str) -> Source {
    lineage.limits.max_depth = 3;
    Source { label: label.to_owned(), lineage, settings: TreeSettings::default() }
}

fn grown(sources: &[Source]) -> (Vec<Scenario>, Vec<Tree>) {
    let scenarios = combine(sources, &[]).unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let growers = growers(&scenarios, EndRule::Dynamics, &memo, SchedulerOptions::default());
    let (trees, _) = grow_together(&growers, divide).unwrap();
    (scenarios, trees)
}

/// The files that ship grow, and have a description.
#[test]
fn the_scenarios_that_ship_grow() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("lineages");
    let mut names = names(&root);
    names.retain(|name| name.starts_with("c_elegans"));
    assert_eq!(names.len(), 12, "{names:?}");
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
    assert!((0..11).all(|founder| !of("_no_cue").lineage.gives_cue(founder, &Cell::new(5.4))));
    // P1's asymmetry follows its cue.
    assert!(chi("_cue_half", 2) < chi("", 2) && chi("", 2) < chi("_cue_twice", 2));
    // Diffusion spreads the carried band, more so in small cells; a cue that is the same at both poles divides equally. A band at the
    // boundary of PAR makes P1 as unequal as the embryo's; a posterior step makes it almost equal.
    assert!(chi("_carried", 0) < chi("", 0) && chi("_carried", 2) < 0.7 * chi("", 2));
    assert!(chi("_self_organised", 0) < 0.01 && chi("_self_organised", 2) < 0.001);
    assert!((0.15..0.2).contains(&chi("_par_band", 0)) && (0.15..0.2).contains(&chi("_par_band", 2)));
    assert!(chi("_par_step", 0) > 1.5 * chi("", 0) && chi("_par_step", 2) < 0.05);
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
    let page = report::scenarios_page(&scenarios, &trees, &[]);
    assert!(page.contains("figure svg { display: block; width: 100%; height: auto; }") && !page.contains("name<&>"));
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
    // A spread over seeds is shown in the table, and the page's scripts have it.
    let range = Range { p5: 1.5, p50: 2.0, p95: 2.25 };
    let rounds =
        RoundsRange { min: range, mean: range, max: range, full_doublings: range, symmetric: range, terminal: range };
    let founder =
        FounderRange { name: "AB".to_owned(), rounds: Some(rounds), cells: Some(range), ..FounderRange::default() };
    let ranges = LineageRanges { founders: vec![founder], ..LineageRanges::default() };
    let spread = report::scenarios_page(&scenarios, &trees, &[ranges]);
    assert!(spread.contains("<td>2.00<small>1.50–2.25</small></td>") && !page.contains("<small>"));
    assert!(
        spread.contains(r#""p95":2.25"#)
            && spread.contains("Medians over seeds")
            && !page.contains("Medians over seeds")
    );
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
        "(base: \"c_elegans\", name: \"mine\", naming: ('l', 'r'), units: (length_um: 3.0), cues: {\"pulled\": \"tension:gradient,amplitude=0.1\"},
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

/// Tables, the page and the picture show what was observed of the first scenario, where the scenarios differ in that too.
#[test]
fn observed_counts_are_those_of_the_first_scenario() {
    let source = |label: &str, mean: f64, cells: u32| {
        let text = format!(
            "(name: \"x\", limits: (max_depth: 1), founders: [(name: \"S\", r0: 2.4, observed: (mean: {mean}, terminal: {cells}))])"
        );
        Source {
            label: label.to_owned(),
            lineage: Lineage::parse(&text, "x.ron").unwrap(),
            settings: TreeSettings::default(),
        }
    };
    let (scenarios, trees) = grown(&[source("one", 1.25, 4007), source("two", 7.75, 9003)]);
    let table = report::scenarios_table(&scenarios, &trees);
    let page = report::scenarios_page(&scenarios, &trees, &[]);
    for text in [table, page.split("<table").nth(1).unwrap().split("</table>").next().unwrap().to_owned()] {
        assert!(text.contains("1.25") && text.contains("4007"), "{text}");
        assert!(!text.contains("7.75") && !text.contains("9003"), "{text}");
    }
    // The table for other programs has each scenario's own.
    let csv = scenarios_csv(&scenarios, &trees);
    assert!(csv.lines().nth(1).unwrap().ends_with(",1.25,,,4007") && csv.contains(",7.75,,,9003"), "{csv}");
}
