//! States as bytes with a checksum: 8 bytes magic, the last of which is the format's version, 8 bytes checksum (CRC-32,
//! little-endian), then the state in postcard encoding. Parameters, options, reward terms, blocks and quantities, which
//! tables declare, are stored by name. The rest is stored by position, so that the version rises with every change of
//! it.

use crate::error::{FlockError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::Cell;

/// First bytes of a stored state of some kind and version.
pub(crate) type Magic = [u8; 8];

/// A state as bytes.
pub(crate) fn seal<T: Serialize>(magic: &Magic, state: &T) -> Vec<u8> {
    let mut bytes = magic.to_vec();
    bytes.extend_from_slice(&[0; 8]);
    // Writing to a Vec fails only if memory runs out, and then the allocator ends the process.
    let bytes = postcard::to_extend(state, bytes);
    debug_assert!(bytes.is_ok(), "{:?}", bytes.err());
    let mut bytes = bytes.unwrap_or_default();
    let sum = crc_32(bytes.get(16..).unwrap_or_default());
    if let Some(checksum) = bytes.get_mut(8..16) {
        checksum.copy_from_slice(&sum.to_le_bytes());
    }
    bytes
}

/// The state in bytes that [`seal`] made.
///
/// # Errors
/// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged state of this kind.
pub(crate) fn unseal<T: DeserializeOwned>(magic: &Magic, bytes: &[u8]) -> Result<T> {
    let refuse = |why: &str| Err(FlockError::Snapshot(why.to_owned()));
    let Some((found, rest)) = bytes.split_first_chunk::<8>() else {
        return refuse("the bytes are too short to be a snapshot");
    };
    let ([kind @ .., format], [own_kind @ .., own_format]) = (found, magic);
    let why = "the bytes are not a flockenv snapshot of this kind";
    FlockError::unless_fitting(kind == own_kind, why)?;
    if format != own_format {
        let [format, own] = [format, own_format].map(|format| char::from(*format).escape_debug());
        return refuse(&format!(
            "it has format {format}, and this flockenv reads format {own}"
        ));
    }
    let Some((sum, body)) = rest.split_first_chunk::<8>() else {
        return refuse("the snapshot is cut off");
    };
    let why = "the snapshot is damaged or cut off (checksum differs)";
    FlockError::unless_fitting(u64::from_le_bytes(*sum) == crc_32(body), why)?;
    REASON.take();
    postcard::from_bytes(body).map_err(|error| {
        let why = || format!("the snapshot's content is not readable: {error}");
        FlockError::Snapshot(REASON.take().unwrap_or_else(why))
    })
}

thread_local! {
    /// The reason why content was refused. It is kept here because postcard's errors drop their message.
    static REASON: Cell<Option<String>> = const { Cell::new(None) };
}

/// An error for readable content that is refused; [`unseal`] reports its reason.
pub(crate) fn refused<E: serde::de::Error>(why: String) -> E {
    let error = E::custom(&why);
    REASON.set(Some(why));
    error
}

/// The CRC-32 checksum. It detects accidental damage, but not tampering.
fn crc_32(bytes: &[u8]) -> u64 {
    u64::from(crc32fast::hash(bytes))
}
