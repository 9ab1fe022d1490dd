//! `furrow compare`: the model and measured embryos.

use std::fmt::Write;
use std::path::Path;

use crate::common::command::{self, CACHE, answer};
use serde_json::Value;

/// Solved divisions are kept between the tests.
const KEPT: [&str; 2] = ["--cache", CACHE];

fn json(arguments: &[&str], folder: &Path) -> Value {
    command::json(folder, &[arguments, &KEPT].concat())
}

/// The entry of a list whose field has a value.
fn one<'a>(list: &'a Value, field: &str, value: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|entry| entry[field] == value).unwrap()
}

/// Volumes of a few embryos: the wild type's first two divisions, and one with an equal first.
fn table() -> String {
    let mut out = "cell,group,embryo,volume_um3\n".to_owned();
    for (k, (p0, p1)) in [(0.17, 0.16), (0.19, 0.18)].into_iter().enumerate() {
        for (group, p0) in [("wt", p0), ("moved", 0.0)] {
            let mut divided = |mother: f64, chi: f64, cells: [&str; 2]| {
                let volumes = [1.0 + chi, 1.0 - chi].map(|share| 0.5 * mother * share);
                for (cell, volume) in cells.iter().zip(volumes) {
                    let _ = writeln!(out, "{cell},{group},e{k}{group},{volume}");
                }
                volumes[1]
            };
            let smaller = divided(20_000.0, p0, ["AB", "P1"]);
            divided(smaller, p1, ["EMS", "P2"]);
        }
    }
    out + "Nuc1,wt,e0wt,5\nABa,wt,e0wt,0\n"
}

#[test]
fn groups_stand_beside_the_model_free_and_with_their_own_first_division() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table()).unwrap();
    let found = json(&["compare", "volumes", "t.csv", "--out", "out"], folder.path());
    assert_eq!((found["used"].as_u64(), found["skipped_count"].as_u64()), (Some(16), Some(2)));
    assert_eq!(found["skipped"][0]["line"], 18);
    let (wild, moved) = (one(&found["groups"], "group", "wt"), one(&found["groups"], "group", "moved"));
    let p0 = one(&wild["events"], "mother", "P0");
    assert_eq!(p0["n"], 2);
    assert!((p0["mean"].as_f64().unwrap() - 0.18).abs() < 1e-12);
    assert!((p0["sd"].as_f64().unwrap() - 0.01 * 2_f64.sqrt()).abs() < 1e-12);
    assert!((p0["mother_volume"].as_f64().unwrap() - 20_000.0).abs() < 1e-8);
    // The model's P0 is the founders' table's; that of P1 hangs on how large P1 is.
    assert!((p0["model"]["chi"].as_f64().unwrap() - 0.209).abs() < 1e-3);
    assert!(p0["given_first"].is_null());
    let r0 = |group: &Value| one(&group["events"], "mother", "P1")["given_first"]["r0"].as_f64().unwrap();
    assert!((r0(wild) - 5.4 * (0.5_f64 * 0.82).cbrt()).abs() < 1e-9);
    assert!((r0(moved) - 5.4 * 0.5_f64.cbrt()).abs() < 1e-9);
    let radius = (0.75 / std::f64::consts::PI * 20_000.0_f64).cbrt();
    assert!((found["length_scale_um"].as_f64().unwrap() - radius / 5.4).abs() < 1e-12);
    for file in ["chi.csv", "divisions.csv", "bins.csv", "compare.json"] {
        assert!(folder.path().join("out").join(file).exists(), "{file}");
    }
    let lines = std::fs::read_to_string(folder.path().join("out/divisions.csv")).unwrap().lines().count();
    assert_eq!(lines, 1 + 8);
}

#[test]
fn a_compressed_data_set_gives_back_its_factor() {
    let folder = tempfile::tempdir().unwrap();
    // Grids of three embryos each, in voxels of two sizes: χ of the second condition is 1.151 times that of the first.
    let pairs = [("AB", "P1", 0.18), ("EMS", "P2", 0.16), ("C", "P3", 0.4), ("ABa", "ABp", 0.05), ("MS", "E", 0.09)];
    for (condition, factor, size) in [("a", 1.0, 1e5_f64), ("b", 1.151, 3e5)] {
        for k in 0..3 {
            let (mut header, mut row) = (String::new(), "1".to_owned());
            for (j, (first, second, chi)) in (0..).zip(pairs) {
                // Scatter that is not quite the same in both.
                let scatter = f64::from((2 * k + j * (size as i32 % 7)) % 3 - 1);
                let chi = chi * factor * (1.0 + 0.01 * scatter);
                let _ = write!(header, ",{first},{second}");
                let _ = write!(row, ",{},{}", size * (1.0 + chi), size * (1.0 - chi));
            }
            std::fs::write(folder.path().join(format!("{condition}{k}_Volume.csv")), format!("{header}\n{row}\n"))
                .unwrap();
        }
    }
    let arguments = "compare volumes a0_Volume.csv a1_Volume.csv a2_Volume.csv \
                     --against b0_Volume.csv --against b1_Volume.csv --against b2_Volume.csv";
    let found = json(&arguments.split(' ').collect::<Vec<_>>(), folder.path());
    let regression = &found["regressions"][0];
    assert_eq!(regression["mothers"].as_array().unwrap().len(), 5);
    for line in ["through_origin", "with_intercept"] {
        let (slope, error) =
            (regression[line]["slope"].as_f64().unwrap(), regression[line]["slope_error"].as_f64().unwrap());
        assert!((slope - 1.151).abs() < 3.0 * error + 1e-3, "{slope} {error}");
        assert!(regression[line]["r_squared"].as_f64().unwrap() > 0.99);
    }
    assert_eq!(found["unit"], "voxels");
}

/// Without P0 the scale is that of all mothers; boxes need single divisions, ranges sets of constants.
#[test]
fn scales_are_fitted_and_constants_give_ranges() {
    let folder = tempfile::tempdir().unwrap();
    // Every cell of 2 L_h of the model's, of an embryo whose first division was not seen.
    let tree = json(&["tree", "--out", "t"], folder.path());
    let radius = |name: &str| one(&tree["founders"], "name", name)["r0"].as_f64().unwrap();
    let mut table = "embryo,cell,volume_um3\n".to_owned();
    for k in 0..5 {
        for cell in ["EMS", "P2", "MS", "E"] {
            let volume = 4.0 / 3.0 * std::f64::consts::PI * (2.0 * radius(cell)).powi(3);
            let _ = writeln!(table, "e{k},{cell},{}", volume * (1.0 + 0.01 * f64::from(k - 2)));
        }
    }
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let constants = "aspect,p0,w,gain,weight\n1.5,0.123,0.1445,0.5,3\n1.5,0.14,0.1445,0.5,1\n";
    std::fs::write(folder.path().join("c.csv"), constants).unwrap();
    let found = json(&["compare", "volumes", "t.csv", "--constants", "c.csv", "--plot", "t.svg"], folder.path());
    assert_eq!((found["length_scale"]["from"].as_str(), found["members"].as_u64()), (Some("fitted"), Some(2)));
    assert!((found["length_scale_um"].as_f64().unwrap() - 2.0).abs() < 1e-3, "{}", found["length_scale"]);
    let event = found["groups"][0]["events"][0].clone();
    assert_eq!(event["mother"], "P1");
    assert_eq!(event["box_plot"]["quartiles"].as_array().unwrap().len(), 3);
    let chi = event["model"]["chi"].as_f64().unwrap();
    // Three quarters of the weight are the model's own constants.
    assert_eq!(event["band"]["chi"]["p50"].as_f64(), Some(chi));
    assert!(event["band"]["chi"]["p95"] != event["band"]["chi"]["p5"] && event["band"]["divides"] == 1.0, "{event}");
    let given = json(&["compare", "volumes", "t.csv", "--length-scale", "1.7"], folder.path());
    assert_eq!((given["length_scale"]["from"].as_str(), given["length_scale_um"].as_f64()), (Some("given"), Some(1.7)));
    let svg = std::fs::read_to_string(folder.path().join("t.svg")).unwrap();
    for said in ["whiskers within 3 IQR", "90 % of the sets", "model over size, no cue", "cue germline"] {
        assert!(svg.contains(said), "{said}");
    }
}

#[test]
fn published_means_stand_in_for_tables_of_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&["compare", "volumes"], folder.path());
    let groups: Vec<&Value> = found["groups"].as_array().unwrap().iter().map(|group| &group["group"]).collect();
    assert_eq!(groups, ["wt", "ctrl", "alive", "dead"]);
    let p2 = one(&found["groups"][0]["events"], "mother", "P2");
    assert_eq!((p2["n"].as_u64(), p2["mean"].as_f64()), (Some(6), Some(0.4107)));
    assert!(p2["model"]["chi"].as_f64().unwrap() < 0.2);
}

#[test]
fn only_most_rounds_make_the_papers_sentence_true() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&["compare", "counts"], folder.path());
    let readings = ["min", "mean", "max", "full_doublings"];
    let holds = readings.map(|reading| one(&found["sentence"], "reading", reading)["holds"].as_bool().unwrap());
    assert_eq!(holds, [false, false, true, false]);
    assert_eq!(found["sentence"].as_array().unwrap().len(), 4);
    let stages = found["stages"].as_array().unwrap();
    let cells: Vec<&Value> = stages.iter().map(|stage| &stage["cells"]).collect();
    assert_eq!(cells, [349, 549, 671]);
    let ems = one(&stages[2]["founders"], "founder", "EMS");
    assert_eq!(
        (ems["counts"]["max"]["model"].as_f64(), ems["counts"]["max"]["observed"].as_f64()),
        (Some(10.0), Some(9.0))
    );
    // A tree from a file says the same.
    answer(folder.path(), &[&["tree", "--out", "t"][..], &KEPT].concat());
    assert_eq!(json(&["compare", "counts", "t/tree.json"], folder.path()), found);
}
