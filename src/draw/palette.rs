//! Colors of a frame: Okabe and Ito's set, which color-blind eyes distinguish too, on pale water.

use tiny_skia::{Color, Paint};

/// An opaque color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// What surrounds the pool, and the obstacle in its middle.
pub const GROUND: Rgb = Rgb(0xF7, 0xF5, 0xF0);
/// The walls.
pub const WALL: Rgb = Rgb(0x7C, 0x86, 0x90);
/// The water.
pub const WATER: Rgb = Rgb(0xDC, 0xEA, 0xF3);
/// Grid lines of open water.
pub const GRID: Rgb = Rgb(0xC6, 0xD8, 0xE4);
/// Text, and the outlines of hulls.
pub const INK: Rgb = Rgb(0x1F, 0x2A, 0x36);
/// Text that stands back.
pub const FAINT: Rgb = Rgb(0x8A, 0x93, 0x9C);
/// Empty parts of the gauges.
pub const TRACK: Rgb = Rgb(0xDD, 0xDC, 0xD6);
/// Normal boats.
pub const NORMAL: Rgb = Rgb(0x00, 0x72, 0xB2);
/// Direction marks of normal boats.
pub const NORMAL_MARK: Rgb = Rgb(0xFF, 0xFF, 0xFF);
/// Leaders.
pub const LEADER: Rgb = Rgb(0xF0, 0xA2, 0x02);
/// Direction marks of leaders.
pub const LEADER_MARK: Rgb = INK;
/// Order towards the target.
pub const TOWARDS: Rgb = Rgb(0x00, 0x9E, 0x73);
/// Order against the target.
pub const AGAINST: Rgb = Rgb(0xD5, 0x5E, 0x00);
/// The arrow that shows the target.
pub const TARGET: Rgb = Rgb(0xC3, 0xC9, 0xCE);

impl Rgb {
    /// As tiny-skia's color.
    pub fn color(self) -> Color {
        Color::from_rgba8(self.0, self.1, self.2, 0xFF)
    }

    /// A paint that fills with this color and smooth edges.
    pub fn paint(self) -> Paint<'static> {
        let mut paint = Paint::default();
        paint.set_color(self.color());
        paint
    }
}
