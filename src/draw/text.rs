//! Text: the legend's glyphs as paths.

use super::palette::Rgb;
use ab_glyph::{Font, FontRef, OutlineCurve};
use std::collections::BTreeMap;
use tiny_skia::{FillRule, Path, PathBuilder, Pixmap, Transform};

/// What the legend writes besides printable ASCII.
const SYMBOLS: [char; 5] = ['Ψ', 'ₒ', '↻', '↺', '−'];

/// How far the next glyph is, and the outline, which a space does not have: in parts of the em square, upwards.
type Glyph = (f32, Option<Path>);

/// DejaVu Sans in one size.
#[derive(Debug, Clone)]
pub(super) struct Typeface {
    glyphs: BTreeMap<char, Glyph>,
    /// The em square in pixels.
    pub size: f32,
}

impl Typeface {
    /// The glyphs at a size in pixels.
    pub(super) fn new(size: f32) -> Self {
        let font = FontRef::try_from_slice(dejavu::sans::regular()).ok();
        let characters = (' '..='~').chain(SYMBOLS);
        let glyphs = font.map(|font| {
            characters
                .map(|each| (each, outlined(&font, each)))
                .collect()
        });
        Self {
            glyphs: glyphs.unwrap_or_default(),
            size,
        }
    }

    /// Width of a text in pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        self.size * self.known(text).map(|(advance, _)| advance).sum::<f32>()
    }

    /// Writes a text that starts at x, on a baseline.
    pub(super) fn write(&self, canvas: &mut Pixmap, text: &str, x: f32, baseline: f32, ink: Rgb) {
        let mut pen = x;
        for (advance, outline) in self.known(text) {
            let place = Transform::from_row(self.size, 0.0, 0.0, -self.size, pen, baseline.round());
            if let Some(outline) = outline {
                canvas.fill_path(outline, &ink.paint(), FillRule::Winding, place, None);
            }
            pen += self.size * advance;
        }
    }

    fn known(&self, text: &str) -> impl Iterator<Item = &Glyph> {
        text.chars()
            .filter_map(|character| self.glyphs.get(&character))
    }
}

fn outlined(font: &FontRef, character: char) -> Glyph {
    let glyph = font.glyph_id(character);
    let em = font.units_per_em().unwrap_or(1.0);
    let (mut path, mut pen) = (PathBuilder::new(), None);
    for curve in font.outline(glyph).into_iter().flat_map(|each| each.curves) {
        let (OutlineCurve::Line(start, ..)
        | OutlineCurve::Quad(start, ..)
        | OutlineCurve::Cubic(start, ..)) = curve;
        if pen != Some(start) {
            path.move_to(start.x, start.y);
        }
        pen = Some(match curve {
            OutlineCurve::Line(_, end) => {
                path.line_to(end.x, end.y);
                end
            }
            OutlineCurve::Quad(_, a, end) => {
                path.quad_to(a.x, a.y, end.x, end.y);
                end
            }
            OutlineCurve::Cubic(_, a, b, end) => {
                path.cubic_to(a.x, a.y, b.x, b.y, end.x, end.y);
                end
            }
        });
    }
    let path = path.finish();
    let path = path.and_then(|path| path.transform(Transform::from_scale(1.0 / em, 1.0 / em)));
    (font.h_advance_unscaled(glyph) / em, path)
}
