//! Lifetimes beside SciPy's statistics of the shipped tables (`data/make_lifetimes.py` says how they were made).

use std::collections::BTreeMap;

use furrow_measured::lifetimes::{
    LifetimeOptions, Lifetimes, Sisters, agreement, cells_over_time, distortion, mean_volumes, sisters, slopes,
};
use furrow_measured::published::{jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::significance::{Sample, Trend, sign_test, welch};
use furrow_measured::statistics::smaller;
use furrow_measured::tracked::{TableKind, embryo_files};
use furrow_measured::volumes::{ReadOptions, Volumes};
use serde_json::Value;

use super::close;

fn reference() -> Value {
    serde_json::from_str(include_str!("../data/lifetimes.json")).unwrap()
}

fn same(found: &Trend, expected: &Value) {
    assert_eq!(found.line.n as u64, expected["n"]);
    let line = &found.line;
    let of = [line.slope, line.slope_error, line.intercept, line.r_squared.unwrap(), found.p.unwrap()];
    for (found, name) in of.into_iter().zip(["slope", "slope_error", "intercept", "r_squared", "p"]) {
        close(found, &expected[name]);
    }
}

#[test]
fn lifetimes_over_volumes_agree_with_scipy() {
    let (lifetimes, volumes) = (jankele2021_lifetimes().unwrap(), mean_volumes(&jankele2021_volumes().unwrap()));
    assert_eq!((lifetimes.cells.len(), lifetimes.used, lifetimes.skipped_count), (190, 190, 0));
    let with_volume = lifetimes.cells.iter();
    let found = slopes(with_volume.filter_map(|cell| Some((&*cell.founder, *volumes.get(&cell.cell)?, cell.mean))));
    let expected = &reference()["trends"];
    same(&found.all.unwrap(), &expected["all"]);
    let names: Vec<&str> = found.founders.keys().map(String::as_str).collect();
    assert_eq!(names, ["AB", "C", "E", "MS"]);
    same(&found.founders["AB"], &expected["AB"]);
    // A mother and her daughters, which are of one size: two sizes always lie on a line.
    for founder in ["C", "E", "MS"] {
        let Trend { line, p } = found.founders[founder];
        close(line.slope, &expected[founder]["slope"]);
        assert!(line.slope_error.is_nan() && line.r_squared.is_none() && p.is_none(), "{founder}");
    }
}

#[test]
fn orders_of_sisters_agree_with_scipy() {
    let (lifetimes, volumes) = (jankele2021_lifetimes().unwrap(), mean_volumes(&jankele2021_volumes().unwrap()));
    let (pairs, reference) = (sisters(&lifetimes), reference());
    assert_eq!(pairs.len(), reference["sisters"].as_object().unwrap().len());
    for pair in &pairs {
        let expected = &reference["sisters"][&pair.mother];
        assert_eq!(pair.first.map(|k| pair.daughters[k].as_str()), expected["first"].as_str(), "{}", pair.mother);
        close(pair.p.unwrap(), &expected["p"]);
    }
    // The larger sister divides first.
    let by_volume = |pair: &Sisters| {
        let of = |k: usize| volumes.get(&pair.daughters[k]);
        smaller([*of(1)?, *of(0)?])
    };
    let (found, expected) = (agreement(&pairs, by_volume), &reference["by_volume"]);
    assert_eq!(
        (found.pairs as u64, found.agree as u64),
        (expected["pairs"].as_u64().unwrap(), expected["agree"].as_u64().unwrap())
    );
    close(found.p, &expected["p"]);
    for case in reference["signs"].as_array().unwrap() {
        let [agree, of] = ["agree", "of"].map(|name| case[name].as_u64().unwrap() as usize);
        close(sign_test(agree, of), &case["p"]);
    }
    assert_eq!(sign_test(0, 0), 1.0);
    let one = Sample { n: 1, mean: 1.0, sd: 0.0 };
    assert_eq!(welch(one, one), None);
}

/// Embryos of different pace: `scipy.stats.ttest_rel` of the logarithms; Welch's test of the minutes has p = 0.62.
#[test]
fn sisters_are_paired_over_embryos() {
    let text = "embryo,cell,lifetime_min\na,AB,20\na,P1,22\nb,AB,25\nb,P1,28\nc,AB,16\nc,P1,17.5\nd,AB,30\n";
    let [pair] = &sisters(&read(text))[..] else { panic!("one pair") };
    assert_eq!((pair.first, pair.embryos), (Some(0), 3));
    assert!((pair.p.unwrap() - 0.005129289498525053).abs() < 1e-12, "{pair:?}");
}

/// A large embryo that was followed in its small cells alone does not make these larger than they are.
#[test]
fn volumes_are_averaged_in_a_common_size() {
    let text = "embryo,cell,volume_um3\na,P0,1000\na,AB,600\na,ABa,300\nb,P0,8000\nb,ABa,2400\nb,ABal,1200\n";
    let mut volumes = Volumes::default();
    volumes.read(text.as_bytes(), "t.csv", &ReadOptions::default()).unwrap();
    // AB of the small embryo alone should be √8 times as large, ABal of the large one alone smaller by this factor.
    assert!((distortion(&volumes) - 8.0).abs() < 1e-9);
    volumes.common_size = true;
    let found = mean_volumes(&volumes);
    for (cell, share) in [("AB", 0.6), ("ABa", 0.3), ("ABal", 0.15)] {
        assert!((found[cell] / found["P0"] - share).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn the_numbers_of_cells_follow_from_births_and_lifetimes() {
    let embryo = cells_over_time(&jankele2021_lifetimes().unwrap()).unwrap();
    let found = &embryo.over_time;
    assert_eq!(found.roots, ["AB", "P1"]);
    // Two cells, then three and four; at the division of ABal and ABar eight; P4's daughters have no lifetimes.
    let at: Vec<usize> = [-30.0, -22.0, -10.0, 20.0, 30.0].map(|time| found.at(time)).to_vec();
    assert_eq!(at, [2, 3, 4, 8, 12]);
    assert!((embryo.known_until - 170.17).abs() < 1e-9, "{}", embryo.known_until);
    // 190 cells with a lifetime, and AB and P1.
    assert_eq!((found.steps.len(), found.steps[191].cells), (192, 194));
    assert_eq!((found.steps[0].cell.as_str(), found.steps[0].min), ("AB", -23.88));
    assert!(cells_over_time(&read("cell,lifetime_min\nABa,12\n")).is_none());
}

fn read(table: &str) -> Lifetimes {
    Lifetimes::read(table.as_bytes(), "t.csv").unwrap()
}

#[test]
fn rows_of_single_embryos_are_averaged_in_the_unit_of_their_column() {
    let found = read("# a remark, with, commas\nCell\tlifetime_s\tbirth_h\nABa\t600\t0.5\nABp\t900\t\nABa\t720\t0.7\n");
    let (a, p) = (found.of("ABa").unwrap(), found.of("ABp").unwrap());
    assert_eq!((a.n, a.mean, a.birth, &*a.founder), (2, 11.0, Some(36.0), "AB"));
    assert!((a.sd.unwrap() - 2f64.sqrt()).abs() < 1e-12);
    assert_eq!((p.n, p.mean, p.sd, p.birth, p.division()), (1, 15.0, None, None, None));
    assert_eq!(found.reference().unwrap().cell, "ABa");
}

#[test]
fn unusable_rows_are_reported_with_their_place() {
    let table = "# x\ncell,n,lifetime_min,sd_min,birth_min\nABa,8,23,1,0\nABa,8,23,1,0\nnuc,8,23,1,0\nABp,0,23,1,0\nABp,8,-1,1,0\nABp,8,,1,0\nABp,8,2,-1,0\nABp,8,2,1,x\nABp\n";
    let found = read(table);
    let said: Vec<String> =
        found.skipped.iter().map(|s| format!("{}: {} = {:?}: {}", s.line, s.column, s.value, s.why)).collect();
    let expected = [
        "4: 1 (cell) = \"ABa\": a second row of this cell; the first is on line 3",
        "5: 1 (cell) = \"nuc\": no name of Sulston's; other names need the file of their lineage (--lineage), or to be matched (--names, --root)",
        "6: 2 (n) = \"0\": must be a number of embryos, at least 1",
        "7: 3 (lifetime_min) = \"-1\": must be a time above 0",
        "8: 3 (lifetime_min) = \"\": must be a time above 0 (empty)",
        "9: 4 (sd_min) = \"-1\": must be a time of 0 or more, or empty",
        "10: 5 (birth_min) = \"x\": must be a time, or empty (not a number)",
        "11: 3 (lifetime_min) = \"\": must be a time above 0 (empty)",
    ];
    assert_eq!(said, expected);
    assert_eq!((found.used, found.skipped_count), (1, 8));
}

/// Decimal commas, empty columns, numbers of rows and units in headings, as spreadsheets and pandas write them.
#[test]
fn tables_of_spreadsheets_are_read() {
    let plain = read("cell,lifetime_min\nAB,17.9\nP1,19.8\n");
    for table in [
        "cell;lifetime_min\nAB;17,9\nP1;19,8\n",
        "cell,lifetime_min,,\nAB,17.9,,\n,,,\nP1,19.8,,\n",
        ",Cell,Lifetime (min)\n0,AB,17.9\n1,P1,19.8\n",
        "Unnamed: 0\tcell name\tlifetime [minutes]\n0\tAB\t17,9\n1\tP1\t19,8\n",
    ] {
        let found = read(table);
        assert_eq!((found.cells, found.skipped_count), (plain.cells.clone(), 0), "{table}");
    }
    let found = read("cell,lifetime_min\nAB,17,9\nP1,19.8\nABa,\"18,6\"\n");
    let why: Vec<&str> = found.skipped.iter().map(|skipped| skipped.why.as_str()).collect();
    assert_eq!((found.used, why[0]), (1, "line 2 has 3 fields, the heading 2"));
    assert!(why[1].starts_with("must be a time above 0 (not a number: decimals need a point"), "{}", why[1]);
    let said = Lifetimes::read(&b"cell,Lifetime (frames)\nAB,17\n"[..], "t.csv").unwrap_err().to_string();
    assert!(said.contains("\"Lifetime (frames)\", must be one of min, s, h"), "{said}");
}

#[test]
fn other_tables_than_of_lifetimes_are_refused() {
    let cases = BTreeMap::from([
        ("", "t.csv:1:1: the table is empty"),
        ("# only\n# remarks\n", "t.csv:1:1: the table is empty"),
        (
            "# x\ncell,lifetime\nAB,1\n",
            "t.csv:2:1: column 2 is called \"lifetime\": its name must have the unit, as lifetime_min, lifetime_s, lifetime_h",
        ),
        (
            "cell,n\nAB,1\n",
            "no column is called lifetime_min, nor are there both birth_min and division_min; the columns are \"cell\", \"n\"",
        ),
        ("n,lifetime_min\n1,1\n", "no column is called cell"),
        ("cell,lifetime_min,lifetime_s\nAB,1,1\n", "column 3 is a second one for the lifetime"),
        ("cell,cell,lifetime_min\n", "two columns are called \"cell\""),
        ("cell,lifetime_min,sd_min\nAB,1,1\n", "column 3 is a standard deviation, but no column is called n"),
        ("cell,lifetime_min\nAB,0\n", "none used, 1 skipped"),
        ("cell,lifetime_min\n", "the table has no rows"),
        (
            "cell,birth_min,division\nAB,0,1\n",
            "column 3 is called \"division\": its name must have the unit, as division_min",
        ),
        ("cell,birth_min,division_min\nAB,2,2\n", "column 3 (division_min): \"2\": must be a time after the birth"),
    ]);
    for (table, expected) in cases {
        let said = Lifetimes::read(table.as_bytes(), "t.csv").unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn births_and_divisions_stand_for_lifetimes() {
    let table = "cell,birth_min,division_h,lifetime_rank\nAB,30,1,1\nP1,30,1.5,2\n";
    let found = Lifetimes::read(table.as_bytes(), "t.csv").unwrap();
    let cells: Vec<_> = found.cells.iter().map(|cell| (cell.cell.as_str(), cell.mean, cell.birth)).collect();
    assert_eq!(cells, [("AB", 30.0, Some(30.0)), ("P1", 60.0, Some(30.0))]);
    assert_eq!(found.embryos, []);
}

/// Three embryos: the second is slower than the first by a factor of 1.5, and its clock begins 100 minutes earlier; the third has another
/// cell.
#[test]
fn each_embryo_has_its_pace_and_its_clock() {
    let cells = [("AB", 20.0, 0.0), ("P1", 24.0, 0.0), ("ABa", 18.0, 20.0)];
    let mut table = "embryo,cell,lifetime_min,birth_min\n".to_owned();
    for (cell, life, birth) in cells {
        table += &format!("one,{cell},{life},{birth}\ntwo,{cell},{},{}\n", 1.5 * life, 1.5 * birth + 100.0);
    }
    table += "three,EMS,30,3\ntwo,P1,9,9\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    std::fs::write(&path, &table).unwrap();
    let read = |common_pace: bool| {
        let files = embryo_files(std::slice::from_ref(&path), TableKind::Lifetimes).unwrap().0;
        Lifetimes::read_files(&files, &LifetimeOptions { common_pace, ..LifetimeOptions::default() }).unwrap()
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    let found = read(false);
    assert_eq!(found.skipped[0].why, "a second row of this cell; the first is on line 5");
    let [one, two, three] = &found.embryos[..] else { panic!("{:?}", found.embryos) };
    assert_eq!([one.cells, two.cells, three.cells, one.shared, three.shared], [3, 3, 1, 3, 0]);
    // The factors' geometric mean is 1.
    near(two.time_factor.unwrap() / one.time_factor.unwrap(), 1.5);
    near(two.time_factor.unwrap() * one.time_factor.unwrap(), 1.0);
    assert!(two.scatter.unwrap() < 1e-9);
    assert_eq!((three.time_factor, three.shift_min), (None, None));
    let mean = |lifetimes: &Lifetimes, cell: &str| lifetimes.of(cell).unwrap().clone();
    near(mean(&found, "AB").mean, 25.0);
    // Births differ by 100, 100 and 110.
    near(two.shift_min.unwrap(), 310.0 / 3.0);
    // A birth on a clock that no other embryo shares is left out.
    assert_eq!(mean(&found, "EMS").birth, None);
    let found = read(true);
    let factor = 1.5_f64.sqrt();
    near(mean(&found, "AB").mean, 20.0 * factor);
    assert!(mean(&found, "AB").sd.unwrap() < 1e-9);
    near(found.embryos[1].shift_min.unwrap(), 100.0 / factor);
    near(mean(&found, "ABa").birth.unwrap(), 20.0 * factor);
    // One table of one embryo each gives the same.
    let tables = ["one", "two"].map(|embryo| {
        let rows = table.lines().filter(|row| row.starts_with(&format!("{embryo},"))).take(3);
        let text: String = rows.map(|row| format!("{}\n", &row[4..])).collect();
        let path = folder.path().join(format!("{embryo}.csv"));
        std::fs::write(&path, format!("cell,lifetime_min,birth_min\n{text}")).unwrap();
        path
    });
    let found =
        Lifetimes::read_files(&embryo_files(&tables, TableKind::Lifetimes).unwrap().0, &LifetimeOptions::default())
            .unwrap();
    assert_eq!(found.embryos.iter().map(|embryo| embryo.embryo.as_str()).collect::<Vec<_>>(), ["one", "two"]);
    near(found.embryos[1].shift_min.unwrap(), 310.0 / 3.0);
}

/// Numbers of embryos begin again in every table: a cell in two of them is of two embryos.
#[test]
fn embryos_of_one_name_in_several_tables_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let of = |tables: [&str; 2]| {
        let paths = ["mon.csv", "tue.csv"].map(|name| folder.path().join(name));
        paths.iter().zip(tables).for_each(|(path, table)| std::fs::write(path, table).unwrap());
        let (files, _) = embryo_files(&paths, TableKind::Lifetimes).unwrap();
        let lifetimes = Lifetimes::read_files(&files, &LifetimeOptions::default()).unwrap();
        (lifetimes.embryos.iter().map(|embryo| embryo.embryo.clone()).collect::<Vec<_>>(), lifetimes.used)
    };
    let head = "embryo,cell,lifetime_min\n";
    let [monday, tuesday] = ["1,AB,17\n1,P1,20\n2,AB,18\n", "1,AB,15\n1,P1,19\n"].map(|rows| format!("{head}{rows}"));
    assert_eq!(of([&monday, &tuesday]), (vec!["mon/1".to_owned(), "2".to_owned(), "tue/1".to_owned()], 5));
    let others = format!("{head}1,ABa,18\n3,AB,17\n");
    assert_eq!(of([&monday, &others]), (vec!["1".to_owned(), "2".to_owned(), "3".to_owned()], 5));
}
