//! What lies under the boats: ground, walls, obstacles and water, and the arrow that shows the target.

use super::palette::{GRID, GROUND, Rgb, TARGET, WALL, WATER};
use super::view::View;
use crate::geometry::Vec2;
use crate::parameters::{FlockParameters, Target};
use std::f64::consts::PI;
use tiny_skia::{FillRule, PathBuilder, Pixmap, Point, Rect, Transform};

/// Pixels between lines of open water's grid, at least.
const LEAST_SPACING: f64 = 60.0;
/// The obstacle's radius from which on the arrow fits, in pixels.
const LEAST_ISLAND: f32 = 24.0;
/// Pixels beyond which nothing is drawn.
const FARTHEST: f32 = 1e6;

/// Draws all of it.
pub(super) fn draw(
    canvas: &mut Pixmap,
    parameters: &FlockParameters,
    target: Option<Target>,
    view: &View,
) {
    let (pool, wall, middle) = (&parameters.pool, wall_width(canvas), Vec2::zeros());
    if pool.has_outer_wall() {
        canvas.fill(GROUND.color());
        let radius = view.length(pool.outer_radius_cm);
        disc(canvas, view, middle, radius + wall, WALL);
        disc(canvas, view, middle, radius, WATER);
    } else {
        canvas.fill(WATER.color());
        grid(canvas, view);
    }
    if !(parameters.discs.is_empty() && parameters.walls.is_empty()) {
        obstacles(canvas, parameters, view);
    }
    if pool.has_inner_wall() {
        let radius = view.length(pool.inner_radius_cm);
        disc(canvas, view, middle, radius, WALL);
        disc(canvas, view, middle, radius - wall, GROUND);
        if let Some(target) = target
            && radius >= LEAST_ISLAND
        {
            arrow(canvas, view.pixel(Vec2::zeros()), 0.66 * radius, target);
        }
    } else {
        cross(canvas, view.pixel(Vec2::zeros()), 2.5 * wall);
    }
}

/// Width of walls in pixels.
fn wall_width(canvas: &Pixmap) -> f32 {
    (canvas.width().min(canvas.height()) as f32 / 200.0).max(1.0)
}

/// Discs and walls, those that meet as one, and nothing beyond the pool's outer wall.
fn obstacles(canvas: &mut Pixmap, parameters: &FlockParameters, view: &View) {
    let wall = wall_width(canvas);
    for each in &parameters.walls {
        let ends = [(each.x0_cm, each.y0_cm), (each.x1_cm, each.y1_cm)];
        let [start, end] = ends.map(|(x, y)| view.pixel(Vec2::new(x, y)));
        if [start.x, start.y, end.x, end.y]
            .iter()
            .all(|at| at.abs() < FARTHEST)
        {
            let mut path = PathBuilder::new();
            path.move_to(start.x, start.y);
            path.line_to(end.x, end.y);
            WALL.stroke(canvas, path, wall);
        }
    }
    for (inset, color) in [(0.0, WALL), (wall, GROUND)] {
        for each in &parameters.discs {
            let center = Vec2::new(each.x_cm, each.y_cm);
            let radius = view.length(each.radius_cm) - inset;
            disc(canvas, view, center, radius, color);
        }
    }
    if parameters.pool.has_outer_wall() {
        let radius = view.length(parameters.pool.outer_radius_cm);
        shore(canvas, view, radius, wall);
    }
}

/// The ground around the pool and its outer wall, over what reaches beyond.
fn shore(canvas: &mut Pixmap, view: &View, radius: f32, wall: f32) {
    let center = view.pixel(Vec2::zeros());
    let (width, height) = (canvas.width() as f32, canvas.height() as f32);
    for (outside, color) in [(radius, WALL), (radius + wall, GROUND)] {
        let mut path = PathBuilder::new();
        if let Some(frame) = Rect::from_xywh(0.0, 0.0, width, height) {
            path.push_rect(frame);
        }
        path.push_circle(center.x, center.y, outside);
        if let Some(path) = path.finish() {
            let (paint, whole) = (color.paint(), Transform::identity());
            canvas.fill_path(&path, &paint, FillRule::EvenOdd, whole, None);
        }
    }
}

/// A disc about a world point.
fn disc(canvas: &mut Pixmap, view: &View, center: Vec2, radius: f32, color: Rgb) {
    let center = view.pixel(center);
    let in_reach =
        radius.is_finite() && center.x.abs().max(center.y.abs()) < FARTHEST && radius < FARTHEST;
    if !in_reach {
        return;
    }
    let mut path = PathBuilder::new();
    path.push_circle(center.x, center.y, radius);
    color.fill(canvas, path);
}

/// A small cross: the origin, which outward and clockwise refer to.
fn cross(canvas: &mut Pixmap, center: Point, half: f32) {
    let near = |x: f32, most: u32| (-half..most as f32 + half).contains(&x);
    if !near(center.x, canvas.width()) || !near(center.y, canvas.height()) {
        return;
    }
    let mut path = PathBuilder::new();
    for (x, y) in [(half, 0.0), (0.0, half)] {
        path.move_to(center.x - x, center.y - y);
        path.line_to(center.x + x, center.y + y);
    }
    TARGET.stroke(canvas, path, half / 3.0);
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
        for (x, y, w, h) in [
            (at.x.round(), 0.0, 1.0, height),
            (0.0, at.y.round(), width, 1.0),
        ] {
            GRID.bar(canvas, x, y, w, h);
        }
    }
}

/// Distance of grid lines in cm: 1, 2, 5, 10, 20, …
pub(super) fn grid_spacing(view: &View) -> f64 {
    let least = LEAST_SPACING / view.scale;
    // Whole powers as text are exact, and print as people write them.
    let decade = libm::log10(least).floor() as i32;
    let rounded = |step: u8, decade: i32| format!("{step}e{decade}").parse().unwrap_or(least);
    let steps = [1, 2, 5].map(|step| rounded(step, decade));
    let found = steps.into_iter().find(|&spacing| spacing >= least);
    found.unwrap_or_else(|| rounded(1, decade + 1))
}

/// Most of a circle with a head at its end, turning towards the target.
fn arrow(canvas: &mut Pixmap, center: Point, radius: f32, target: Target) {
    const SEGMENTS: u32 = 64;
    let (width, head) = ((radius / 24.0).max(1.5), (radius / 6.0).max(5.0));
    // Pixel rows run down: growing angles are clockwise on the frame.
    let turn = target.sign();
    let at = |angle: f64, radius: f32| {
        let (sin, cos) = libm::sincos(angle);
        (
            center.x + radius * cos as f32,
            center.y + radius * sin as f32,
        )
    };
    let (start, end) = (-0.5 * PI + turn * 0.25 * PI, -0.5 * PI + turn * 1.8 * PI);
    let mut path = PathBuilder::new();
    for step in 0..=SEGMENTS {
        let share = f64::from(step) / f64::from(SEGMENTS);
        let (x, y) = at(start + (end - start) * share, radius);
        if step == 0 {
            path.move_to(x, y);
        } else {
            path.line_to(x, y);
        }
    }
    TARGET.stroke(canvas, path, width);
    let mut tip = PathBuilder::new();
    let (x, y) = at(end + turn * f64::from(head / radius), radius);
    tip.move_to(x, y);
    for side in [0.6, -0.6] {
        let (x, y) = at(end - turn * 0.02, radius + side * head);
        tip.line_to(x, y);
    }
    tip.close();
    TARGET.fill(canvas, tip);
}
