//! Shards of Zarr, version 3: files that each hold many chunks, with an index of where each begins.
//!
//! # References
//! <https://zarr-specs.readthedocs.io/en/latest/v3/codecs/sharding-indexed>.

use serde_json::Value;

/// Bytes of a number of the index, and of its checksum, which is not compared.
const NUMBER: usize = 8;
const CHECKSUM: usize = 4;

/// The place of a chunk among the chunks of a shard, and its bytes.
type Chunk<'b> = ([usize; 2], &'b [u8]);

/// How chunks lie in shards.
#[derive(Debug)]
pub(super) struct Shards {
    /// The shape of a chunk.
    pub chunk: Vec<usize>,
    /// How chunks are compressed.
    pub codec: Option<String>,
    /// Whether the index is at the end.
    is_last: bool,
    /// Whether a checksum follows the index.
    is_checked: bool,
}

impl Shards {
    /// The shards that a codec describes, of an array with shards of this shape; `None` for other codecs. `coded` reads the codecs of
    /// chunks.
    pub fn of(codec: &Value, shard: &[usize], coded: impl Fn(&Value) -> Option<Option<String>>) -> Option<Shards> {
        let about = Some(&codec["configuration"]).filter(|_| codec["name"] == "sharding_indexed")?;
        let lengths = about["chunk_shape"].as_array()?.iter().map(|n| n.as_u64().and_then(|n| usize::try_from(n).ok()));
        let chunk = lengths.collect::<Option<Vec<usize>>>()?;
        let divides = |(inner, outer): (&usize, &usize)| *inner > 0 && outer.is_multiple_of(*inner);
        if chunk.len() != shard.len() || !chunk.iter().zip(shard).all(divides) {
            return None;
        }
        let of_index: Vec<&str> =
            about["index_codecs"].as_array()?.iter().filter_map(|one| one["name"].as_str()).collect();
        let is_checked = match of_index[..] {
            ["bytes"] => false,
            ["bytes", "crc32c"] => true,
            _ => return None,
        };
        let is_last = about["index_location"] != "start";
        Some(Shards { codec: coded(&about["codecs"])?, chunk, is_last, is_checked })
    }

    /// The chunks of a shard of this shape that have bytes: the place of each among the chunks, and its bytes.
    pub fn chunks<'b>(&self, shard: &[usize], bytes: &'b [u8]) -> Result<Vec<Chunk<'b>>, String> {
        let of = |k: usize| shard.get(k).zip(self.chunk.get(k)).map_or(1, |(outer, inner)| outer / inner);
        let (count, columns) = (of(0).saturating_mul(of(1)), of(1));
        let checksum = if self.is_checked { CHECKSUM } else { 0 };
        let length = count.saturating_mul(2 * NUMBER).saturating_add(checksum);
        let from = if self.is_last { bytes.len().checked_sub(length) } else { Some(0) };
        let index =
            from.and_then(|from| bytes.get(from..)?.get(..length - checksum)).ok_or("it ends before its index")?;
        let number = |at: usize| {
            let bytes = index.get(at * NUMBER..).and_then(|rest| rest.first_chunk::<NUMBER>());
            bytes.map_or(u64::MAX, |bytes| u64::from_le_bytes(*bytes))
        };
        let mut found = Vec::new();
        for chunk in 0..count {
            let [offset, length] = [number(2 * chunk), number(2 * chunk + 1)];
            if offset == u64::MAX && length == u64::MAX {
                continue;
            }
            let place = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
            let inside = place.and_then(|(from, length)| bytes.get(from..)?.get(..length));
            let inside = inside.ok_or_else(|| format!("chunk {chunk} of its index is outside of it"))?;
            found.push(([chunk / columns, chunk % columns], inside));
        }
        Ok(found)
    }
}
