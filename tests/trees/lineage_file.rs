//! The built-in lineage file compared with the published counts.

use crate::common::tables;
use furrow_lineage::Lineage;

#[test]
fn built_in_founders() {
    let lineage = Lineage::c_elegans().unwrap();
    let names: Vec<&str> = lineage.founders.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["P0", "AB", "P1", "EMS", "MS", "E", "P2", "C", "P3", "D", "P4"]);
    let cued: Vec<&str> = lineage.founders.iter().filter(|f| f.cue.is_some()).map(|f| f.name.as_str()).collect();
    assert_eq!(cued, ["P0", "P1", "P2", "P3"]);
}

/// Every count of the built-in file is the one in the table derived from Sulston et al. 1983.
#[test]
fn sulston_counts_match_the_table() {
    let lineage = Lineage::c_elegans().unwrap();
    let rows = tables::reference("founder_table.csv");
    assert_eq!(rows.len(), lineage.founders.len());
    for row in rows {
        let name = row.text("founder");
        let s = lineage.founders.iter().find(|f| f.name == name).unwrap().observed.unwrap();
        let counts = [s.min, s.max, s.full_doublings, s.terminal, s.deaths].map(|count| count.map(f64::from));
        let columns = ["min_rounds", "max_rounds", "last_full_doubling_round", "terminal", "deaths"];
        assert_eq!((counts, s.mean), (columns.map(|c| Some(row.number(c))), Some(row.number("mean_rounds"))), "{name}");
    }
}
