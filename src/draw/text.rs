//! Text: the legend's glyphs, rasterized once per size.

use super::palette::Rgb;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont};
use std::collections::BTreeMap;
use tiny_skia::PixmapMut;

/// What the legend writes besides printable ASCII.
const SYMBOLS: [char; 5] = ['Ψ', 'ₒ', '↻', '↺', '−'];

/// A glyph's coverage, row by row.
#[derive(Debug, Clone)]
struct Glyph {
    advance: f32,
    left: i32,
    top: i32,
    width: usize,
    coverage: Vec<u8>,
}

/// DejaVu Sans in one size.
#[derive(Debug, Clone)]
pub(super) struct Typeface {
    glyphs: BTreeMap<char, Glyph>,
    size: f32,
}

impl Typeface {
    /// The glyphs at a size in pixels.
    pub(super) fn new(size: f32) -> Self {
        let mut glyphs = BTreeMap::new();
        if let Ok(font) = FontRef::try_from_slice(dejavu::sans::regular()) {
            // The size is that of the em square, as in print; ab_glyph counts the line's height.
            let units = font.units_per_em().unwrap_or(1.0);
            let scale = PxScale::from(size * font.height_unscaled() / units);
            for character in (' '..='~').chain(SYMBOLS) {
                glyphs.insert(character, rasterized(&font, scale, character));
            }
        }
        Self { glyphs, size }
    }

    /// The em square in pixels.
    pub(super) fn size(&self) -> f32 {
        self.size
    }

    /// Width of a text in pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        self.known(text).map(|glyph| glyph.advance).sum()
    }

    /// Writes a text that starts at x, on a baseline.
    pub(super) fn write(
        &self,
        canvas: &mut PixmapMut,
        text: &str,
        x: f32,
        baseline: f32,
        ink: Rgb,
    ) {
        let (mut pen, baseline) = (x, baseline.round() as i32);
        for glyph in self.known(text) {
            glyph.blend(canvas, pen.round() as i32, baseline, ink);
            pen += glyph.advance;
        }
    }

    fn known(&self, text: &str) -> impl Iterator<Item = &Glyph> {
        text.chars()
            .filter_map(|character| self.glyphs.get(&character))
    }
}

fn rasterized(font: &FontRef, scale: PxScale, character: char) -> Glyph {
    let glyph = font.glyph_id(character).with_scale(scale);
    let advance = font.as_scaled(scale).h_advance(glyph.id);
    let mut drawn = Glyph {
        advance,
        left: 0,
        top: 0,
        width: 0,
        coverage: Vec::new(),
    };
    if let Some(outline) = font.outline_glyph(glyph) {
        let bounds = outline.px_bounds();
        drawn.left = bounds.min.x as i32;
        drawn.top = bounds.min.y as i32;
        drawn.width = bounds.width() as usize;
        drawn.coverage = vec![0; drawn.width * bounds.height() as usize];
        outline.draw(|x, y, coverage| {
            let place = y as usize * drawn.width + x as usize;
            if let Some(pixel) = drawn.coverage.get_mut(place) {
                *pixel = (coverage.clamp(0.0, 1.0) * 255.0).round() as u8;
            }
        });
    }
    drawn
}

impl Glyph {
    fn blend(&self, canvas: &mut PixmapMut, pen: i32, baseline: i32, ink: Rgb) {
        let (columns, rows) = (canvas.width() as i32, canvas.height() as i32);
        let pixels = canvas.pixels_mut();
        for (row, line) in self.coverage.chunks_exact(self.width.max(1)).enumerate() {
            let y = baseline + self.top + row as i32;
            for (column, &coverage) in line.iter().enumerate() {
                let x = pen + self.left + column as i32;
                if coverage > 0 && (0..columns).contains(&x) && (0..rows).contains(&y) {
                    let pixel = &mut pixels[(y * columns + x) as usize];
                    let over = |ink: u8, ground: u8| mixed(ink, ground, coverage);
                    let rgb = Rgb(
                        over(ink.0, pixel.red()),
                        over(ink.1, pixel.green()),
                        over(ink.2, pixel.blue()),
                    );
                    *pixel = rgb.color().premultiply().to_color_u8();
                }
            }
        }
    }
}

fn mixed(ink: u8, ground: u8, coverage: u8) -> u8 {
    let (ink, ground, share) = (u32::from(ink), u32::from(ground), u32::from(coverage));
    ((ink * share + ground * (255 - share) + 127) / 255) as u8
}
