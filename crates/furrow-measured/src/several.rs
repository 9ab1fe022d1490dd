//! Embryos that several tables give one name.
//!
//! Tables of one embryo have different cells of it: their cells are joined. If a cell has values in two tables, the embryos differ
//! and are called by their tables too, as `mon/1`. A table of volumes that repeats another adds nothing.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::events::Division;
use crate::layout::embryo_of_file;
use crate::statistics::grouped;
use crate::volumes::{Embryo, Skipped, Volumes, note};

/// An embryo's name in its table, and the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) file: String,
}

impl Source {
    /// The name with the table's, or with the folder's where the table is named after the embryo; `is_whole` gives the whole path.
    fn label(&self, is_whole: bool) -> String {
        let Source { name, file } = self;
        let path = Path::new(file).with_extension("");
        let part = |path: Option<&Path>| path.and_then(Path::file_name).map(|part| part.to_string_lossy().into_owned());
        let own = if embryo_of_file(file) == *name { part(path.parent()) } else { part(Some(&path)) };
        match own.filter(|_| !is_whole) {
            Some(own) => format!("{own}/{name}"),
            None => format!("{}/{name}", path.display()),
        }
    }

    /// The names of two embryos.
    pub(crate) fn labels(sources: [&Source; 2]) -> [String; 2] {
        let [a, b] = sources.map(|source| source.label(false));
        if a == b { sources.map(|source| source.label(true)) } else { [a, b] }
    }
}

/// How two embryos of one name compare.
enum Kinship {
    /// No cell is in both.
    Parts,
    /// Every cell of the second is in the first, with the same value.
    Repeated,
    /// A cell has two values.
    Others,
}

impl Kinship {
    /// `shared` tells of each value of the second whether the first has it: with the same value, with another, or not at all.
    fn of(shared: impl Iterator<Item = Option<bool>>) -> Kinship {
        let shared: Vec<Option<bool>> = shared.collect();
        match () {
            () if shared.iter().all(Option::is_none) => Kinship::Parts,
            () if shared.iter().all(|same| *same == Some(true)) => Kinship::Repeated,
            () => Kinship::Others,
        }
    }
}

/// The places of divisions by the embryo's name in its table and the group.
fn by_embryo(sources: &[Source], divisions: &[Division]) -> HashMap<(String, String), Vec<usize>> {
    let name = |(source, division): (&Source, &Division)| (source.name.clone(), division.group.clone());
    grouped(sources.iter().zip(divisions).map(name).zip(0..)).into_iter().collect()
}

impl Volumes {
    /// Compares the embryos that a table has added, from number `first` on, with those before.
    pub(crate) fn join_embryos(&mut self, first: usize) {
        let new = self.embryos.split_off(first);
        for embryo in new {
            let is_namesake =
                |other: &&mut Embryo| other.group == embryo.group && other.source.name == embryo.source.name;
            let mut parts = None;
            let (mut labels, mut repeated) = (None, false);
            for other in self.embryos[..first].iter_mut().filter(is_namesake) {
                let known = |cell: &str| other.cells.iter().find(|other| other.cell == cell && other.frames > 0);
                let measured = embryo.cells.iter().filter(|cell| cell.frames > 0);
                match Kinship::of(measured.map(|cell| Some(known(&cell.cell)?.volume() == cell.volume()))) {
                    Kinship::Parts => parts = parts.or(Some(other)),
                    Kinship::Repeated => repeated = true,
                    Kinship::Others => {
                        let [theirs, own] = Source::labels([&other.source, &embryo.source]);
                        if other.name == other.source.name {
                            other.name = theirs;
                        }
                        labels = Some(own);
                    }
                }
            }
            match (repeated, labels, parts) {
                (true, ..) => self.skip_embryo(&embryo),
                (false, Some(name), _) => self.embryos.push(Embryo { name, ..embryo }),
                (false, None, Some(other)) => {
                    other.cells.retain(|cell| cell.frames > 0);
                    other.cells.extend(embryo.cells.into_iter().filter(|cell| cell.frames > 0));
                }
                (false, None, None) => self.embryos.push(embryo),
            }
        }
    }

    fn skip_embryo(&mut self, embryo: &Embryo) {
        for cell in embryo.cells.iter().filter(|cell| cell.frames > 0) {
            self.used -= cell.frames;
            let why = "the same volume of this cell in another table";
            let (file, column, value) = (embryo.source.file.clone(), "cell".to_owned(), cell.cell.clone());
            let skipped = || Skipped { file, line: cell.line, column, value, why: why.to_owned() };
            note(&mut self.skipped, &mut self.skipped_count, skipped);
        }
    }

    /// Compares the embryos of divisions that a table has added, from number `first` on, with those before. Each division is of `values`
    /// beside its mother's volume.
    pub(crate) fn join_divisions(&mut self, first: usize, values: u64) {
        let (before, new) = self.divisions.split_at_mut(first);
        let (sources, own) = self.division_sources.split_at(first);
        let known = by_embryo(sources, before);
        let mut repeated: HashSet<usize> = HashSet::new();
        for (name, here) in by_embryo(own, new) {
            let Some(there) = known.get(&name) else { continue };
            let others = there.iter().map(|other| &before[*other]);
            let mothers: HashMap<&str, Vec<&Division>> =
                grouped(others.map(|other| (other.mother.as_str(), other))).into_iter().collect();
            let has = |k: &usize| {
                let others = mothers.get(new[*k].mother.as_str())?;
                Some(
                    others.iter().any(|other| other.volumes == new[*k].volumes && other.daughters == new[*k].daughters),
                )
            };
            match Kinship::of(here.iter().map(has)) {
                Kinship::Parts => continue,
                Kinship::Repeated => {
                    repeated.extend(here);
                    continue;
                }
                Kinship::Others => {}
            }
            let own = &own[here[0]];
            let mut label = own.label(false);
            for other in there {
                let [theirs, mine] = Source::labels([&sources[*other], own]);
                if before[*other].embryo == sources[*other].name {
                    before[*other].embryo = theirs;
                }
                label = mine;
            }
            here.into_iter().for_each(|j| new[j].embryo.clone_from(&label));
        }
        self.skip_divisions((first, values), &repeated);
    }

    /// Takes out the divisions from number `first` on that a table before has too, each of `values` beside its mother's volume.
    fn skip_divisions(&mut self, (first, values): (usize, u64), repeated: &HashSet<usize>) {
        let new = self.divisions.split_off(first).into_iter().zip(self.division_sources.split_off(first));
        for (k, (division, source)) in new.enumerate() {
            if !repeated.contains(&k) {
                self.divisions.push(division);
                self.division_sources.push(source);
                continue;
            }
            self.used -= values + u64::from(division.mother_measured.is_some());
            let mother = division.daughters[0].rsplit_once(' ').map_or("", |(mother, _)| mother).to_owned();
            let key = [source.file.clone(), source.name, division.group, mother];
            let line = self.division_lines.get(&key).copied().unwrap_or_default();
            let ([.., mother], file, column) = (key, source.file, "mother".to_owned());
            let why = "the same division in another table".to_owned();
            note(&mut self.skipped, &mut self.skipped_count, || Skipped { file, line, column, value: mother, why });
        }
    }
}
