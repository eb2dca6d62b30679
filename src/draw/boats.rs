//! The boats: hulls (segments swept by a disc) with a mark towards the bow.

use super::palette::{INK, LEADER, LEADER_MARK, NORMAL, NORMAL_MARK, OPPONENT, Rgb};
use super::view::View;
use crate::flock::Flock;
use crate::geometry::{Hull, HullPose, turned_left};
use crate::parameters::{Target, Targets};
use tiny_skia::{PathBuilder, Pixmap};

/// Width of outlines as a share of the hull's radius, and the least in pixels.
const OUTLINE: (f32, f32) = (0.14, 1.0);
/// The least radius that is drawn, in pixels: boats of a huge pool stay visible.
const LEAST_RADIUS: f32 = 1.0;
/// The radius from which on marks are legible, in pixels.
const LEAST_MARKED: f32 = 2.5;

/// Draws all boats, leaders on top.
pub(super) fn draw(canvas: &mut Pixmap, flock: &Flock, view: &View) {
    let hull = Hull::new(flock.parameters());
    let (leaders, normal) = flock.hulls().split_at(flock.parameters().n_leaders);
    let mut draw = |boat: &HullPose, body: Rgb, mark: Rgb| {
        if view.shows(boat.center, hull.reach()) {
            draw_boat(canvas, view, hull, boat, [body, mark]);
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

/// A hull as a thick line with round ends, in the colors of its body and its mark.
fn draw_boat(canvas: &mut Pixmap, view: &View, hull: Hull, boat: &HullPose, colors: [Rgb; 2]) {
    let radius = view.length(hull.radius).max(LEAST_RADIUS);
    let outline = (OUTLINE.0 * radius).max(OUTLINE.1).min(0.3 * radius);
    let inner = radius - outline;
    let ends = [-1.0, 1.0].map(|side| view.pixel(boat.end(side, hull.half_length)));
    for (half_width, color) in [(radius, INK), (inner, colors[0])] {
        color.line(canvas, ends, 2.0 * half_width);
    }
    if radius >= LEAST_MARKED {
        let share = f64::from(inner / radius);
        let (along, across) = (hull.half_length + share * hull.radius, share * hull.radius);
        colors[1].fill(canvas, mark(view, boat, along, across));
    }
}

/// An arrowhead in the bow half of a hull that reaches so far along and across, in cm.
fn mark(view: &View, boat: &HullPose, along: f64, across: f64) -> PathBuilder {
    let corners = [(0.84, 0.0), (-0.12, 0.68), (0.1, 0.0), (-0.12, -0.68)];
    let mut path = PathBuilder::new();
    for (ahead, aside) in corners {
        let offset = boat.axis * (ahead * along) + turned_left(boat.axis) * (aside * across);
        let point = view.pixel(boat.center + offset);
        if path.is_empty() {
            path.move_to(point.x, point.y);
        } else {
            path.line_to(point.x, point.y);
        }
    }
    path.close();
    path
}
