//! Tables of volumes, long ones and grids. The first byte selects how the table is read.

use furrow_measured::events::{divisions, summaries};
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

use super::{FILE, accepted};

/// The means and the divisions are the same after they are written as a long table and read again.
pub fn check(data: &[u8]) {
    let Some((&how, table)) = data.split_first() else { return };
    let options = ReadOptions {
        voxel: (how & 1 != 0).then_some(0.25).into(),
        group: (how & 2 != 0).then(|| "wild type".to_owned()),
        ..ReadOptions::default()
    };
    let mut volumes = Volumes::default();
    let Some(()) = accepted(volumes.read(table, FILE, &options)) else { return };
    assert!(volumes.skipped.len() as u64 <= volumes.skipped_count);
    let frames: u64 = volumes.embryos.iter().flat_map(|embryo| &embryo.cells).map(|cell| cell.frames).sum();
    let in_rows = !volumes.divisions.is_empty();
    assert!(in_rows || frames == volumes.used, "every value that is used is a frame of a cell, or in a division");
    let found = divisions(&volumes);
    for division in &found.divisions {
        assert!(division.chi() <= 1.0, "{division:?}");
    }
    for group in summaries(&found.divisions) {
        assert!(
            group.events.iter().all(|event| event.mean.is_finite() && event.mean_signed.is_none_or(f64::is_finite))
        );
    }
    if in_rows {
        return;
    }
    let mut again = Volumes::default();
    let plain = ReadOptions::default();
    again.read(long_table(&volumes).as_bytes(), FILE, &plain).expect("what is written is read");
    let seen = |volumes: &Volumes| -> Vec<(String, String, String, f64)> {
        let cells = volumes.embryos.iter().flat_map(|embryo| embryo.cells.iter().map(move |cell| (embryo, cell)));
        let seen = cells.filter(|(_, cell)| cell.frames > 0);
        seen.map(|(e, cell)| (e.group.clone(), e.name.clone(), cell.cell.clone(), cell.volume())).collect()
    };
    assert_eq!(seen(&again), seen(&volumes));
    assert_eq!(again.skipped_count, 0, "{:?}", again.skipped);
}

fn long_table(volumes: &Volumes) -> String {
    let column = match volumes.unit {
        Some(Unit::Voxels) => "volume_voxels",
        Some(Unit::Relative) => "relative_volume",
        _ => "volume_um3",
    };
    let mut out = format!("group,embryo,cell,{column}\n");
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    for embryo in &volumes.embryos {
        for cell in embryo.cells.iter().filter(|cell| cell.frames > 0) {
            let [group, name, cell_name] = [&embryo.group, &embryo.name, &cell.cell].map(|text| quoted(text));
            out += &format!("{group},{name},{cell_name},{}\n", cell.volume());
        }
    }
    out
}
