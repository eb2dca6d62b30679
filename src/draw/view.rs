//! The part of the world that a frame shows. World y points up, pixel rows run down.

use crate::flock::Flock;
use crate::geometry::{Hull, Vec2};
use tiny_skia::Point;

/// Fraction of the frame's shorter side that stays free around a pool.
const MARGIN: f64 = 0.03;
/// Fraction of the frame's height that the legend takes in open water, above and again below.
const LEGEND: f64 = 0.12;
/// The least half-width of open water in a frame, in hull lengths. A lone boat does not fill the frame.
const LEAST_LENGTHS: f64 = 6.0;
/// Number of steps in which the scale of open water doubles. With steps the scale seldom changes.
const STEPS: f64 = 8.0;

/// The map from world coordinates in cm to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// World point in the middle of the frame, in cm.
    pub center: Vec2,
    /// Pixels per cm.
    pub scale: f64,
    /// The frame's middle, in pixels.
    middle: Vec2,
}

impl View {
    /// The whole pool, or in open water the boats' bounding box, in a frame of this size.
    pub(super) fn from_flock(flock: &Flock, width: u32, height: u32) -> Self {
        let size = Vec2::new(f64::from(width), f64::from(height));
        let pool = &flock.parameters().pool;
        let (center, scale) = if pool.has_outer_wall() {
            let radius = size.min() * (0.5 - MARGIN);
            (Vec2::zeros(), radius / pool.outer_radius_cm)
        } else {
            around_boats(flock, size)
        };
        Self {
            center,
            scale,
            middle: size / 2.0,
        }
    }

    /// Pixel coordinates of a world point.
    pub(super) fn pixel(&self, world: Vec2) -> Point {
        let offset = (world - self.center) * self.scale;
        Point {
            x: (self.middle.x + offset.x) as f32,
            y: (self.middle.y - offset.y) as f32,
        }
    }

    /// A length in pixels, from cm.
    pub(super) fn length(&self, cm: f64) -> f32 {
        (cm * self.scale) as f32
    }

    /// Whether the frame shows anything within `reach` (cm) of a world point.
    pub(super) fn shows(&self, world: Vec2, reach: f64) -> bool {
        let half_size = self.middle / self.scale + Vec2::repeat(reach);
        let offset = (world - self.center).abs();
        offset.x <= half_size.x && offset.y <= half_size.y
    }
}

/// Center and scale of a view that shows all boats, clear of the legend.
fn around_boats(flock: &Flock, size: Vec2) -> (Vec2, f64) {
    let hull_length = 2.0 * Hull::new(flock.parameters()).reach();
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(-f64::INFINITY));
    for hull in flock.hulls() {
        low = low.inf(&hull.center);
        high = high.sup(&hull.center);
    }
    let half_extent = (high - low) / 2.0 + Vec2::repeat(hull_length);
    let half_extent = half_extent.sup(&Vec2::repeat(LEAST_LENGTHS * hull_length));
    let half_frame = Vec2::new(size.x, size.y * (1.0 - 2.0 * LEGEND)) / 2.0;
    let scale = half_frame.component_div(&half_extent).min();
    let exponent = (libm::log2(scale) * STEPS).floor() / STEPS;
    ((low + high) / 2.0, libm::exp2(exponent))
}
