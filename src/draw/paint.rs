//! Drawing in a color of the palette.

use super::palette::Rgb;
use tiny_skia::{
    Color, FillRule, LineCap, Paint, PathBuilder, Pixmap, Point, Rect, Stroke, Transform,
};

impl Rgb {
    /// This color in tiny-skia's type.
    pub(super) fn color(self) -> Color {
        Color::from_rgba8(self.0, self.1, self.2, 0xFF)
    }

    /// A paint that fills with this color, with smooth edges.
    pub(super) fn paint(self) -> Paint<'static> {
        let mut paint = Paint::default();
        paint.set_color(self.color());
        paint
    }

    /// Fills a path.
    pub(super) fn fill(self, canvas: &mut Pixmap, path: PathBuilder) {
        if let Some(path) = path.finish() {
            let (paint, rule) = (self.paint(), FillRule::Winding);
            canvas.fill_path(&path, &paint, rule, Transform::identity(), None);
        }
    }

    /// Draws a path as a line with round ends.
    pub(super) fn stroke(self, canvas: &mut Pixmap, path: PathBuilder, width: f32) {
        let stroke = Stroke {
            width,
            line_cap: LineCap::Round,
            ..Stroke::default()
        };
        if let Some(path) = path.finish() {
            canvas.stroke_path(&path, &self.paint(), &stroke, Transform::identity(), None);
        }
    }

    /// Draws a straight line with round ends.
    pub(super) fn line(self, canvas: &mut Pixmap, [start, end]: [Point; 2], width: f32) {
        let mut path = PathBuilder::new();
        path.move_to(start.x, start.y);
        path.line_to(end.x, end.y);
        self.stroke(canvas, path, width);
    }

    /// Blends this color over a pixel by its coverage (at most 1), if the pixel is in the frame.
    pub(super) fn blend(self, canvas: &mut Pixmap, (column, row): (i64, i64), coverage: f32) {
        let (width, height) = (i64::from(canvas.width()), i64::from(canvas.height()));
        if (0..width).contains(&column) && (0..height).contains(&row) {
            let offset = 4 * (row * width + column) as usize;
            let pixel = canvas.data_mut()[offset..].iter_mut();
            for (under, over) in pixel.zip([self.0, self.1, self.2]) {
                let (below, above) = (f32::from(*under), f32::from(over));
                *under = (below + coverage.min(1.0) * (above - below)).round() as u8;
            }
        }
    }

    /// Fills a rectangle.
    pub(super) fn bar(self, canvas: &mut Pixmap, x: f32, y: f32, width: f32, height: f32) {
        if let Some(rect) = Rect::from_xywh(x, y, width, height) {
            canvas.fill_rect(rect, &self.paint(), Transform::identity(), None);
        }
    }
}
