//! Background of a frame: ground, walls, obstacles and water, and the arrow that shows the target.

use super::palette::{GRID, GROUND, Rgb, TARGET, WALL, WATER};
use super::text::Typeface;
use super::view::View;
use crate::geometry::Vec2;
use crate::parameters::{FlockParameters, Target};
use tiny_skia::{PathBuilder, Pixmap, Point};

/// Least distance of grid lines in open water, in pixels.
const LEAST_SPACING: f64 = 60.0;
/// Least radius of the inner wall at which the arrow is drawn, in pixels.
const LEAST_ARROW_RADIUS: f32 = 24.0;
/// Largest pixel coordinate that is drawn.
const FARTHEST: f32 = 1e6;

/// Draws the whole background.
pub(super) fn draw(
    canvas: &mut Pixmap,
    parameters: &FlockParameters,
    target: Option<Target>,
    view: &View,
) {
    let wall_width = (canvas.width().min(canvas.height()) as f32 / 200.0).max(1.0);
    let (pool, middle) = (&parameters.pool, view.pixel(Vec2::zeros()));
    canvas.fill(WATER.color());
    if !pool.has_outer_wall() {
        grid(canvas, view);
    }
    obstacles(canvas, parameters, view, wall_width);
    if pool.has_outer_wall() {
        outer_wall(
            canvas,
            middle,
            view.length(pool.outer_radius_cm),
            wall_width,
        );
    }
    if pool.has_inner_wall() {
        let radius = view.length(pool.inner_radius_cm);
        disc(canvas, middle, radius, WALL);
        disc(canvas, middle, radius - wall_width, GROUND);
        if let Some(target) = target
            && radius >= LEAST_ARROW_RADIUS
        {
            arrow(canvas, middle, radius, target);
        }
    } else if is_drawable(middle) {
        // A small cross marks the center of the water.
        let half = 2.5 * wall_width;
        for (x, y) in [(half, 0.0), (0.0, half)] {
            let ends = [-1.0, 1.0].map(|side| middle + Point::from_xy(side * x, side * y));
            TARGET.line(canvas, ends, half / 3.0);
        }
    }
}

/// Draws the walls and discs among the obstacles. Discs that overlap have a common outline.
fn obstacles(canvas: &mut Pixmap, parameters: &FlockParameters, view: &View, wall_width: f32) {
    for segment in &parameters.walls {
        let ends = [
            (segment.x0_cm, segment.y0_cm),
            (segment.x1_cm, segment.y1_cm),
        ];
        let ends = ends.map(|(x, y)| view.pixel(Vec2::new(x, y)));
        if ends.into_iter().all(is_drawable) {
            WALL.line(canvas, ends, wall_width);
        }
    }
    for (inset, color) in [(0.0, WALL), (wall_width, GROUND)] {
        for obstacle in &parameters.discs {
            let center = view.pixel(Vec2::new(obstacle.x_cm, obstacle.y_cm));
            disc(
                canvas,
                center,
                view.length(obstacle.radius_cm) - inset,
                color,
            );
        }
    }
}

/// Draws the outer wall and the ground around it as rings wider than the frame. They cover obstacles beyond the wall.
fn outer_wall(canvas: &mut Pixmap, middle: Point, radius: f32, wall_width: f32) {
    let width = (canvas.width() + canvas.height()) as f32;
    for (inside, color) in [(radius, WALL), (radius + wall_width, GROUND)] {
        let mut path = PathBuilder::new();
        path.push_circle(middle.x, middle.y, inside + width / 2.0);
        color.stroke(canvas, path, width);
    }
}

/// Draws a disc; center and radius are in pixels.
fn disc(canvas: &mut Pixmap, center: Point, radius: f32, color: Rgb) {
    if is_drawable(center) && radius < FARTHEST {
        let mut path = PathBuilder::new();
        path.push_circle(center.x, center.y, radius);
        color.fill(canvas, path);
    }
}

/// Whether a point in pixels is near enough to be drawn.
fn is_drawable(point: Point) -> bool {
    point.x.abs().max(point.y.abs()) < FARTHEST
}

/// Draws lines at round distances from the world's origin, which make motion in open water visible.
fn grid(canvas: &mut Pixmap, view: &View) {
    let spacing = grid_spacing(view);
    let (width, height) = (canvas.width() as f32, canvas.height() as f32);
    let first_line = |center: f64, size: f32| {
        let edge = center - f64::from(size) / 2.0 / view.scale;
        (edge / spacing).ceil() * spacing
    };
    let (left, bottom) = (
        first_line(view.center.x, width),
        first_line(view.center.y, height),
    );
    let lines = (f64::from(width.max(height)) / LEAST_SPACING) as u32 + 2;
    for line in 0..lines {
        let offset = Vec2::repeat(f64::from(line) * spacing);
        let crossing = view.pixel(Vec2::new(left, bottom) + offset);
        GRID.bar(canvas, crossing.x.round(), 0.0, 1.0, height);
        GRID.bar(canvas, 0.0, crossing.y.round(), width, 1.0);
    }
}

/// Distance of grid lines in cm: 1, 2, 5, 10, 20, …
pub(super) fn grid_spacing(view: &View) -> f64 {
    let least = LEAST_SPACING / view.scale;
    // Powers of ten parsed from text are exact, and print without rounding.
    let decade = libm::log10(least).floor() as i32;
    let rounded = |step: u8, decade: i32| format!("{step}e{decade}").parse().unwrap_or(least);
    let steps = [1, 2, 5].map(|step| rounded(step, decade));
    let spacing = steps.into_iter().find(|&spacing| spacing >= least);
    spacing.unwrap_or_else(|| rounded(1, decade + 1))
}

/// Draws a circular arrow on the obstacle in the pool's middle, as large as the obstacle, in the target's direction.
fn arrow(canvas: &mut Pixmap, middle: Point, radius: f32, target: Target) {
    let symbol = match target {
        Target::Clockwise => "↻",
        Target::CounterClockwise => "↺",
    };
    if let Some(typeface) = Typeface::new(1.5 * radius) {
        let x = middle.x - typeface.width(symbol) / 2.0;
        // A baseline this far below the middle centers the symbol.
        let baseline = middle.y + 0.36 * typeface.size;
        typeface.write(canvas, symbol, x, baseline, TARGET);
    }
}
