//! Walls for engines that know no circle.

/// Chords of a wall.
pub const CHORDS: usize = 512;

/// Which side of a circle the water is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The outer wall.
    Inside,
    /// The inner wall.
    Outside,
}

/// Corners of a closed polygon that stands for a circular wall, counter-clockwise around what is
/// solid. No chord lies behind the circle, so chords alone never make a hull overlap it; the middle of
/// one chord lies on the x axis.
pub fn circle(radius: f64, water: Side) -> Vec<[f64; 2]> {
    let half = std::f64::consts::PI / CHORDS as f64;
    let corner_radius = match water {
        Side::Inside => radius,
        Side::Outside => radius / half.cos(),
    };
    let corner = |k: usize| {
        let (sin, cos) = ((2 * k + 1) as f64 * half).sin_cos();
        [corner_radius * cos, corner_radius * sin]
    };
    match water {
        Side::Inside => (0..CHORDS).rev().map(corner).collect(),
        Side::Outside => (0..CHORDS).map(corner).collect(),
    }
}
