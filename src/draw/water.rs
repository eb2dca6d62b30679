//! Background of a frame: ground, walls, obstacles and water, and the arrow that shows the target.

use super::palette::{GRID, GROUND, Rgb, TARGET, WALL, WATER};
use super::text::Typeface;
use super::view::View;
use crate::geometry::Vec2;
use crate::parameters::{FlockParameters, Target};
use tiny_skia::{PathBuilder, Pixmap, Point};

/// Pixels between lines of open water's grid, at least.
const LEAST_SPACING: f64 = 60.0;
/// The obstacle's radius from which on the arrow fits, in pixels.
const LEAST_ISLAND: f32 = 24.0;
/// Largest pixel coordinate that is drawn.
const FARTHEST: f32 = 1e6;

/// Draws the whole background.
pub(super) fn draw(
    canvas: &mut Pixmap,
    parameters: &FlockParameters,
    target: Option<Target>,
    view: &View,
) {
    let wall = (canvas.width().min(canvas.height()) as f32 / 200.0).max(1.0);
    let (pool, middle) = (&parameters.pool, view.pixel(Vec2::zeros()));
    canvas.fill(WATER.color());
    if !pool.has_outer_wall() {
        grid(canvas, view);
    }
    obstacles(canvas, parameters, view, wall);
    if pool.has_outer_wall() {
        shore(canvas, middle, view.length(pool.outer_radius_cm), wall);
    }
    if pool.has_inner_wall() {
        let radius = view.length(pool.inner_radius_cm);
        disc(canvas, middle, radius, WALL);
        disc(canvas, middle, radius - wall, GROUND);
        if let Some(target) = target
            && radius >= LEAST_ISLAND
        {
            arrow(canvas, middle, radius, target);
        }
    } else if in_reach(middle) {
        let half = 2.5 * wall;
        for (x, y) in [(half, 0.0), (0.0, half)] {
            let ends = [-1.0, 1.0].map(|side| middle + Point::from_xy(side * x, side * y));
            TARGET.line(canvas, ends, half / 3.0);
        }
    }
}

/// Discs and walls; those that meet are drawn as one.
fn obstacles(canvas: &mut Pixmap, parameters: &FlockParameters, view: &View, wall: f32) {
    for segment in &parameters.walls {
        let ends = [
            (segment.x0_cm, segment.y0_cm),
            (segment.x1_cm, segment.y1_cm),
        ];
        let ends = ends.map(|(x, y)| view.pixel(Vec2::new(x, y)));
        if ends.into_iter().all(in_reach) {
            WALL.line(canvas, ends, wall);
        }
    }
    for (inset, color) in [(0.0, WALL), (wall, GROUND)] {
        for post in &parameters.discs {
            let center = view.pixel(Vec2::new(post.x_cm, post.y_cm));
            disc(canvas, center, view.length(post.radius_cm) - inset, color);
        }
    }
}

/// The pool's outer wall and the ground around it, as rings wider than the frame, over everything that reaches beyond.
fn shore(canvas: &mut Pixmap, middle: Point, radius: f32, wall: f32) {
    let width = (canvas.width() + canvas.height()) as f32;
    for (inside, color) in [(radius, WALL), (radius + wall, GROUND)] {
        let mut path = PathBuilder::new();
        path.push_circle(middle.x, middle.y, inside + width / 2.0);
        color.stroke(canvas, path, width);
    }
}

/// A disc, in pixels.
fn disc(canvas: &mut Pixmap, center: Point, radius: f32, color: Rgb) {
    if in_reach(center) && radius < FARTHEST {
        let mut path = PathBuilder::new();
        path.push_circle(center.x, center.y, radius);
        color.fill(canvas, path);
    }
}

fn in_reach(point: Point) -> bool {
    point.x.abs().max(point.y.abs()) < FARTHEST
}

/// Lines at round distances from the world's origin, so that motion shows in open water.
fn grid(canvas: &mut Pixmap, view: &View) {
    let spacing = grid_spacing(view);
    let (width, height) = (canvas.width() as f32, canvas.height() as f32);
    let first = |center: f64, size: f32| {
        let edge = center - f64::from(size) / 2.0 / view.scale;
        (edge / spacing).ceil() * spacing
    };
    let (left, bottom) = (first(view.center.x, width), first(view.center.y, height));
    let lines = (f64::from(width.max(height)) / LEAST_SPACING) as u32 + 2;
    for line in 0..lines {
        let at = view.pixel(Vec2::new(left, bottom) + Vec2::repeat(f64::from(line) * spacing));
        GRID.bar(canvas, at.x.round(), 0.0, 1.0, height);
        GRID.bar(canvas, 0.0, at.y.round(), width, 1.0);
    }
}

/// Distance of grid lines in cm: 1, 2, 5, 10, 20, …
pub(super) fn grid_spacing(view: &View) -> f64 {
    let least = LEAST_SPACING / view.scale;
    // Powers of ten parsed from text are exact, and print without rounding.
    let decade = libm::log10(least).floor() as i32;
    let rounded = |step: u8, decade: i32| format!("{step}e{decade}").parse().unwrap_or(least);
    let steps = [1, 2, 5].map(|step| rounded(step, decade));
    let found = steps.into_iter().find(|&spacing| spacing >= least);
    found.unwrap_or_else(|| rounded(1, decade + 1))
}

/// A symbol as large as the pool's obstacle, on which it is drawn. It turns in the target's direction.
fn arrow(canvas: &mut Pixmap, middle: Point, radius: f32, target: Target) {
    let symbol = match target {
        Target::Clockwise => "↻",
        Target::CounterClockwise => "↺",
    };
    if let Some(typeface) = Typeface::new(1.5 * radius) {
        let x = middle.x - typeface.width(symbol) / 2.0;
        // Half of the height of letters above their baseline.
        let baseline = middle.y + 0.36 * typeface.size;
        typeface.write(canvas, symbol, x, baseline, TARGET);
    }
}
