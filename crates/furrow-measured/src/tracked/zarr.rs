//! Arrays of Zarr, versions 2 and 3, in folders: numbers and texts in one or two dimensions, plain or compressed.
//!
//! What Python's `geff` writes by default is compressed with Blosc (version 2) or Zstandard (version 3), which the feature `geff`
//! reads.
//!
//! # References
//! <https://zarr-specs.readthedocs.io>.

use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::read::{GzDecoder, ZlibDecoder};
use furrow_input::{InputError, json_field_at, read_text};
use serde_json::Value;

/// Most bytes of an array.
const LONGEST: usize = 1 << 30;

/// The values of an array, row by row.
#[derive(Debug)]
pub(super) enum Values {
    /// Numbers, and truth values as 0 and 1.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// An array.
#[derive(Debug)]
pub(super) struct Array {
    pub shape: Vec<usize>,
    pub values: Values,
}

/// How an array is stored.
struct Layout {
    shape: Vec<usize>,
    chunk: Vec<usize>,
    /// The kind of its values, as in a type of version 2: `b`, `u`, `i`, `f` or `U` (UTF-32 of one length).
    kind: char,
    /// Bytes of a value.
    size: usize,
    /// Before the numbers of a chunk in the name of its file, and between them.
    separators: [String; 2],
    /// How chunks are compressed.
    codec: Option<String>,
    fill: Value,
}

/// A JSON document.
pub(super) fn json(path: &Path) -> Result<Value, InputError> {
    let (text, file) = (read_text(path)?, path.display().to_string());
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
/// Names the file, the field, its value and what is allowed.
pub(super) fn read(folder: &Path) -> Result<Array, InputError> {
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
            "integers, floating-point numbers or bool in little-endian order, or text in UTF-32",
        );
    };
    let bytes = |of: &[usize]| of.iter().try_fold(size.max(4), |n, k| n.checked_mul(*k));
    if [&shape, &chunk].iter().any(|of| bytes(of).is_none_or(|bytes| bytes > LONGEST)) {
        return refused("shape", &document["shape"], &format!("of at most {} MB", LONGEST >> 20));
    }
    let (separators, codec) = if is_third { stored_third(&document) } else { stored_second(&document) };
    let codec = match codec {
        Ok(codec) => codec,
        Err(value) => return refused("codecs", &value, ALLOWED_CODECS),
    };
    let fill = document["fill_value"].clone();
    read_chunks(folder, Layout { shape, chunk, kind, size, separators, codec, fill })
}

/// Kind and bytes of a type of version 2, such as `<f8`.
fn type_of_second(text: &str) -> Option<(char, usize)> {
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
    if text == "bool" {
        return known('b', 1);
    }
    let at = text.find(|c: char| c.is_ascii_digit())?;
    let kind = ["uint", "int", "float"].iter().position(|name| *name == &text[..at])?;
    known(['u', 'i', 'f'][kind], text[at..].parse::<usize>().ok()? / 8)
}

/// A type, if it is one that is read.
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

/// What is allowed of codecs.
const ALLOWED_CODECS: &str = "none, zlib, gzip, zstd or blosc, for values in rows and little-endian order";

/// The separators in names of chunks, and the compression, or the codec that is not known.
type Stored = ([String; 2], Result<Option<String>, Value>);

fn stored_second(document: &Value) -> Stored {
    let separator = document["dimension_separator"].as_str().unwrap_or(".").to_owned();
    let (compressor, filters) = (&document["compressor"], &document["filters"]);
    let codec = if filters.as_array().is_some_and(|all| !all.is_empty()) {
        Err(filters.clone())
    } else if document["order"] == "F" {
        Err("order F".into())
    } else {
        coded(compressor, &compressor["id"])
    };
    ([String::new(), separator], codec)
}

fn stored_third(document: &Value) -> Stored {
    let encoding = &document["chunk_key_encoding"];
    let is_second = encoding["name"] == "v2";
    let separator = encoding["configuration"]["separator"].as_str().unwrap_or(if is_second { "." } else { "/" });
    let prefix = if is_second { String::new() } else { format!("c{separator}") };
    let codecs = document["codecs"].as_array().map_or(&[][..], Vec::as_slice);
    let codec = match codecs {
        [bytes, rest @ ..] if bytes["name"] == "bytes" && bytes["configuration"]["endian"] != "big" => match rest {
            [] => Ok(None),
            [one] => coded(one, &one["name"]),
            _ => Err(document["codecs"].clone()),
        },
        _ => Err(document["codecs"].clone()),
    };
    ([prefix, separator.to_owned()], codec)
}

/// A compression by its name.
fn coded(codec: &Value, name: &Value) -> Result<Option<String>, Value> {
    match name.as_str() {
        None if codec.is_null() => Ok(None),
        Some(name) if ["zlib", "gzip", "zstd", "blosc"].contains(&name) => Ok(Some(name.to_owned())),
        _ => Err(codec.clone()),
    }
}

fn read_chunks(folder: &Path, layout: Layout) -> Result<Array, InputError> {
    let Layout { shape, chunk, fill, .. } = &layout;
    let (rows, columns) = (shape[0], shape.get(1).copied().unwrap_or(1));
    let (chunk_rows, chunk_columns) = (chunk[0], chunk.get(1).copied().unwrap_or(1));
    let is_text = layout.kind == 'U';
    let (mut numbers, mut texts) = (Vec::new(), Vec::new());
    if is_text {
        texts = vec![fill.as_str().unwrap_or_default().to_owned(); rows * columns];
    } else {
        let fill = fill.as_f64().or(fill.as_bool().map(f64::from)).unwrap_or(f64::NAN);
        numbers = vec![fill; rows * columns];
    }
    for i in 0..rows.div_ceil(chunk_rows) {
        for j in 0..columns.div_ceil(chunk_columns) {
            let Some(values) = read_chunk(folder, &layout, [i, j])? else { continue };
            // Chunks at the edge are as long as others; what lies beyond the array is not used.
            for row in 0..chunk_rows.min(rows - i * chunk_rows) {
                let width = chunk_columns.min(columns - j * chunk_columns);
                let (from, to) = (row * chunk_columns, (i * chunk_rows + row) * columns + j * chunk_columns);
                match &values {
                    Values::Numbers(found) => numbers[to..to + width].copy_from_slice(&found[from..from + width]),
                    Values::Texts(found) => texts[to..to + width].clone_from_slice(&found[from..from + width]),
                }
            }
        }
    }
    let values = if is_text { Values::Texts(texts) } else { Values::Numbers(numbers) };
    Ok(Array { shape: layout.shape, values })
}

/// The values of a chunk; `None` if it has no file, as of fill values only.
fn read_chunk(folder: &Path, layout: &Layout, place: [usize; 2]) -> Result<Option<Values>, InputError> {
    let [prefix, separator] = &layout.separators;
    let numbers: Vec<String> = place[..layout.shape.len()].iter().map(usize::to_string).collect();
    let path = folder.join(format!("{prefix}{}", numbers.join(separator)));
    let file = path.display().to_string();
    if !path.is_file() {
        return Ok(None);
    }
    let packed = fs::read(&path).map_err(|e| InputError::Unreadable { file: file.clone(), reason: e.to_string() })?;
    let refused = |why: String| InputError::other_file(&file, "a chunk of an array", why);
    let count: usize = layout.chunk.iter().product();
    let bytes = unpacked(packed, layout.codec.as_deref(), count * layout.size).map_err(refused)?;
    if bytes.len() != count * layout.size {
        return Err(refused(format!("it has {} bytes; {count} values have {}", bytes.len(), count * layout.size)));
    }
    let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte));
    let number = |bytes: &[u8]| {
        let (bits, unused) = (word(bytes), 64 - 8 * bytes.len());
        match (layout.kind, bytes.len()) {
            ('f', 4) => f64::from(f32::from_bits(bits as u32)),
            ('f', _) => f64::from_bits(bits),
            // The highest bit is the sign.
            ('i', _) => ((bits << unused) as i64 >> unused) as f64,
            _ => bits as f64,
        }
    };
    let text = |bytes: &[u8]| {
        let points = bytes.chunks_exact(4).map(|point| word(point) as u32).take_while(|point| *point != 0);
        points.map(|point| char::from_u32(point).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    let each = bytes.chunks_exact(layout.size.max(1));
    Ok(Some(if layout.kind == 'U' {
        Values::Texts(each.map(text).collect())
    } else {
        Values::Numbers(each.map(number).collect())
    }))
}

/// The bytes of a chunk.
fn unpacked(packed: Vec<u8>, codec: Option<&str>, length: usize) -> Result<Vec<u8>, String> {
    let Some(codec) = codec else { return Ok(packed) };
    let mut out = Vec::new();
    // One byte more than there should be shows a chunk that is longer.
    let read = match codec {
        "zlib" => ZlibDecoder::new(&packed[..]).take(length as u64 + 1).read_to_end(&mut out),
        "gzip" => GzDecoder::new(&packed[..]).take(length as u64 + 1).read_to_end(&mut out),
        _ => return super::unpack::unpacked(&packed, codec, length),
    };
    read.map_err(|e| e.to_string())?;
    Ok(out)
}
