//! Arrays of Zarr, versions 2 and 3, in folders: numbers and texts in one or two dimensions, plain or compressed.
//!
//! What Python's `geff` writes by default is compressed with Blosc (version 2) or Zstandard (version 3).
//!
//! # References
//! <https://zarr-specs.readthedocs.io>.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::{GzDecoder, ZlibDecoder};
use furrow_input::{InputError, json_field_at, read_text_up_to};
use serde_json::Value;

use super::shards::Shards;

/// Most bytes of a chunk; beyond [`SMALL`], most for each byte of the array's files.
const LONGEST: usize = 1 << 30;
const TIGHTEST: usize = 1000;

/// Bytes of a chunk, and rows of an array, that are few whatever its files hold.
const SMALL: usize = 1 << 26;
const FEW: usize = 1 << 20;

/// Most bytes of a document with metadata.
const LONGEST_METADATA: u64 = 4 << 20;

/// Most columns: edges have two.
const WIDEST: usize = 2;

/// Most rows of ids for each byte of the files with them: ids differ, so that no compression makes them shorter.
const DENSEST: usize = 16;

/// The values of an array, row by row.
#[derive(Debug)]
pub(super) enum Values {
    /// Floating-point numbers.
    Numbers(Vec<f64>),
    /// Whole numbers, to the last digit, and truth values as 0 and 1.
    Integers(Vec<i128>),
    /// Texts.
    Texts(Vec<String>),
}

impl Values {
    /// Numbers; `None` if they are texts.
    pub fn numbers(self) -> Option<Vec<f64>> {
        match self {
            Values::Numbers(numbers) => Some(numbers),
            Values::Integers(numbers) => Some(numbers.into_iter().map(|number| number as f64).collect()),
            Values::Texts(_) => None,
        }
    }

    /// Whole numbers; `None` if they are texts or have fractions.
    pub fn integers(self) -> Option<Vec<i128>> {
        // From 2^53 on not every whole number is a floating-point one.
        let exact = |number: f64| (number.fract() == 0.0 && number.abs() < 9e15).then_some(number as i128);
        match self {
            Values::Integers(numbers) => Some(numbers),
            Values::Numbers(numbers) => numbers.into_iter().map(exact).collect(),
            Values::Texts(_) => None,
        }
    }

    /// Their kind, for a message.
    pub fn kind(&self) -> &'static str {
        match self {
            Values::Numbers(_) => "numbers",
            Values::Integers(_) => "whole numbers",
            Values::Texts(_) => "texts",
        }
    }
}

/// An array.
#[derive(Debug)]
pub(super) struct Array {
    pub shape: Vec<usize>,
    pub values: Values,
}

/// How many rows an array may have. Memory is allocated only after the size of the array's files has been checked.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rows {
    /// As many as its files can hold, which differ.
    Ids,
    /// Exactly this number.
    Exactly(usize),
}

/// How an array is stored.
struct Layout {
    shape: Vec<usize>,
    chunk: Vec<usize>,
    /// The kind of its values, as in a type of version 2: `b`, `u`, `i`, `f`, `U` (UTF-32 of one length) or `O` (UTF-8 of any length).
    kind: char,
    /// Bytes of a value; 0 where they differ.
    size: usize,
    /// Before the numbers of a chunk in the name of its file, and between them.
    separators: [String; 2],
    /// How chunks are compressed.
    codec: Option<String>,
    /// How chunks lie in shards; `None` if each has a file of its own.
    shards: Option<Shards>,
    fill: Value,
}

/// A JSON document.
pub(super) fn json(path: &Path) -> Result<Value, InputError> {
    let (text, file) = (read_text_up_to(path, LONGEST_METADATA)?, path.display().to_string());
    serde_json::from_str(&text).map_err(|error| {
        let at: usize = text.lines().take(error.line().saturating_sub(1)).map(|line| line.len() + 1).sum();
        let field = json_field_at(&text, at + error.column().saturating_sub(1), false);
        let message = if field.is_empty() { error.to_string() } else { format!("{field}: {error}") };
        InputError::Malformed { file, line: error.line().max(1), column: error.column().max(1), message }
    })
}

/// The attributes of a group.
pub(super) fn attributes(folder: &Path) -> Result<Value, InputError> {
    let third = folder.join("zarr.json");
    if third.is_file() {
        return Ok(json(&third)?["attributes"].clone());
    }
    json(&folder.join(".zattrs"))
}

/// Reads an array.
///
/// # Errors
/// Names the file, the field, its value and the allowed values.
pub(super) fn read(folder: &Path, rows: Rows) -> Result<Array, InputError> {
    let third = folder.join("zarr.json");
    let (path, is_third) = if third.is_file() { (third, true) } else { (folder.join(".zarray"), false) };
    let (file, document) = (path.display().to_string(), json(&path)?);
    let refused = |field: &str, value: &Value, allowed: &str| {
        let value = value.to_string();
        Err(InputError::not_allowed(&file, field, value.chars().take(200).collect::<String>(), allowed))
    };
    let lengths = |value: &Value| {
        let each = value.as_array()?.iter().map(|n| n.as_u64().and_then(|n| usize::try_from(n).ok()));
        each.collect::<Option<Vec<usize>>>().filter(|lengths| (1..=2).contains(&lengths.len()))
    };
    let (chunks, kind) = if is_third {
        (&document["chunk_grid"]["configuration"]["chunk_shape"], type_of_third(&document["data_type"]))
    } else {
        (&document["chunks"], type_of_second(document["dtype"].as_str().unwrap_or_default()))
    };
    let Some(shape) = lengths(&document["shape"]) else {
        return refused("shape", &document["shape"], "one or two whole numbers");
    };
    let Some(chunk) = lengths(chunks).filter(|chunk| chunk.len() == shape.len() && !chunk.contains(&0)) else {
        return refused("chunks", chunks, "as many whole numbers above 0 as shape has");
    };
    let Some((kind, size)) = kind else {
        let value = if is_third { &document["data_type"] } else { &document["dtype"] };
        return refused(
            "data type",
            value,
            "integers, floating-point numbers or bool in little-endian order, or text in UTF-32 or, of any length, in UTF-8",
        );
    };
    let is_text = kind == TEXT;
    if is_text && shape.len() > 1 {
        return refused("shape", &document["shape"], "one whole number, for texts");
    }
    if shape.get(1).is_some_and(|width| *width > WIDEST) {
        return refused("shape", &document["shape"], &format!("of at most {WIDEST} columns"));
    }
    let (separators, codec) =
        if is_third { stored_third(&document, is_text) } else { stored_second(&document, is_text) };
    let shards = match &document["codecs"].as_array().map(Vec::as_slice) {
        Some([one]) if is_third => Shards::of(one, &chunk, |codecs| coded_third(codecs, is_text).ok()),
        _ => None,
    };
    let codec = match codec {
        _ if shards.is_some() => None,
        Ok(codec) => codec,
        Err(value) => return refused("codecs", &value, ALLOWED_CODECS),
    };
    let fill = document["fill_value"].clone();
    let layout = Layout { shape, chunk, kind, size, separators, codec, shards, fill };
    let files = layout.files(folder)?;
    let held = files.iter().fold(0_usize, |sum, file| sum.saturating_add(file.length));
    let most = SMALL.max(held.saturating_mul(TIGHTEST)).min(LONGEST);
    if layout.chunk.iter().try_fold(size, |n, k| n.checked_mul(*k)).is_none_or(|bytes| bytes > most) {
        let allowed = format!("of at most {} MB: the array's files have {held} bytes", most >> 20);
        return refused("chunks", chunks, &allowed);
    }
    let (most, allowed) = layout.most(rows, &files, held);
    if layout.shape[0] > most {
        return refused("shape", &document["shape"], &allowed);
    }
    layout.read(&files)
}

/// Kind and bytes of a type of version 2, such as `<f8`.
fn type_of_second(text: &str) -> Option<(char, usize)> {
    if text == "|O" {
        return Some((TEXT, 0));
    }
    let rest = text.strip_prefix(['<', '|'])?;
    let (kind, count) = (rest.chars().next()?, rest.get(1..)?.parse::<usize>().ok()?);
    known(kind, if kind == 'U' { count.checked_mul(4)? } else { count })
}

/// The same of a type of version 3, such as `float64`.
fn type_of_third(value: &Value) -> Option<(char, usize)> {
    if value["name"] == "fixed_length_utf32" {
        return known('U', value["configuration"]["length_bytes"].as_u64()?.try_into().ok()?);
    }
    let text = value.as_str()?;
    match text {
        "bool" => return known('b', 1),
        "string" => return Some((TEXT, 0)),
        _ => {}
    }
    let at = text.find(|c: char| c.is_ascii_digit())?;
    let kind = ["uint", "int", "float"].iter().position(|name| *name == &text[..at])?;
    known(['u', 'i', 'f'][kind], text[at..].parse::<usize>().ok()? / 8)
}

/// A type, if it can be read.
fn known(kind: char, size: usize) -> Option<(char, usize)> {
    let fine = match kind {
        'b' => size == 1,
        'u' | 'i' => [1, 2, 4, 8].contains(&size),
        'f' => [4, 8].contains(&size),
        'U' => size.is_multiple_of(4) && size <= 1 << 20,
        _ => false,
    };
    fine.then_some((kind, size))
}

/// The kind of texts of any length, and the codec that writes them.
const TEXT: char = 'O';
const OF_TEXTS: &str = "vlen-utf8";

/// The allowed codecs.
const ALLOWED_CODECS: &str =
    "none, zlib, gzip, zstd or blosc, for values in rows and little-endian order or texts by vlen-utf8, also in shards";

/// The separators in names of chunks, and the compression, or the unknown codec.
type Stored = ([String; 2], Result<Option<String>, Value>);

fn stored_second(document: &Value, is_text: bool) -> Stored {
    let separator = document["dimension_separator"].as_str().unwrap_or(".").to_owned();
    let (compressor, filters) = (&document["compressor"], &document["filters"]);
    let filters_are_right = match filters.as_array().map_or(&[][..], Vec::as_slice) {
        [] => !is_text,
        [one] => is_text && one["id"] == OF_TEXTS,
        _ => false,
    };
    let codec = if !filters_are_right {
        Err(filters.clone())
    } else if document["order"] == "F" {
        Err("order F".into())
    } else {
        coded(compressor, &compressor["id"])
    };
    ([String::new(), separator], codec)
}

fn stored_third(document: &Value, is_text: bool) -> Stored {
    let encoding = &document["chunk_key_encoding"];
    let is_second = encoding["name"] == "v2";
    let separator = encoding["configuration"]["separator"].as_str().unwrap_or(if is_second { "." } else { "/" });
    let prefix = if is_second { String::new() } else { format!("c{separator}") };
    ([prefix, separator.to_owned()], coded_third(&document["codecs"], is_text))
}

/// The compression in a list of codecs of version 3.
fn coded_third(codecs: &Value, is_text: bool) -> Result<Option<String>, Value> {
    let is_right = |first: &Value| match is_text {
        true => first["name"] == OF_TEXTS,
        false => first["name"] == "bytes" && first["configuration"]["endian"] != "big",
    };
    match codecs.as_array().map_or(&[][..], Vec::as_slice) {
        [first] if is_right(first) => Ok(None),
        [first, one] if is_right(first) => coded(one, &one["name"]),
        _ => Err(codecs.clone()),
    }
}

/// A compression by its name.
fn coded(codec: &Value, name: &Value) -> Result<Option<String>, Value> {
    match name.as_str() {
        None if codec.is_null() => Ok(None),
        Some(name) if ["zlib", "gzip", "zstd", "blosc"].contains(&name) => Ok(Some(name.to_owned())),
        _ => Err(codec.clone()),
    }
}

/// The file of a chunk.
struct ChunkFile {
    path: PathBuf,
    /// Its place in the grid of chunks.
    place: [usize; 2],
    /// Bytes.
    length: usize,
}

impl Layout {
    /// Most rows, and how a larger number is refused. The files have `held` bytes.
    fn most(&self, rows: Rows, files: &[ChunkFile], held: usize) -> (usize, String) {
        match rows {
            Rows::Exactly(rows) => (rows, format!("{rows} rows, one for each node")),
            Rows::Ids => {
                let most = self.chunk[0].saturating_mul(files.len()).min(FEW.max(held.saturating_mul(DENSEST)));
                (most, format!("at most {most} rows: the array's files have {held} bytes"))
            }
        }
    }

    /// The files of chunks. Chunks without a file are of fill values only: there may be very many.
    fn files(&self, folder: &Path) -> Result<Vec<ChunkFile>, InputError> {
        let mut found = Vec::new();
        let mut folders = vec![(folder.to_owned(), String::new())];
        while let Some((folder, before)) = folders.pop() {
            let unreadable = |e: std::io::Error| InputError::unreadable(&folder, e);
            for entry in fs::read_dir(&folder).map_err(unreadable)? {
                let path = entry.map_err(unreadable)?.path();
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let key = format!("{before}{name}");
                if path.is_dir() {
                    // The deepest are c/0/0.
                    if before.split('/').count() < 3 {
                        folders.push((path, key + "/"));
                    }
                } else if let Some(place) = self.place(&key).filter(|_| path.is_file()) {
                    let length = path.metadata().map_err(unreadable)?.len();
                    found.push(ChunkFile { path, place, length: usize::try_from(length).unwrap_or(usize::MAX) });
                }
            }
        }
        found.sort_by_cached_key(|file| file.place);
        Ok(found)
    }

    /// The place of a chunk in the grid by the name of its file; `None` for other files.
    fn place(&self, key: &str) -> Option<[usize; 2]> {
        let [prefix, separator] = &self.separators;
        let numbers: Option<Vec<usize>> =
            key.strip_prefix(&**prefix)?.split(&**separator).map(|n| n.parse().ok()).collect();
        let numbers = numbers.filter(|numbers| numbers.len() == self.shape.len())?;
        let inside = |(k, at): (usize, &usize)| *at < self.shape[k].div_ceil(self.chunk[k]);
        let place = [numbers[0], numbers.get(1).copied().unwrap_or(0)];
        numbers.iter().enumerate().all(inside).then_some(place)
    }

    /// Reads the values of all chunks.
    fn read(self, files: &[ChunkFile]) -> Result<Array, InputError> {
        let mut values = self.filled(self.shape.iter().product());
        let length = |lengths: &[usize]| [lengths[0], lengths.get(1).copied().unwrap_or(1)];
        let [rows, columns] = length(&self.chunk);
        for file in files {
            let packed = fs::read(&file.path).map_err(|e| InputError::unreadable(&file.path, e))?;
            let refused = |why: String| InputError::other_file(file.path.display(), "a chunk of an array", why);
            let [row, column] = [file.place[0] * rows, file.place[1] * columns];
            let Some(shards) = &self.shards else {
                let bytes = self.unpacked(packed, self.codec.as_deref(), &self.chunk).map_err(refused)?;
                self.place_values(&bytes, [row, column], [rows, columns], &mut values).map_err(refused)?;
                continue;
            };
            let [inner_rows, inner_columns] = length(&shards.chunk);
            for ([i, j], packed) in shards.chunks(&self.chunk, &packed).map_err(refused)? {
                let bytes = self.unpacked(packed.to_vec(), shards.codec.as_deref(), &shards.chunk).map_err(refused)?;
                let at = [row + i * inner_rows, column + j * inner_columns];
                self.place_values(&bytes, at, [inner_rows, inner_columns], &mut values).map_err(refused)?;
            }
        }
        Ok(Array { shape: self.shape, values })
    }

    /// Puts the values of a chunk of `length` rows and columns to a row and column of the array. Chunks at the edge are as long as others;
    /// what lies beyond the array is not used.
    fn place_values(
        &self,
        bytes: &[u8],
        [row, column]: [usize; 2],
        length: [usize; 2],
        values: &mut Values,
    ) -> Result<(), String> {
        if let (TEXT, Values::Texts(all)) = (self.kind, &mut *values) {
            let places = all.iter_mut().skip(row).take(length[0]);
            let found = texts(bytes, places.len())?;
            places.zip(found).for_each(|(value, text)| *value = text);
            return Ok(());
        }
        let (rows, columns) = (self.shape[0], self.shape.get(1).copied().unwrap_or(1));
        let [height, width] = [length[0].min(rows.saturating_sub(row)), length[1].min(columns.saturating_sub(column))];
        for k in 0..height {
            let from = k * length[1] * self.size;
            self.decode(&bytes[from..from + width * self.size], values, (row + k) * columns + column);
        }
        Ok(())
    }

    /// Values that no chunk gives.
    fn filled(&self, count: usize) -> Values {
        let fill = &self.fill;
        let whole = fill.as_i64().map(i128::from).or(fill.as_u64().map(i128::from)).or(fill.as_bool().map(i128::from));
        match self.kind {
            // A text that all nodes share cannot distinguish them.
            'U' | TEXT => Values::Texts(vec![String::new(); count]),
            'f' => Values::Numbers(vec![fill.as_f64().unwrap_or(f64::NAN); count]),
            _ => Values::Integers(vec![whole.unwrap_or(0); count]),
        }
    }

    /// The bytes of a chunk of this shape.
    fn unpacked(&self, packed: Vec<u8>, codec: Option<&str>, chunk: &[usize]) -> Result<Vec<u8>, String> {
        if self.kind == TEXT {
            return unpacked(packed, codec, SMALL);
        }
        let count: usize = chunk.iter().product();
        let bytes = unpacked(packed, codec, count * self.size)?;
        if bytes.len() != count * self.size {
            return Err(format!("it has {} bytes; {count} values have {}", bytes.len(), count * self.size));
        }
        Ok(bytes)
    }

    /// The values in some bytes, from `to` on.
    fn decode(&self, bytes: &[u8], values: &mut Values, to: usize) {
        let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte));
        let float = |bytes: &[u8]| match bytes.len() {
            4 => f64::from(f32::from_bits(word(bytes) as u32)),
            _ => f64::from_bits(word(bytes)),
        };
        let integer = |bytes: &[u8]| {
            let (bits, unused) = (word(bytes), 64 - 8 * bytes.len());
            // The highest bit is the sign.
            if self.kind == 'i' { i128::from((bits << unused) as i64 >> unused) } else { i128::from(bits) }
        };
        let text = |bytes: &[u8]| {
            let points = bytes.chunks_exact(4).map(|point| word(point) as u32).take_while(|point| *point != 0);
            points.map(|point| char::from_u32(point).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        };
        let each = bytes.chunks_exact(self.size.max(1));
        match values {
            Values::Numbers(all) => all[to..].iter_mut().zip(each).for_each(|(value, bytes)| *value = float(bytes)),
            Values::Integers(all) => all[to..].iter_mut().zip(each).for_each(|(value, bytes)| *value = integer(bytes)),
            Values::Texts(all) => all[to..].iter_mut().zip(each).for_each(|(value, bytes)| *value = text(bytes)),
        }
    }
}

/// The texts of a chunk, at most this many: their number, then the length and the bytes of each.
fn texts(bytes: &[u8], most: usize) -> Result<Vec<String>, String> {
    const SHORT: &str = "it ends within a text";
    let number = |rest: &[u8]| rest.first_chunk::<4>().map(|bytes| u32::from_le_bytes(*bytes) as usize).ok_or(SHORT);
    let (count, mut rest) = (number(bytes)?, bytes.get(4..).ok_or(SHORT)?);
    let mut found = Vec::new();
    for _ in 0..count.min(most) {
        let length = number(rest)?;
        let text = rest.get(4..).and_then(|rest| rest.get(..length)).ok_or(SHORT)?;
        found.push(String::from_utf8_lossy(text).into_owned());
        rest = &rest[4 + length..];
    }
    Ok(found)
}

/// The bytes of a chunk.
fn unpacked(packed: Vec<u8>, codec: Option<&str>, length: usize) -> Result<Vec<u8>, String> {
    let Some(codec) = codec else { return Ok(packed) };
    let mut out = Vec::new();
    // One byte more than expected: the chunk is longer.
    let read = match codec {
        "zlib" => ZlibDecoder::new(&packed[..]).take(length as u64 + 1).read_to_end(&mut out),
        "gzip" => GzDecoder::new(&packed[..]).take(length as u64 + 1).read_to_end(&mut out),
        _ => return super::unpack::unpacked(&packed, codec, length),
    };
    read.map_err(|e| e.to_string())?;
    Ok(out)
}
