//! The legend in the frame's four corners, which a round pool leaves free.

use super::look::{Look, target_of};
use super::palette::{FAINT, INK, LEADER, OPPONENT, Rgb};
use super::text::Typeface;
use crate::flock::Flock;
use crate::integrator::Phase;
use crate::parameters::Target;
use tiny_skia::Pixmap;

/// The shorter side of a frame over the size of its letters.
const SIDE_OVER_SIZE: f32 = 40.0;
/// The smallest letters, in pixels.
const LEGIBLE_SIZE: f32 = 9.0;
/// Width of the text in a corner, in letter sizes.
const CORNER_WIDTH: f32 = 13.0;
/// Height of the text in a corner, in letter sizes.
const CORNER_HEIGHT: f32 = 4.0;
/// Least distance of that text from the middle, as a fraction of the frame's shorter side. Smaller frames have no legend.
const LEAST_DISTANCE: f32 = 0.39;
/// Distance of two baselines, in letter sizes.
const LINE: f32 = 1.45;
/// Distance of the text from the frame's edge, in letter sizes.
const EDGE: f32 = 0.9;

/// The legend of frames of one size; without a typeface it stays empty.
#[derive(Debug, Clone)]
pub(super) struct Legend {
    typeface: Option<Typeface>,
}

impl Legend {
    /// The legend of frames of this size.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as f32, height as f32);
        let side = width.min(height);
        let size = (side / SIDE_OVER_SIZE).max(LEGIBLE_SIZE);
        // Distances along x and y from the frame's middle to the nearest text.
        let x = width / 2.0 - CORNER_WIDTH * size;
        let y = (height / 2.0 - CORNER_HEIGHT * size).max(0.0);
        let fits = x >= 0.0 && libm::hypotf(x, y) >= LEAST_DISTANCE * side;
        Self {
            typeface: fits.then(|| Typeface::new(size)).flatten(),
        }
    }

    /// Draws the legend. `grid_cm` is the distance of grid lines, if the frame has a grid.
    pub(super) fn draw(
        &self,
        canvas: &mut Pixmap,
        flock: &Flock,
        grid_cm: Option<f64>,
        look: Look<'_>,
    ) {
        let Some(typeface) = &self.typeface else {
            return;
        };
        let (width, height) = (canvas.width() as f32, canvas.height() as f32);
        let (size, edge) = (typeface.size, EDGE * typeface.size);
        let top_baseline = |line: u8| edge + (0.75 + LINE * f32::from(line)) * size;
        let bottom_baseline = height - edge;
        let order = flock.order_parameters(Flock::WITHOUT_LEADERS).ok();

        let mut write_left = |text: &str, baseline: f32, ink: Rgb| {
            typeface.write(canvas, text, edge, baseline, ink);
        };
        let caption = cut_to_width(typeface, look.caption, CORNER_WIDTH * size);
        for (line, (text, ink)) in (0..).zip(time_lines(flock, caption, grid_cm)) {
            write_left(&text, top_baseline(line), ink);
        }
        let psi_o = order.map(|order| format!("{:.2}", order.psi_o));
        write_left(&labeled("order Ψₒ", psi_o), bottom_baseline, INK);

        let mut write_right = |text: &str, baseline: f32, color: Option<Rgb>| {
            let x = width - edge - typeface.width(text);
            typeface.write(canvas, text, x, baseline, INK);
            if let Some(color) = color {
                typeface.write(canvas, "■", x - 1.1 * size, baseline, color);
            }
        };
        for (line, (text, color)) in (0..).zip(task_lines(flock)) {
            write_right(&text, top_baseline(line), color);
        }
        write_right(&signed_order(flock), bottom_baseline, None);
    }
}

/// The signed order towards the leaders' common target, or the rotation if they have no common target.
fn signed_order(flock: &Flock) -> String {
    // The rotation is the signed order towards clockwise.
    let (label, target) = match target_of(flock) {
        Some(target) => ("signed order", target),
        None => ("rotation", Target::Clockwise),
    };
    let order = flock.order_parameters(Flock::WITHOUT_LEADERS).ok();
    let number = order.map(|order| signed_text(order.signed_order(target)));
    labeled(label, number)
}

/// Lines for the caption (if any), the time, the phase and the grid (if any), each with its color.
fn time_lines(flock: &Flock, caption: String, grid_cm: Option<f64>) -> Vec<(String, Rgb)> {
    let mut lines = vec![];
    if !caption.is_empty() {
        lines.push((caption, INK));
    }
    lines.push((format!("{:.1} s", flock.time_s()), INK));
    lines.push((phase_text(flock.phase().phase).to_owned(), INK));
    if let Some(spacing_cm) = grid_cm {
        lines.push((format!("grid {spacing_cm} cm"), FAINT));
    }
    lines
}

/// Lines for the target, the backward duration and the number of leaders, each with the color of a
/// square before it; `None`: no square.
fn task_lines(flock: &Flock) -> Vec<(String, Option<Rgb>)> {
    let parameters = flock.parameters();
    let count = parameters.n_leaders;
    let backward = (format!("backward {:.2} s", parameters.bw_s), None);
    if count == 0 {
        return vec![backward];
    }
    let target = match target_of(flock) {
        Some(Target::Clockwise) => "target ↻ clockwise",
        Some(Target::CounterClockwise) => "target ↺ counter-clockwise",
        None => {
            let targets = (0..count).map(|leader| parameters.target.of(leader));
            let clockwise = targets
                .filter(|&target| target == Target::Clockwise)
                .count();
            return vec![
                ("targets ↻ and ↺".to_owned(), None),
                backward,
                (leaders_text(clockwise) + " ↻", Some(LEADER)),
                (leaders_text(count - clockwise) + " ↺", Some(OPPONENT)),
            ];
        }
    };
    vec![
        (target.to_owned(), None),
        backward,
        (leaders_text(count), Some(LEADER)),
    ]
}

fn leaders_text(count: usize) -> String {
    format!("{count} leader{}", if count == 1 { "" } else { "s" })
}

/// A phase in the words of the replay page.
fn phase_text(phase: Phase) -> &'static str {
    match phase {
        Phase::Forward => "forward",
        Phase::Backward => "backward",
        Phase::DriftAfterForward | Phase::DriftAfterBackward => "motors off",
    }
}

/// Shortens a text to a width in pixels; an ellipsis marks the cut.
fn cut_to_width(typeface: &Typeface, text: &str, width: f32) -> String {
    let mut shortened = text.to_owned();
    while typeface.width(&shortened) > width {
        shortened.truncate(shortened.trim_end_matches('…').len());
        shortened.pop();
        shortened.push('…');
    }
    shortened
}

/// A label with its number; a dash stands for a missing number.
fn labeled(label: &str, number: Option<String>) -> String {
    format!("{label} {}", number.unwrap_or("-".to_owned()))
}

/// A number in [−1, 1] with its sign. A number that rounds to zero has no sign.
fn signed_text(number: f64) -> String {
    match format!("{number:+.2}").as_str() {
        "+0.00" | "-0.00" => "0.00".to_owned(),
        text => text.replace('-', "−"),
    }
}
