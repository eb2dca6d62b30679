//! States as bytes with a checksum: 8 bytes magic, the last of which is the format's version, 8 bytes checksum (CRC-32,
//! little-endian), then the state in postcard encoding. Parameters, options, reward terms, blocks and quantities, which
//! tables declare, are stored by name. Everything else is stored by position, so every change of it raises the version.

use crate::error::{FlockError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::Cell;

/// First bytes of a stored state: 7 bytes for the kind of state, 1 for the version of its format.
pub(crate) type Magic = [u8; 8];

/// Encodes a state as bytes with magic and checksum.
pub(crate) fn seal<T: Serialize>(magic: &Magic, state: &T) -> Vec<u8> {
    let mut bytes = magic.to_vec();
    bytes.extend_from_slice(&[0; 8]);
    // Writing to a Vec fails only if memory runs out, and then the allocator ends the process.
    let bytes = postcard::to_extend(state, bytes);
    debug_assert!(bytes.is_ok(), "{:?}", bytes.err());
    let mut bytes = bytes.unwrap_or_default();
    let checksum = crc_32(bytes.get(16..).unwrap_or_default());
    if let Some(checksum_bytes) = bytes.get_mut(8..16) {
        checksum_bytes.copy_from_slice(&checksum.to_le_bytes());
    }
    bytes
}

/// Decodes a state from bytes that [`seal`] made.
///
/// # Errors
/// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged state of this kind.
pub(crate) fn unseal<T: DeserializeOwned>(magic: &Magic, bytes: &[u8]) -> Result<T> {
    let refuse = |reason: &str| Err(FlockError::Snapshot(reason.to_owned()));
    let Some((stored_magic, after_magic)) = bytes.split_first_chunk::<8>() else {
        return refuse("the bytes are too short to be a snapshot");
    };
    let ([kind @ .., format], [expected_kind @ .., expected_format]) = (stored_magic, magic);
    let reason = "the bytes are not a flockenv snapshot of this kind";
    FlockError::unless_fitting(kind == expected_kind, reason)?;
    if format != expected_format {
        let [format, expected] =
            [format, expected_format].map(|format| char::from(*format).escape_debug());
        return refuse(&format!(
            "it has format {format}, and this flockenv reads format {expected}"
        ));
    }
    let Some((checksum, body)) = after_magic.split_first_chunk::<8>() else {
        return refuse("the snapshot is cut off");
    };
    let reason = "the snapshot is damaged or cut off (checksum differs)";
    FlockError::unless_fitting(u64::from_le_bytes(*checksum) == crc_32(body), reason)?;
    // Clears the reason of an earlier refusal.
    REFUSAL.take();
    postcard::from_bytes(body).map_err(|error| {
        let unreadable = || format!("the snapshot's content is not readable: {error}");
        FlockError::Snapshot(REFUSAL.take().unwrap_or_else(unreadable))
    })
}

thread_local! {
    /// The reason why content was refused. It is kept here because postcard's errors drop their message.
    static REFUSAL: Cell<Option<String>> = const { Cell::new(None) };
}

/// The error for content that can be decoded but is not accepted; [`unseal`] reports its reason.
pub(crate) fn refused<E: serde::de::Error>(reason: String) -> E {
    let error = E::custom(&reason);
    REFUSAL.set(Some(reason));
    error
}

/// The CRC-32 checksum. It detects accidental damage, but not tampering.
fn crc_32(bytes: &[u8]) -> u64 {
    u64::from(crc32fast::hash(bytes))
}
