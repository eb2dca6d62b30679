//! States as bytes that show when they are damaged: 8 bytes magic with the format's version, 8 bytes
//! checksum (FNV-1a, little-endian), then the state in postcard encoding.

use crate::error::{FlockError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A state as bytes.
pub fn seal<T: Serialize>(magic: [u8; 8], state: &T) -> Vec<u8> {
    let mut bytes = magic.to_vec();
    bytes.extend_from_slice(&[0; 8]);
    // Writing to a Vec fails only out of memory, where the allocator ends the process first.
    let mut bytes = postcard::to_extend(state, bytes).unwrap_or_default();
    let sum = checksum(bytes.get(16..).unwrap_or_default());
    if let Some(place) = bytes.get_mut(8..16) {
        place.copy_from_slice(&sum.to_le_bytes());
    }
    bytes
}

/// The state in bytes that [`seal`] made with the same magic.
///
/// # Errors
/// [`FlockError::Snapshot`] for bytes that are not a whole, unharmed state of this kind.
pub fn unseal<T: DeserializeOwned>(magic: [u8; 8], bytes: &[u8]) -> Result<T> {
    decode(opened(magic, bytes)?)
}

/// The encoded state in bytes that [`seal`] made with the same magic.
///
/// # Errors
/// As for [`unseal`].
pub fn opened(magic: [u8; 8], bytes: &[u8]) -> Result<&[u8]> {
    let refuse = |why: &str| Err(FlockError::Snapshot(why.to_owned()));
    let Some((found, rest)) = bytes.split_at_checked(8) else {
        return refuse("the bytes are too short to be a snapshot");
    };
    if found != magic {
        return refuse("the bytes are no flockenv snapshot of this kind and format");
    }
    let Some((sum, body)) = rest.split_at_checked(8) else {
        return refuse("the snapshot is cut off");
    };
    if sum != checksum(body).to_le_bytes() {
        return refuse("the snapshot is damaged or cut off (checksum differs)");
    }
    Ok(body)
}

/// A state from its encoding.
///
/// # Errors
/// [`FlockError::Snapshot`] for an encoding of something else.
pub fn decode<T: DeserializeOwned>(body: &[u8]) -> Result<T> {
    postcard::from_bytes(body).map_err(|error| {
        FlockError::Snapshot(format!("the snapshot's content is not readable: {error}"))
    })
}

/// FNV-1a over the bytes: enough to detect damage, no protection against intent.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
