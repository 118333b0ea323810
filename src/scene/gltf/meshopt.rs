//! Buffer views that meshoptimizer compressed (EXT_meshopt_compression and KHR_meshopt_compression).
//!
//! The `meshopt` crate's decoder takes any bytes of a stream, and asserts that counts and strides suit it. This module checks them before the
//! call, so that no file makes an assertion fail.

use super::Problem;
use super::extensions::Meshopt;
use crate::error::quoted;
use bytemuck::{NoUninit, cast_slice, cast_slice_mut};
use meshopt::encoding::{
    decode_filter_color, decode_filter_exp, decode_filter_oct, decode_filter_quat,
};
use meshopt::{decode_index_buffer, decode_index_sequence, decode_vertex_buffer};

/// The longest element, bytes.
const LONGEST: usize = 256;

/// The bytes of a view of so many elements, for all of which there must be room.
pub(super) fn decoded(of: &Meshopt, stream: &[u8]) -> Result<Vec<u8>, Problem> {
    let Meshopt { count, byte_stride, mode, filter, .. } = of;
    let filter = filter.as_deref().unwrap_or("NONE");
    let shape = || format!("{count} elements of {byte_stride} bytes cannot be {}", quoted(mode));
    let (count, stride) = usize::try_from(*count)
        .ok()
        .zip(usize::try_from(*byte_stride).ok())
        .filter(|(count, stride)| count.checked_mul(*stride).is_some())
        .ok_or_else(shape)?;
    let elements = match (mode.as_str(), stride) {
        ("ATTRIBUTES", 1..=LONGEST) if stride.is_multiple_of(4) => {
            return attributes(stream, [count, stride], filter);
        }
        ("TRIANGLES" | "INDICES", 2 | 4) if filter != "NONE" => {
            return Err("it has a filter, which is for attributes".into());
        }
        ("TRIANGLES", 2 | 4) if !count.is_multiple_of(3) => return Err(shape()),
        ("TRIANGLES", 2) => bytes_of(decode_index_buffer::<u16>(stream, count)),
        ("TRIANGLES", 4) => bytes_of(decode_index_buffer::<u32>(stream, count)),
        ("INDICES", 2) => bytes_of(decode_index_sequence::<u16>(stream, count)),
        ("INDICES", 4) => bytes_of(decode_index_sequence::<u32>(stream, count)),
        _ => return Err(shape()),
    };
    elements.ok_or_else(|| no_stream(stream, [count, stride]))
}

/// The bytes of indices, where the stream held them.
fn bytes_of<T: NoUninit, E>(indices: Result<Vec<T>, E>) -> Option<Vec<u8>> {
    indices.ok().map(|indices| cast_slice(&indices).to_vec())
}

fn no_stream(stream: &[u8], [count, stride]: [usize; 2]) -> Problem {
    format!("its {} bytes are no stream of {count} elements of {stride} bytes", stream.len())
}

/// An element of so many words of four bytes.
#[derive(Clone)]
struct Element<const WORDS: usize>([u32; WORDS]);

impl<const WORDS: usize> Default for Element<WORDS> {
    fn default() -> Self {
        Self([0; WORDS])
    }
}

/// The words of all elements in a stream; `None` where it is no stream of so many.
fn words<const WORDS: usize>(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let elements = decode_vertex_buffer::<Element<WORDS>>(stream, count).ok()?;
    Some(elements.into_iter().flat_map(|element| element.0).collect())
}

/// [`words`] of elements of a number of words that is known when it runs, 1 to 64.
macro_rules! by_words {
    ($words:expr, $stream:expr, $count:expr) => {
        by_words!($words, $stream, $count,
            1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
            33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61
            62 63 64)
    };
    ($words:expr, $stream:expr, $count:expr, $($known:literal)*) => {
        match $words {
            $($known => words::<$known>($stream, $count),)*
            _ => None,
        }
    };
}

/// Attributes of a stride that is a multiple of four and no longer than [`LONGEST`].
fn attributes(
    stream: &[u8],
    [count, stride]: [usize; 2],
    filter: &str,
) -> Result<Vec<u8>, Problem> {
    let words = by_words!(stride / 4, stream, count);
    let mut words = words.ok_or_else(|| no_stream(stream, [count, stride]))?;
    match (filter, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => decode_filter_oct::<i8>(cast_slice_mut(&mut words)),
        ("OCTAHEDRAL", 8) => decode_filter_oct::<i16>(cast_slice_mut(&mut words)),
        ("QUATERNION", 8) => decode_filter_quat(cast_slice_mut(&mut words)),
        ("EXPONENTIAL", _) => decode_filter_exp::<1>(cast_slice_mut(&mut words)),
        ("COLOR", 4) => decode_filter_color::<u8>(cast_slice_mut(&mut words)),
        ("COLOR", 8) => decode_filter_color::<u16>(cast_slice_mut(&mut words)),
        ("OCTAHEDRAL" | "QUATERNION" | "COLOR", _) => {
            return Err(format!("its filter {filter} is not for elements of {stride} bytes"));
        }
        _ => return Err(format!("its filter {} is not known", quoted(filter))),
    }
    Ok(cast_slice(&words).to_vec())
}
