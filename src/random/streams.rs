//! Named, seeded random streams: the only source of randomness.
//!
//! Every stream is ChaCha8 (portable and documented, through `rand_chacha`) with the key
//! `seed as 8 little-endian bytes || stream name padded with zeros to 24 bytes`.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A stream's generator.
pub(crate) type StreamRng = ChaCha8Rng;

/// A random stream, identified by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stream(&'static str);

impl Stream {
    /// Initial positions and headings.
    pub(crate) const PLACEMENT: Self = Self("placement");
    /// η of eq. (9).
    pub(crate) const NOISE: Self = Self("noise");
    /// η of eq. (9) after a restore with another noise seed, so that it differs from the noise of a flock of that seed.
    pub(crate) const BRANCH_NOISE: Self = Self("branch-noise");
    /// Boats that the camera loses in a frame.
    pub(crate) const SENSING: Self = Self("sensing");
    /// Per-boat differences of speed.
    pub(crate) const SPEED_SPREAD: Self = Self("speed-spread");
    /// An episode's target and backward duration.
    pub(crate) const EPISODE: Self = Self("episode");
    /// Seeds of an environment's episodes after the first.
    pub(crate) const EPISODE_SEEDS: Self = Self("episode-seeds");
    /// Random choices in the branches of a training: offsets, the flock to continue from, and targets.
    pub(crate) const TRAINING: Self = Self("training");

    /// The generator of this stream for a seed, at its start.
    pub(crate) fn rng(self, seed: u64) -> StreamRng {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..8 + self.0.len()].copy_from_slice(self.0.as_bytes());
        ChaCha8Rng::from_seed(key)
    }
}
