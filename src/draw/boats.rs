//! The boats: hulls (segments swept by a disc) with a mark towards the bow.

use super::palette::{INK, LEADER, LEADER_MARK, NORMAL, NORMAL_MARK, OPPONENT, Rgb};
use super::view::View;
use crate::flock::Flock;
use crate::geometry::{Hull, HullPose};
use crate::parameters::{Target, Targets};
use tiny_skia::{FillRule, PathBuilder, Pixmap, Point, Transform};

/// Control points of a quarter circle, as a share of its radius.
const QUARTER: f32 = 0.552_284_8;
/// Width of outlines as a share of the hull's radius, and the least in pixels.
const OUTLINE: (f32, f32) = (0.14, 1.0);
/// The least radius that is drawn, in pixels: boats of a huge pool stay visible.
const LEAST_RADIUS: f32 = 1.0;
/// The radius from which on marks are legible, in pixels.
const LEAST_MARKED: f32 = 2.5;

/// Draws all boats, leaders on top.
pub(super) fn draw(canvas: &mut Pixmap, flock: &Flock, view: &View) {
    let hull = Hull::new(flock.parameters());
    let shape = Shape::new(&hull, view);
    let (leaders, normal) = flock.hulls().split_at(flock.parameters().n_leaders);
    let mut draw = |boat: &HullPose, body: Rgb, mark: Rgb| {
        if view.shows(boat.center, hull.reach()) {
            let mut layers = Layers::default();
            shape.add(boat, view, &mut layers);
            layers.fill(canvas, body, mark);
        }
    };
    for boat in normal {
        draw(boat, NORMAL, NORMAL_MARK);
    }
    let target = &flock.parameters().target;
    for (leader, boat) in leaders.iter().enumerate() {
        draw(boat, body_of(target, leader), LEADER_MARK);
    }
}

/// The color of a leader's hull: one for all, unless they head against each other.
fn body_of(targets: &Targets, leader: usize) -> Rgb {
    if targets.are_opposed() && targets.of(leader) == Target::CounterClockwise {
        OPPONENT
    } else {
        LEADER
    }
}

/// The parts of a boat, each in its color.
#[derive(Default)]
struct Layers {
    outline: PathBuilder,
    body: PathBuilder,
    mark: PathBuilder,
}

impl Layers {
    fn fill(self, canvas: &mut Pixmap, body: Rgb, mark: Rgb) {
        for (path, color) in [(self.outline, INK), (self.body, body), (self.mark, mark)] {
            if let Some(path) = path.finish() {
                let (paint, rule) = (color.paint(), FillRule::Winding);
                canvas.fill_path(&path, &paint, rule, Transform::identity(), None);
            }
        }
    }
}

/// A hull in pixels.
struct Shape {
    half_length: f32,
    radius: f32,
    outline: f32,
}

impl Shape {
    fn new(hull: &Hull, view: &View) -> Self {
        let radius = view.length(hull.radius).max(LEAST_RADIUS);
        Self {
            half_length: view.length(hull.half_length),
            radius,
            outline: (OUTLINE.0 * radius).max(OUTLINE.1).min(0.3 * radius),
        }
    }

    fn add(&self, boat: &HullPose, view: &View, layers: &mut Layers) {
        let place = Place {
            center: view.pixel(boat.center),
            axis: View::direction(boat.axis),
        };
        let inner = self.radius - self.outline;
        place.capsule(&mut layers.outline, self.half_length, self.radius);
        place.capsule(&mut layers.body, self.half_length, inner);
        if self.radius >= LEAST_MARKED {
            place.mark(&mut layers.mark, self.half_length + inner, inner);
        }
    }
}

/// Where a boat is in the frame; (along, across) count from its center to the bow and to port.
struct Place {
    center: Point,
    axis: Point,
}

impl Place {
    fn at(&self, along: f32, across: f32) -> Point {
        Point {
            x: self.center.x + along * self.axis.x + across * self.axis.y,
            y: self.center.y + along * self.axis.y - across * self.axis.x,
        }
    }

    fn capsule(&self, path: &mut PathBuilder, half_length: f32, radius: f32) {
        let (h, r, q) = (half_length, radius, QUARTER * radius);
        let start = self.at(-h, r);
        path.move_to(start.x, start.y);
        let to_bow = self.at(h, r);
        path.line_to(to_bow.x, to_bow.y);
        self.curve(path, (h + q, r), (h + r, q), (h + r, 0.0));
        self.curve(path, (h + r, -q), (h + q, -r), (h, -r));
        let to_stern = self.at(-h, -r);
        path.line_to(to_stern.x, to_stern.y);
        self.curve(path, (-h - q, -r), (-h - r, -q), (-h - r, 0.0));
        self.curve(path, (-h - r, q), (-h - q, r), (-h, r));
        path.close();
    }

    fn curve(&self, path: &mut PathBuilder, a: (f32, f32), b: (f32, f32), end: (f32, f32)) {
        let (a, b, end) = (self.at(a.0, a.1), self.at(b.0, b.1), self.at(end.0, end.1));
        path.cubic_to(a.x, a.y, b.x, b.y, end.x, end.y);
    }

    /// An arrowhead in the bow half of a hull.
    fn mark(&self, path: &mut PathBuilder, reach: f32, radius: f32) {
        let corners = [
            (0.84 * reach, 0.0),
            (-0.12 * reach, 0.68 * radius),
            (0.1 * reach, 0.0),
            (-0.12 * reach, -0.68 * radius),
        ];
        for (index, (along, across)) in corners.into_iter().enumerate() {
            let point = self.at(along, across);
            if index == 0 {
                path.move_to(point.x, point.y);
            } else {
                path.line_to(point.x, point.y);
            }
        }
        path.close();
    }
}
