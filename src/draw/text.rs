//! Letters and symbols in DejaVu Sans.

use super::palette::Rgb;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use tiny_skia::Pixmap;

/// DejaVu Sans in one size.
#[derive(Debug, Clone)]
pub(super) struct Typeface {
    font: FontRef<'static>,
    scale: PxScale,
    /// Side of the em square in pixels.
    pub size: f32,
}

impl Typeface {
    /// The typeface in a size in pixels; `None` if the font cannot be read.
    pub(super) fn new(size: f32) -> Option<Self> {
        let font = FontRef::try_from_slice(dejavu::sans::regular()).ok()?;
        let scale = PxScale::from(size * font.height_unscaled() / font.units_per_em()?);
        Some(Self { font, scale, size })
    }

    /// Width of a text in pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        let font = self.font.as_scaled(self.scale);
        let advances = text
            .chars()
            .map(|letter| font.h_advance(font.glyph_id(letter)));
        advances.sum()
    }

    /// Writes a text that starts at x, on a baseline.
    pub(super) fn write(&self, canvas: &mut Pixmap, text: &str, x: f32, baseline: f32, ink: Rgb) {
        let font = self.font.as_scaled(self.scale);
        let mut pen_x = x;
        for character in text.chars() {
            let id = font.glyph_id(character);
            let glyph = id.with_scale_and_position(self.scale, point(pen_x, baseline.round()));
            pen_x += font.h_advance(id);
            if let Some(outline) = font.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|column, row, coverage| {
                    let pixel = (
                        corner.x as i64 + i64::from(column),
                        corner.y as i64 + i64::from(row),
                    );
                    ink.blend(canvas, pixel, coverage);
                });
            }
        }
    }
}
