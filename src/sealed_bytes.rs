//! States as bytes that show when they are damaged: 8 bytes magic with the format's version, 8 bytes
//! checksum (little-endian), then the state in postcard encoding.

use crate::error::{FlockError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What a stored state starts with.
#[derive(Debug)]
pub(crate) struct Magic {
    /// In the present format, whose checksum is CRC-32.
    pub now: [u8; 8],
    /// In earlier ones with the same checksum.
    pub earlier: &'static [[u8; 8]],
    /// In still earlier ones, whose checksum is FNV-1a.
    pub first: &'static [[u8; 8]],
}

/// A state as bytes.
pub(crate) fn seal<T: Serialize>(magic: &Magic, state: &T) -> Vec<u8> {
    let mut bytes = magic.now.to_vec();
    bytes.extend_from_slice(&[0; 8]);
    // Writing to a Vec fails only out of memory, where the allocator ends the process first.
    let bytes = postcard::to_extend(state, bytes);
    debug_assert!(bytes.is_ok(), "{:?}", bytes.err());
    let mut bytes = bytes.unwrap_or_default();
    let sum = crc_32(bytes.get(16..).unwrap_or_default());
    if let Some(place) = bytes.get_mut(8..16) {
        place.copy_from_slice(&sum.to_le_bytes());
    }
    bytes
}

/// The state in bytes that [`seal`] made, or an earlier version of it.
///
/// # Errors
/// [`FlockError::Snapshot`] for bytes that are not a whole, unharmed state of this kind.
pub(crate) fn unseal<T: DeserializeOwned>(magic: &Magic, bytes: &[u8]) -> Result<T> {
    decode(opened(magic, bytes)?)
}

/// The encoded state in sealed bytes.
///
/// # Errors
/// As for [`unseal`].
pub(crate) fn opened<'a>(magic: &Magic, bytes: &'a [u8]) -> Result<&'a [u8]> {
    let refuse = |why: &str| Err(FlockError::Snapshot(why.to_owned()));
    let Some((found, rest)) = bytes.split_first_chunk::<8>() else {
        return refuse("the bytes are too short to be a snapshot");
    };
    let checksum = if *found == magic.now || magic.earlier.contains(found) {
        crc_32
    } else if magic.first.contains(found) {
        fnv_1a
    } else {
        return refuse("the bytes are no flockenv snapshot of this kind and format");
    };
    let Some((sum, body)) = rest.split_first_chunk::<8>() else {
        return refuse("the snapshot is cut off");
    };
    if u64::from_le_bytes(*sum) != checksum(body) {
        return refuse("the snapshot is damaged or cut off (checksum differs)");
    }
    Ok(body)
}

/// A state from its encoding.
///
/// # Errors
/// [`FlockError::Snapshot`] for an encoding of something else.
pub(crate) fn decode<T: DeserializeOwned>(body: &[u8]) -> Result<T> {
    postcard::from_bytes(body).map_err(|error| {
        FlockError::Snapshot(format!("the snapshot's content is not readable: {error}"))
    })
}

/// Enough to detect damage, no protection against intent.
fn crc_32(bytes: &[u8]) -> u64 {
    u64::from(crc32fast::hash(bytes))
}

fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
