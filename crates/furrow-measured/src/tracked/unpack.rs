//! Blosc and Zstandard, as Python's Zarr compresses arrays.
//!
//! # References
//! <https://github.com/Blosc/c-blosc/blob/main/README_CHUNK_FORMAT.rst>.

use std::io::Read;

/// The bytes of a chunk, at most one more than `length`.
pub(super) fn unpacked(packed: &[u8], codec: &str, length: usize) -> Result<Vec<u8>, String> {
    if codec == "zstd" {
        return zstandard(packed, length);
    }
    blosc(packed, length).map_err(|why| format!("Blosc: {why}"))
}

fn zstandard(packed: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let decoder = ruzstd::decoding::StreamingDecoder::new(packed).map_err(|e| e.to_string())?;
    let mut out = Vec::new();
    decoder.take(length as u64 + 1).read_to_end(&mut out).map_err(|e| e.to_string())?;
    Ok(out)
}

fn zlib(packed: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    flate2::read::ZlibDecoder::new(packed).take(length as u64 + 1).read_to_end(&mut out).map_err(|e| e.to_string())?;
    Ok(out)
}

fn blosc(packed: &[u8], length: usize) -> Result<Vec<u8>, &'static str> {
    // Bits of the flags: bytes of equal rank together, not compressed, bits of equal rank together, a block in one piece.
    const SHUFFLED: u8 = 1;
    const STORED: u8 = 2;
    const BITS_SHUFFLED: u8 = 4;
    const WHOLE: u8 = 16;
    // Bytes of the header: versions, flags, size of a value, then the lengths of all, of a block and of the chunk.
    const HEADER: usize = 16;
    const SHORT: &str = "it ends too early";
    let number = |at: usize| -> Result<usize, &'static str> {
        let bytes = packed.get(at..).and_then(|rest| rest.first_chunk::<4>()).ok_or(SHORT)?;
        Ok(u32::from_le_bytes(*bytes) as usize)
    };
    let [flags, size] = [packed.get(2).ok_or(SHORT)?, packed.get(3).ok_or(SHORT)?].map(|byte| *byte);
    let (total, block) = (number(4)?, number(8)?);
    if total > length {
        return Err("it is longer than the array");
    }
    if flags & STORED != 0 {
        return Ok(packed.get(HEADER..HEADER + total).ok_or(SHORT)?.to_vec());
    }
    if flags & BITS_SHUFFLED != 0 || block == 0 {
        return Err("shuffled bits are not read");
    }
    let (size, codec) = (usize::from(size.max(1)), flags >> 5);
    let mut out = Vec::with_capacity(total);
    for (index, from) in (0..total).step_by(block).enumerate() {
        let (length, mut at) = (block.min(total - from), number(HEADER + 4 * index)?);
        // Blocks of many values are cut into one stream per byte of a value.
        let is_cut = flags & WHOLE == 0 && size <= 16 && block / size >= 128 && length == block;
        let streams = if is_cut { size } else { 1 };
        let mut bytes = Vec::with_capacity(length);
        for _ in 0..streams {
            let (packed_length, stream) = (number(at)?, length / streams);
            let data = packed.get(at + 4..).and_then(|rest| rest.get(..packed_length)).ok_or(SHORT)?;
            at += 4 + packed_length;
            match codec {
                _ if packed_length == stream => bytes.extend(data),
                1 => bytes.extend(lz4_flex::block::decompress(data, stream).map_err(|_| "its LZ4 is damaged")?),
                3 => bytes.extend(zlib(data, stream).map_err(|_| "its zlib is damaged")?),
                4 => bytes.extend(zstandard(data, stream).map_err(|_| "its Zstandard is damaged")?),
                _ => return Err("only LZ4, zlib and Zstandard in it are read"),
            }
        }
        if bytes.len() != length {
            return Err("a block has another length than it says");
        }
        if flags & SHUFFLED != 0 && size > 1 {
            bytes = unshuffled(&bytes, size);
        }
        out.extend(bytes);
    }
    Ok(out)
}

/// Values from the first bytes of all, the second bytes of all, and so on.
fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size;
    let mut out: Vec<u8> = (0..count).flat_map(|k| (0..size).map(move |byte| bytes[byte * count + k])).collect();
    out.extend(&bytes[count * size..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers from 0 to 1999 in eight bytes, as Python's numcodecs compresses them: Blosc in blocks of 8192 bytes, cut into
    /// one stream per byte of a number; Blosc with Zstandard; Zstandard alone.
    #[test]
    fn numbers_compressed_by_python_are_read() {
        let numbers: Vec<u8> = (0..2000_u64).flat_map(u64::to_le_bytes).collect();
        for (packed, codec) in [
            (&include_bytes!("tests/counted.blosc")[..], "blosc"),
            (include_bytes!("tests/counted_zstd.blosc"), "blosc"),
            (include_bytes!("tests/counted.zst"), "zstd"),
        ] {
            assert_eq!(unpacked(packed, codec, numbers.len()).as_ref(), Ok(&numbers), "{codec}");
            // Damaged or cut short: an error or other numbers, no panic.
            for at in 0..packed.len() {
                let mut changed = packed.to_vec();
                changed[at] ^= 0x55;
                let _ = unpacked(&changed, codec, numbers.len());
                assert_ne!(unpacked(&packed[..at], codec, numbers.len()).as_ref(), Ok(&numbers), "{codec} {at}");
            }
        }
    }
}
