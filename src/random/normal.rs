//! Standard normal numbers, each from one word of 64 random bits: the ziggurat (Marsaglia and Tsang 2000).
//!
//! The area under exp(−x²/2), x ≥ 0, is cut into 256 layers of equal area. 98.8 % of the words need only a product and
//! a comparison. The others need further random words, each of which is a hash of the word before it.

use std::sync::LazyLock;

const LAYERS: usize = 256;
/// Start of the lowest layer's tail: the value for which the uppermost layer ends at x = 0.
const TAIL: f64 = 3.654_152_885_361_009;

/// Right edges of the layers and the density at each edge, from the bottom up. The first edge belongs to a rectangle
/// with the same area as the lowest layer including its tail.
#[derive(Debug)]
struct Layers {
    edges: [f64; LAYERS + 1],
    densities: [f64; LAYERS + 1],
}

static NORMAL_LAYERS: LazyLock<Layers> = LazyLock::new(|| {
    let area = TAIL * density(TAIL)
        + std::f64::consts::FRAC_PI_2.sqrt() * libm::erfc(TAIL * std::f64::consts::FRAC_1_SQRT_2);
    let mut edges = [0.0; LAYERS + 1];
    (edges[0], edges[1]) = (area / density(TAIL), TAIL);
    for layer in 1..LAYERS - 1 {
        let next_density = density(edges[layer]) + area / edges[layer];
        edges[layer + 1] = (-2.0 * libm::log(next_density)).sqrt();
    }
    Layers {
        edges,
        densities: edges.map(density),
    }
});

/// The normal density without its factor 1/√(2π).
fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A hash that looks independent of the word: a step of SplitMix64 (Steele, Lea and Flood 2014).
#[inline]
pub(super) fn scramble(word: u64) -> u64 {
    let word = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// Turns random words into standard normal numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ziggurat(&'static Layers);

impl Ziggurat {
    pub(super) fn new() -> Self {
        Self(&NORMAL_LAYERS)
    }

    /// The normal number for a random word.
    #[inline]
    pub(super) fn normal(self, word: u64) -> f64 {
        let (layer, x) = self.draw_point(word);
        if x.abs() < self.0.edges[layer + 1] {
            x
        } else {
            self.finish_draw(layer, x, word)
        }
    }

    /// Draws a layer, and an x in its width on either side of 0, from one word.
    #[inline]
    fn draw_point(self, word: u64) -> (usize, f64) {
        let layer = (word & (LAYERS as u64 - 1)) as usize;
        // The upper 53 bits as a number in [−1, 1).
        let fraction = ((word as i64) >> 11) as f64 / (1_u64 << 52) as f64;
        (layer, fraction * self.0.edges[layer])
    }

    /// Accepts x if a point drawn at a height in its layer lies under the curve; draws again otherwise.
    #[cold]
    #[inline(never)]
    fn finish_draw(self, mut layer: usize, mut x: f64, mut word: u64) -> f64 {
        let Layers { edges, densities } = self.0;
        let mut next_word = || {
            word = scramble(word);
            word
        };
        loop {
            if x.abs() < edges[layer + 1] {
                return x;
            }
            if layer == 0 {
                return tail(|| uniform(next_word())).copysign(x);
            }
            let layer_height = densities[layer + 1] - densities[layer];
            let height = densities[layer] + layer_height * uniform(next_word());
            if height < density(x) {
                return x;
            }
            (layer, x) = self.draw_point(next_word());
        }
    }
}

/// The upper 53 bits of a word as a number in (0, 1).
fn uniform(word: u64) -> f64 {
    ((word >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// A normal number above [`TAIL`] (Marsaglia 1964), from uniform numbers in (0, 1).
fn tail(mut next_uniform: impl FnMut() -> f64) -> f64 {
    loop {
        let excess = -libm::log(next_uniform()) / TAIL;
        if -2.0 * libm::log(next_uniform()) > excess * excess {
            return TAIL + excess;
        }
    }
}
