//! Named, seeded random streams: the only source of randomness.
//!
//! Every stream is ChaCha8 (portable and documented, through `rand_chacha`) with the key
//! `seed as 8 little-endian bytes || stream name padded with zeros to 24 bytes`.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A stream's generator.
pub(crate) type StreamRng = ChaCha8Rng;

/// The streams of a flock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stream {
    /// Initial positions and headings.
    Placement,
    /// η of eq. (9).
    Noise,
    /// Tracking drop-outs of the observation.
    Sensing,
    /// Per-boat differences of speed.
    SpeedSpread,
    /// An episode's target and backward duration.
    Episode,
    /// Seeds of an environment's episodes after the first.
    EpisodeSeeds,
}

impl Stream {
    fn name(self) -> &'static [u8] {
        match self {
            Self::Placement => b"placement",
            Self::Noise => b"noise",
            Self::Sensing => b"sensing",
            Self::SpeedSpread => b"speed-spread",
            Self::Episode => b"episode",
            Self::EpisodeSeeds => b"episode-seeds",
        }
    }

    /// The generator of this stream for a seed, at its start.
    pub(crate) fn rng(self, seed: u64) -> StreamRng {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let name = self.name();
        key[8..8 + name.len()].copy_from_slice(name);
        ChaCha8Rng::from_seed(key)
    }
}
