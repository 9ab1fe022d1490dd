//! Observed embryos as the cells that formats write.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use furrow_formats::exchange::{Kind, Sheet, SheetCell, SheetColumn};
use furrow_input::{InputError, listed};
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes, mean_volumes};
use furrow_measured::matching::Matched;
use furrow_measured::names::Names;
use furrow_measured::published;
use furrow_measured::tracked::{
    EmbryoFile, TableKind, TimeUnit, TrackOptions, TrackedLineage, embryo_files, read_tracked,
};
use furrow_measured::volumes::{ReadOptions, Skipped, Unit, Volumes};

/// How an observed embryo is read.
#[derive(Clone, Debug, Default)]
pub struct ObservedOptions {
    /// Tables of volumes beside a table of lifetimes.
    pub volumes: Vec<EmbryoFile>,
    /// Minutes from one frame to the next.
    pub frame_minutes: Option<f64>,
    /// Edge of a voxel in µm.
    pub voxel: Option<f64>,
    /// Names of cells.
    pub names: Names,
}

/// An observed embryo, how its cells were matched, and what could not be used of it.
#[derive(Clone, Debug)]
pub struct Observed {
    /// The cells.
    pub lineage: ObservedLineage,
    /// How they were matched to the lineage.
    pub matched: Option<Matched>,
    /// The first values that could not be used.
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// Doubts about the times.
    pub warnings: Vec<String>,
}

/// Names the lineage of C. elegans in place of a file.
pub const SULSTON1983: &str = "sulston1983";

impl Observed {
    /// Reads an embryo that another program followed, or a table of lifetimes with mean volumes.
    ///
    /// # Errors
    /// A file that cannot be read as either; a name of the matching that was not met; volumes beside an embryo that was followed.
    pub fn read(path: &Path, options: &ObservedOptions) -> Result<Observed, InputError> {
        let ObservedOptions { volumes, frame_minutes, voxel, names } = options;
        if path.as_os_str() == SULSTON1983 {
            let given = !volumes.is_empty() || frame_minutes.is_some() || voxel.is_some();
            let allowed = "without volumes, minutes per frame and voxels: it has minutes and no sizes";
            InputError::require(!given, SULSTON1983, "options", "(given)", allowed)?;
            let (lineage, skipped, warnings) = (ObservedLineage::sulston(names), Vec::new(), Vec::new());
            return Ok(Observed { lineage, matched: None, skipped, skipped_count: 0, warnings });
        }
        let of_tracks = TrackOptions { pixel: *voxel, frame_minutes: *frame_minutes, ..TrackOptions::default() };
        if let Some(mut embryo) = read_tracked(path, &of_tracks)? {
            let allowed = "left out with an embryo that was followed, which has sizes of its own";
            InputError::require(volumes.is_empty(), "--volumes", "volumes", "(given)", allowed)?;
            embryo.require_options(&of_tracks)?;
            embryo.match_names(names)?;
            names.require_met()?;
            let sizes = embryo.unknown_sizes.take();
            let skipped_count = embryo.skipped_count + u64::from(sizes.is_some());
            let skipped = sizes.into_iter().chain(embryo.skipped.clone()).collect();
            let lineage = ObservedLineage::of_tracked(&embryo, names);
            let warnings = lineage.doubts_of_names(&embryo).into_iter().collect();
            return Ok(Observed { lineage, matched: embryo.matched, skipped, skipped_count, warnings });
        }
        let allowed = "left out without volumes: it is the edge of their voxels";
        let is_used = voxel.is_none() || !volumes.is_empty();
        InputError::require(is_used, "--voxel", "voxel", "(given)", allowed)?;
        let (frame_minutes, names_of) = ((*frame_minutes).into(), names.clone());
        let lifetimes = LifetimeOptions { frame_minutes, names: names_of, ..LifetimeOptions::default() };
        let lifetimes = Lifetimes::read_files(&embryo_files(&[path.to_owned()], TableKind::Lifetimes)?.0, &lifetimes)?;
        let reading = ReadOptions { names: names.clone(), voxel: (*voxel).into(), ..ReadOptions::default() };
        let sizes = if volumes.is_empty() { Volumes::default() } else { Volumes::of_files(volumes, &reading)? };
        names.require_met()?;
        let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let means = mean_volumes(&sizes).into_iter().collect();
        let lineage = ObservedLineage::of_lifetimes(&name, &lifetimes, &means, sizes.unit);
        let warnings = lineage.doubts_of_births(&lifetimes);
        let skipped = lifetimes.skipped.into_iter().chain(sizes.skipped).collect();
        let skipped_count = lifetimes.skipped_count + sizes.skipped_count;
        Ok(Observed { lineage, matched: None, skipped, skipped_count, warnings })
    }
}

/// A cell of an observed embryo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservedCell {
    /// Its name.
    pub name: String,
    /// Its name in the file of the tracking program.
    pub tracked: Option<String>,
    /// The place of its mother.
    pub mother: Option<usize>,
    /// The places of its daughters, the one named first before the other.
    pub daughters: [Option<usize>; 2],
    /// Divisions from the first cell that is above it.
    pub generation: u32,
    /// When it was born.
    pub birth: Option<f64>,
    /// When it divided; `None` if that was not seen.
    pub division: Option<f64>,
    /// When it was seen last.
    pub last: Option<f64>,
    /// Its volume.
    pub volume: Option<f64>,
}

/// The cells of an observed embryo, or of several by their means.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedLineage {
    /// Its name.
    pub name: String,
    /// Mothers before daughters.
    pub cells: Vec<ObservedCell>,
    /// The unit of times.
    pub time: TimeUnit,
    /// The unit of volumes.
    pub volumes: Option<Unit>,
}

impl ObservedLineage {
    /// The cells of an embryo that was followed. A second cell of a name gets a number behind it, as `AB#2`: formats of trees and graphs
    /// have no two nodes of one name.
    pub fn of_tracked(embryo: &TrackedLineage, names: &Names) -> ObservedLineage {
        let mut cells: Vec<ObservedCell> = Vec::with_capacity(embryo.cells.len());
        let unique = unique_names(embryo);
        for (cell, unique) in embryo.cells.iter().zip(unique) {
            let mut daughters: Vec<usize> = cell.daughters.clone();
            daughters.sort_by_cached_key(|daughter| !is_first(names, &embryo.cells[*daughter].name));
            cells.push(ObservedCell {
                name: unique,
                tracked: Some(cell.tracked.clone()).filter(|tracked| !tracked.is_empty()),
                mother: cell.mother,
                daughters: [daughters.first().copied(), daughters.get(1).copied()],
                generation: cell.mother.map_or(0, |mother| cells[mother].generation + 1),
                birth: Some(cell.birth),
                division: cell.division,
                last: Some(cell.last),
                volume: cell.volume,
            });
        }
        let volumes = cells.iter().any(|cell| cell.volume.is_some()).then_some(embryo.volumes);
        ObservedLineage { name: embryo.name.clone(), cells, time: embryo.time, volumes }
    }

    /// The embryonic lineage of C. elegans, in minutes.
    pub fn sulston(names: &Names) -> ObservedLineage {
        let (mut cells, mut places): (Vec<ObservedCell>, HashMap<&str, usize>) = Default::default();
        for (name, mother, birth) in published::sulston() {
            let place = cells.len();
            let mother = places.get(mother).copied();
            let mut generation = 0;
            if let Some(mother) = mother {
                let above: &mut ObservedCell = &mut cells[mother];
                (above.division, above.last, generation) = (birth, birth, above.generation + 1);
                let at = usize::from(above.daughters[0].is_some());
                above.daughters[at] = Some(place);
            }
            places.insert(name, place);
            cells.push(ObservedCell { name: name.to_owned(), mother, generation, birth, ..ObservedCell::default() });
        }
        let names_of: Vec<String> = cells.iter().map(|cell| cell.name.clone()).collect();
        for cell in &mut cells {
            if let [Some(first), Some(second)] = cell.daughters
                && is_first(names, &names_of[second])
            {
                cell.daughters = [Some(second), Some(first)];
            }
        }
        ObservedLineage { name: SULSTON1983.to_owned(), cells, time: TimeUnit::Minutes, volumes: None }
    }

    /// The cells of tables of lifetimes, with mean volumes. A cell's name gives its mother. A cell without a birth in the table is born
    /// when its mother divides; a cell without an ancestor in a table without births is born at 0.
    pub fn of_lifetimes(
        name: &str,
        lifetimes: &Lifetimes,
        volumes: &HashMap<String, f64>,
        unit: Option<Unit>,
    ) -> ObservedLineage {
        let names = &lifetimes.names;
        let mother = |cell: &str| names.birth(cell).map(|(mother, ..)| mother.to_owned());
        let depth = |cell: &str| std::iter::successors(mother(cell), |cell| mother(cell)).count();
        let mut all: Vec<&str> = lifetimes.cells.iter().map(|life| life.cell.as_str()).collect();
        all.sort_by_cached_key(|cell| (depth(cell), !is_first(names, cell)));
        let places: HashMap<&str, usize> = all.iter().enumerate().map(|(place, cell)| (*cell, place)).collect();
        let has_births = lifetimes.cells.iter().any(|life| life.birth.is_some());
        let begins = |cell: &str| {
            !has_births
                && std::iter::successors(mother(cell), |above| mother(above))
                    .all(|above| !places.contains_key(above.as_str()))
        };
        let mut cells: Vec<ObservedCell> = Vec::with_capacity(all.len());
        for (place, cell) in all.iter().enumerate() {
            let starts = begins(cell).then_some(0.0);
            let mother = mother(cell).and_then(|mother| places.get(mother.as_str()).copied());
            let life = lifetimes.of(cell);
            if let Some(mother) = mother {
                let free = cells[mother].daughters.iter_mut().find(|daughter| daughter.is_none());
                free.into_iter().for_each(|daughter| *daughter = Some(place));
            }
            let from_mother = mother.map_or(starts, |mother| cells[mother].division);
            let birth = life.and_then(|life| life.birth).or(from_mother);
            cells.push(ObservedCell {
                name: (*cell).to_owned(),
                mother,
                generation: mother.map_or(0, |mother: usize| cells[mother].generation + 1),
                birth,
                division: birth.zip(life).map(|(birth, life)| birth + life.mean),
                volume: volumes.get(*cell).copied(),
                ..ObservedCell::default()
            });
        }
        ObservedLineage { name: name.to_owned(), cells, time: TimeUnit::Minutes, volumes: unit }
    }

    /// The report of cells of an embryo that got another name, since an earlier cell has theirs.
    fn doubts_of_names(&self, embryo: &TrackedLineage) -> Option<String> {
        let both = self.cells.iter().zip(&embryo.cells);
        let changed: Vec<&str> =
            both.filter(|(cell, tracked)| cell.name != tracked.name).map(|(cell, _)| cell.name.as_str()).collect();
        let shown = listed(changed.iter().copied(), ", ");
        let why = "cells have the name of another one and get a number behind it";
        (!changed.is_empty()).then(|| format!("{} {why}: {shown}", changed.len()))
    }

    /// Doubts about the births of cells from tables of lifetimes.
    fn doubts_of_births(&self, lifetimes: &Lifetimes) -> Vec<String> {
        let names = |is_so: &dyn Fn(&ObservedCell) -> bool| -> Vec<&str> {
            self.cells.iter().filter(|cell| is_so(cell)).map(|cell| cell.name.as_str()).collect()
        };
        let unknown = names(&|cell| cell.birth.is_none());
        let is_given = |cell: &ObservedCell| lifetimes.of(&cell.name).is_some_and(|life| life.birth.is_some());
        let first = names(&|cell| cell.mother.is_none() && cell.birth.is_some() && !is_given(cell));
        let shown = |names: &[&str]| listed(names.iter().copied(), ", ");
        let mut doubts = Vec::new();
        if !unknown.is_empty() {
            let why = "their births are not known, so they have neither times nor branch lengths";
            doubts.push(format!("{why}: {} cells, {}", unknown.len(), shown(&unknown)));
        }
        if first.len() > 1 {
            doubts.push(format!(
                "the table has no births: each of {} cells is born at minute 0, {}",
                first.len(),
                shown(&first)
            ));
        }
        doubts
    }

    /// The cells as formats write them, with the founders of a lineage.
    pub fn sheet<'a>(&'a self, founders: &[&'a str], names: &'a Names) -> Sheet<'a> {
        let unknown = founders.len();
        let founder = |cell: &ObservedCell| {
            let founder = names.founder(&cell.name)?;
            founders.iter().position(|known| *known == founder)
        };
        let cell = |cell: &'a ObservedCell| SheetCell {
            name: &cell.name,
            mother: cell.mother,
            daughters: cell.daughters,
            founder: founder(cell).unwrap_or(unknown),
            generation: cell.generation,
            times: cell.birth.map(|birth| (birth, cell.division)),
            last: cell.last,
        };
        let in_minutes = self.time == TimeUnit::Minutes;
        let [birth, division] =
            if in_minutes { ["birth_min", "division_min"] } else { ["birth_frame", "division_frame"] };
        let own: Vec<Option<&str>> = self.cells.iter().map(|cell| Some(founders[founder(cell)?])).collect();
        let cells = &self.cells;
        let number = |name, of: fn(&ObservedCell) -> Option<f64>| {
            column(name, Kind::Number, true, move |cell| Some(of(&cells[cell])?.to_string()))
        };
        let columns = vec![
            column("mother", Kind::Text, false, |cell| Some(cells[cells[cell].mother?].name.clone())),
            column("founder", Kind::Text, true, move |cell| own[cell].map(str::to_owned)),
            column("generation", Kind::Count, true, |cell| Some(cells[cell].generation.to_string())),
            number("volume", |cell| cell.volume),
            column("chi", Kind::Number, true, |cell| Some(self.chi_signed(cell)?.abs().to_string())),
            column("chi_signed", Kind::Number, true, |cell| Some(self.chi_signed(cell)?.to_string())),
            number(birth, |cell| cell.birth),
            number(division, |cell| cell.division),
            column("tracked", Kind::Text, true, |cell| cells[cell].tracked.clone()),
        ];
        Sheet {
            name: &self.name,
            cells: self.cells.iter().map(cell).collect(),
            founders: founders.iter().copied().chain(["unnamed"]).collect(),
            columns,
            time: if in_minutes { "minute" } else { "frame" },
            duration: Box::new(|_| None),
            chi: Box::new(|cell| Some(self.chi_signed(cell)?.abs())),
            remark: Box::new(|cell| self.cells[cell].tracked.clone().unwrap_or_default()),
        }
    }

    /// (V₁ − V₂)/(V₁ + V₂) of a cell's daughters, the first-named one first.
    fn chi_signed(&self, cell: usize) -> Option<f64> {
        let [first, second] = self.cells[cell].daughters;
        let [first, second] = [self.cells[first?].volume?, self.cells[second?].volume?];
        Some((first - second) / (first + second))
    }
}

/// A column of values that may be missing, except for counts.
fn column<'a>(
    name: &'static str,
    kind: Kind,
    note: bool,
    of: impl Fn(usize) -> Option<String> + 'a,
) -> SheetColumn<'a> {
    SheetColumn { name, kind, note, may_miss: kind != Kind::Count, of: Box::new(of) }
}

/// The names of cells, each of one cell only.
fn unique_names(embryo: &TrackedLineage) -> Vec<String> {
    let names = || embryo.cells.iter().map(|cell| cell.name.as_str());
    let taken: HashSet<&str> = names().collect();
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut unique = Vec::with_capacity(embryo.cells.len());
    for name in names() {
        let count = seen.entry(name).or_default();
        *count += 1;
        let mut own = name.to_owned();
        if *count > 1 {
            own = format!("{name}#{count}");
            while taken.contains(own.as_str()) {
                *count += 1;
                own = format!("{name}#{count}");
            }
        }
        unique.push(own);
    }
    unique
}

/// Whether a cell is named before its sister.
fn is_first(names: &Names, cell: &str) -> bool {
    names.birth(cell).is_some_and(|(_, _, is_first)| is_first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::names_of;
    use furrow_lineage::Lineage;

    /// Births follow from the lifetimes of mothers, unless one is missing.
    #[test]
    fn a_table_of_lifetimes_without_births_has_times() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lives.csv");
        let read = |table: &str| {
            std::fs::write(&path, table).unwrap();
            let found = Observed::read(&path, &ObservedOptions::default()).unwrap();
            let times = |cell: &ObservedCell| (cell.name.clone(), cell.birth.zip(cell.division));
            (found.lineage.cells.iter().map(times).collect::<Vec<_>>(), found.warnings)
        };
        let named = |times: &[(&str, Option<(f64, f64)>)]| -> Vec<(String, Option<(f64, f64)>)> {
            times.iter().map(|(name, times)| ((*name).to_owned(), *times)).collect()
        };
        let (times, warnings) = read("cell,lifetime_min\nP0,10\nAB,16\nP1,19\nABa,17\n");
        let right = [
            ("P0", Some((0.0, 10.0))),
            ("AB", Some((10.0, 26.0))),
            ("P1", Some((10.0, 29.0))),
            ("ABa", Some((26.0, 43.0))),
        ];
        assert_eq!((times, warnings), (named(&right), vec![]));
        // ABa is missing, and two cells have no mother.
        let (times, warnings) = read("cell,lifetime_min\nAB,16\nP1,19\nABal,17\n");
        let right = [("AB", Some((0.0, 16.0))), ("P1", Some((0.0, 19.0))), ("ABal", None)];
        assert_eq!(times, named(&right));
        assert_eq!(
            warnings,
            [
                "their births are not known, so they have neither times nor branch lengths: 1 cells, ABal",
                "the table has no births: each of 2 cells is born at minute 0, AB, P1",
            ]
        );
        // The table's own clock.
        let (times, warnings) = read("cell,lifetime_min,birth_min\nP0,10,\nAB,16,12\nABa,17,\n");
        let right = [("P0", None), ("AB", Some((12.0, 28.0))), ("ABa", Some((28.0, 45.0)))];
        assert_eq!((times, warnings.len()), (named(&right), 1));
    }

    /// No two nodes of a graph have one name, and the warning names the cell with another one.
    #[test]
    fn a_second_cell_of_a_name_has_a_name_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let rows = "0,,0,P0\n1,0,1,AB\n2,,2,AB\n3,0,1,P1\n4,2,3,ABa\n5,2,3,ABp\n";
        let table: String = rows.lines().map(|row| format!("{row},1,1\n")).collect();
        std::fs::write(&path, format!("id,parent_id,t,name,y,x\n{table}")).unwrap();
        let Observed { lineage, warnings, .. } = Observed::read(&path, &ObservedOptions::default()).unwrap();
        let mut names: Vec<&str> = lineage.cells.iter().map(|cell| cell.name.as_str()).collect();
        names.sort_unstable();
        assert_eq!(names, ["AB", "AB#2", "ABa", "ABp", "P0", "P1"]);
        assert_eq!(warnings, ["1 cells have the name of another one and get a number behind it: AB#2"]);
        let known = Names::default();
        let sheet = lineage.sheet(&[], &known);
        let mothers = sheet.columns.iter().find(|column| column.name == "mother").unwrap();
        let aba = lineage.cells.iter().position(|cell| cell.name == "ABa").unwrap();
        assert_eq!((mothers.of)(aba).as_deref(), Some("AB#2"));
    }

    /// The lineage file has the same numbers of terminal cells by founder, and the table the same births and divisions.
    #[test]
    fn the_lineage_of_the_worm_is_whole() {
        let lineage = Lineage::c_elegans().unwrap();
        let options = ObservedOptions { names: names_of(&lineage), ..ObservedOptions::default() };
        let ObservedLineage { cells, time, .. } = Observed::read(Path::new(SULSTON1983), &options).unwrap().lineage;
        assert_eq!((cells.len(), time), (1341, TimeUnit::Minutes));
        assert!(cells.iter().all(|cell| cell.daughters[0].is_some() == cell.daughters[1].is_some()));
        let place = |name: &str| cells.iter().position(|cell| cell.name == name).unwrap();
        let below = |name: &str| {
            let (mut left, mut ends) = (vec![place(name)], 0);
            while let Some(cell) = left.pop() {
                let daughters = cells[cell].daughters.iter().flatten();
                ends += u32::from(cells[cell].daughters[0].is_none());
                left.extend(daughters);
            }
            ends
        };
        for founder in &lineage.founders {
            assert_eq!(Some(below(&founder.name)), founder.observed.unwrap().terminal, "{}", founder.name);
        }
        let ems = &cells[place("EMS")];
        assert_eq!(ems.daughters.map(|daughter| cells[daughter.unwrap()].name.as_str()), ["MS", "E"]);
        assert_eq!((cells[0].birth, ems.birth, ems.division), (Some(0.0), Some(62.0), Some(101.0)));
        let given = ObservedOptions { voxel: Some(0.1), ..options };
        assert!(Observed::read(Path::new(SULSTON1983), &given).unwrap_err().to_string().contains("without volumes"));
    }
}
