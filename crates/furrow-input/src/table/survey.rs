//! How a table writes numbers, and whether its rows have names, from its first megabyte.

use csv::ByteRecord;

use super::number::Columns;
use super::{is_comment, is_empty, reader};

/// What was found in the first megabyte.
#[derive(Debug, Default)]
pub(super) struct Survey {
    /// How numbers are written.
    pub(super) columns: Columns,
    /// Whether each row has a name that the heading lacks, as R writes tables.
    pub(super) has_row_names: bool,
}

/// The rows below a heading, while they may have names.
#[derive(Default)]
struct Named {
    rows: u64,
    are_quoted: bool,
    are_counted: bool,
}

impl Survey {
    /// Surveys the beginning of a table; where it is not the whole table, its last row may be cut.
    pub(super) fn of(separator: u8, head: &[u8], is_whole: bool) -> Survey {
        let mut survey = Survey { columns: Columns::of(separator), has_row_names: false };
        // Numbers and names of rows need quotes where commas separate columns.
        if separator == b',' && !head.contains(&b'"') {
            return survey;
        }
        let lines = if is_whole { head.len() } else { head.iter().rposition(|byte| *byte == b'\n').unwrap_or(0) };
        let (mut reader, mut record) = (reader(separator).from_reader(&head[..lines]), ByteRecord::new());
        let mut heading = None;
        let mut named = Some(Named { rows: 0, are_quoted: true, are_counted: true });
        while reader.read_byte_record(&mut record).is_ok_and(|more| more) {
            if is_comment(&record) || is_empty(&record) {
                continue;
            }
            record.iter().enumerate().for_each(|(column, field)| survey.columns.note(column, field));
            let start = record.position().and_then(|at| head.get(at.byte() as usize..)).unwrap_or_default();
            let is_quoted = start.trim_ascii_start().starts_with(b"\"");
            match heading {
                None => heading = Some((record.len(), is_quoted)),
                Some((fields, of_heading)) => {
                    named = named
                        .filter(|_| record.len() == fields + 1)
                        .map(|named| named.with(&record, is_quoted && of_heading));
                }
            }
        }
        survey.has_row_names = named.is_some_and(|named| named.are_names(separator));
        survey
    }
}

impl Named {
    fn with(self, record: &ByteRecord, is_quoted: bool) -> Named {
        let rows = self.rows + 1;
        let is_counted = record.get(0).is_some_and(|field| field == rows.to_string().as_bytes());
        Named { rows, are_quoted: self.are_quoted && is_quoted, are_counted: self.are_counted && is_counted }
    }

    /// Whether the first fields are names of rows and no data: a decimal comma makes a row longer, too, and a last column may
    /// lack its name.
    fn are_names(&self, separator: u8) -> bool {
        let is_of_programs = [b'\t', b' '].contains(&separator);
        self.rows > 0
            && if is_of_programs { self.are_quoted || self.are_counted } else { self.are_quoted && self.are_counted }
    }
}

#[cfg(test)]
mod tests {
    use crate::table::Table;

    /// The heading, and line and fields of each row.
    fn read(table: &str) -> (Vec<String>, Vec<(u64, Vec<String>)>) {
        let mut table = Table::open(table.as_bytes(), "t.csv").unwrap();
        let (_, heading) = table.header(|_| false).unwrap();
        let mut rows = Vec::new();
        while let Some(row) = table.next_row().unwrap() {
            let fields = (0..row.len()).map(|column| String::from_utf8_lossy(row.text(column)).into_owned());
            rows.push((row.line, fields.collect()));
        }
        (heading, rows)
    }

    #[test]
    fn tables_of_r_have_names_of_rows() {
        let rows = [(2, ["1", "AB", "59.5"]), (3, ["2", "P1", "40"])];
        let rows = rows.map(|(line, fields)| (line, fields.map(str::to_owned).to_vec())).to_vec();
        let expected = (vec![String::new(), "cell".to_owned(), "volume".to_owned()], rows);
        for separator in [" ", "\t", ",", ";"] {
            let table = "'cell'|'volume'\n'1'|'AB'|59.5\n'2'|'P1'|40\n".replace('\'', "\"").replace('|', separator);
            assert_eq!(read(&table), expected, "{table}");
        }
        assert_eq!(read("cell\tvolume\n1\tAB\t59.5\n2\tP1\t40\n"), expected);
        // A decimal comma makes rows longer, and a last column may lack its name.
        for table in ["cell,volume\nAB,59,5\nP1,40,5\n", "embryo;volume\n1;59;good\n2;40;bad\n"] {
            assert_eq!(read(table).0.len(), 2, "{table}");
        }
    }

    #[test]
    fn blanks_separate_columns_where_nothing_else_does() {
        let (heading, rows) = read("  cell   volume\n \"AB al\"   59.5 \nP1 40\n");
        assert_eq!(heading, ["cell", "volume"]);
        assert_eq!(rows[0].1[..2], ["AB al", "59.5"]);
        assert_eq!(rows[1], (3, vec!["P1".to_owned(), "40".to_owned()]));
    }

    #[test]
    fn a_carriage_return_alone_ends_a_line() {
        let (heading, rows) = read("cell,volume\rAB,59.5\r\rP1,40\r");
        let lines: Vec<u64> = rows.iter().map(|(line, _)| *line).collect();
        assert_eq!((heading, lines), (vec!["cell".to_owned(), "volume".to_owned()], vec![2, 4]));
    }

    /// Commas in headings may come before units.
    #[test]
    fn columns_are_separated_as_the_data_are() {
        for (table, columns) in [
            ("cell;lifetime, min\nAB;17,9\n", ["cell", "lifetime, min"]),
            ("cell\tlifetime, min\nAB\t17.9\n", ["cell", "lifetime, min"]),
            ("AB, µm³;P1, µm³\n14596,5;10120,1\n", ["AB, µm³", "P1, µm³"]),
            ("cell,note; more\nAB,a; b\n", ["cell", "note; more"]),
            ("cell,volume\nAB,12;5\n", ["cell", "volume"]),
            ("# cell,volume\nAB,12\n", ["AB", "12"]),
        ] {
            assert_eq!(read(table).0, columns, "{table}");
        }
        let mut table = Table::open(&b"# AB,P1\n1,2\n"[..], "t.csv").unwrap();
        assert_eq!(table.header(|names| names[0] == "AB").unwrap().1, ["AB", "P1"]);
    }
}
