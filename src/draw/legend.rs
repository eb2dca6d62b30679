//! The legend in the frame's four corners, which a round pool leaves free.

use super::palette::{AGAINST, FAINT, INK, LEADER, OPPONENT, Rgb, TOWARDS, TRACK};
use super::target_of;
use super::text::Typeface;
use crate::analysis::OrderParameters;
use crate::flock::Flock;
use crate::integrator::Phase;
use crate::parameters::Target;
use tiny_skia::Pixmap;

/// The shorter side of a frame over the size of its letters.
const SIDE_OVER_SIZE: f32 = 46.0;
/// The smallest letters, in pixels.
const LEGIBLE_SIZE: f32 = 8.0;
/// What the text of a corner takes, in sizes, and how far from the middle it has to stay, as a share of
/// the frame's shorter side: smaller frames show the boats alone.
const CORNER: (f32, f32) = (13.0, 4.0);
const CLEAR: f32 = 0.4;
/// Distance of two baselines, distance to the frame's edge and length of the gauges, in sizes.
const LINE: f32 = 1.45;
const EDGE: f32 = 0.9;
const GAUGE: f32 = 9.0;

/// The legend of frames of one size.
#[derive(Debug, Clone)]
pub(super) struct Legend {
    typeface: Option<Typeface>,
}

impl Legend {
    /// For frames of this size.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as f32, height as f32);
        let side = width.min(height);
        let size = (side / SIDE_OVER_SIZE).max(LEGIBLE_SIZE);
        let x = width / 2.0 - CORNER.0 * size;
        let y = (height / 2.0 - CORNER.1 * size).max(0.0);
        let fits = x >= 0.0 && libm::hypotf(x, y) >= CLEAR * side;
        Self {
            typeface: fits.then(|| Typeface::new(size)),
        }
    }

    /// Writes it, for a frame with or without a grid.
    pub(super) fn draw(&self, canvas: &mut Pixmap, flock: &Flock, grid_cm: Option<f64>) {
        let Some(typeface) = &self.typeface else {
            return;
        };
        let mut sheet = Sheet {
            width: canvas.width() as f32,
            height: canvas.height() as f32,
            canvas,
            typeface,
            em: typeface.size,
        };
        sheet.clock(flock, grid_cm);
        sheet.task(flock);
        let order = flock.order_parameters(false).ok();
        sheet.order(order.as_ref());
        let (words, towards) = match target_of(flock) {
            Some(target) => ("towards target", target),
            None => ("clockwise", Target::Clockwise),
        };
        sheet.signed_order(words, order.map(|order| order.signed_order(towards)));
    }
}

/// A number in [−1, 1] with its sign; what rounds to zero has none.
fn signed_text(number: f64) -> String {
    match format!("{number:+.2}").as_str() {
        "+0.00" | "-0.00" => "0.00".to_owned(),
        text => text.replace('-', "−"),
    }
}

/// A frame being written on; lines count from the top or the bottom edge.
struct Sheet<'a> {
    canvas: &'a mut Pixmap,
    typeface: &'a Typeface,
    width: f32,
    height: f32,
    em: f32,
}

impl Sheet<'_> {
    /// Top left: the time, the phase and the distance of grid lines.
    fn clock(&mut self, flock: &Flock, grid_cm: Option<f64>) {
        let left = EDGE * self.em;
        self.write(&format!("{:.1} s", flock.time_s()), left, self.top(0), INK);
        let (current, baseline) = (flock.phase().phase, self.top(1));
        let mut x = left;
        for &phase in Phase::ALL {
            let (name, width) = (phase.name(), self.typeface.width(phase.name()));
            let ink = if phase == current { INK } else { FAINT };
            self.write(name, x, baseline, ink);
            if phase == current {
                self.bar(x, baseline + 0.25 * self.em, width, 0.14 * self.em, INK);
            }
            x += width + 0.55 * self.em;
        }
        if let Some(spacing_cm) = grid_cm {
            self.write(&format!("grid {spacing_cm} cm"), left, self.top(2), FAINT);
        }
    }

    /// Top right: the backward duration, and above and below it the target and the leaders that there are.
    fn task(&mut self, flock: &Flock) {
        let parameters = flock.parameters();
        let backward = format!("bw {:.2} s", parameters.bw_s);
        let target = match target_of(flock) {
            Some(Target::Clockwise) => "target ↻ cw",
            Some(Target::CounterClockwise) => "target ↺ ccw",
            None if parameters.n_leaders > 0 => "targets ↻ and ↺",
            None => {
                self.write_to_right(&backward, self.top(0), INK);
                return;
            }
        };
        self.write_to_right(target, self.top(0), INK);
        self.write_to_right(&backward, self.top(1), INK);
        if target_of(flock).is_some() {
            let leaders = match parameters.n_leaders {
                1 => "1 leader".to_owned(),
                several => format!("{several} leaders"),
            };
            self.write_with_swatch(&leaders, 2, LEADER);
        } else {
            let clockwise = (0..parameters.n_leaders)
                .filter(|&leader| parameters.target.of(leader) == Target::Clockwise)
                .count();
            let others = parameters.n_leaders - clockwise;
            self.write_with_swatch(&format!("{clockwise} cw"), 2, LEADER);
            self.write_with_swatch(&format!("{others} ccw"), 3, OPPONENT);
        }
    }

    /// A line at the right edge after a square of a color.
    fn write_with_swatch(&mut self, text: &str, line: u8, color: Rgb) {
        let baseline = self.top(line);
        let x = self.write_to_right(text, baseline, INK);
        let swatch = 0.72 * self.em;
        self.bar(x - 1.1 * self.em, baseline - swatch, swatch, swatch, color);
    }

    /// Bottom left: Ψ_o.
    fn order(&mut self, order: Option<&OrderParameters>) {
        let (left, length) = (EDGE * self.em, GAUGE * self.em);
        let text = order.map_or("order Ψₒ -".to_owned(), |o| {
            format!("order Ψₒ {:.2}", o.psi_o)
        });
        self.write(&text, left, self.bottom(), INK);
        self.gauge(left, length, TRACK);
        if let Some(order) = order {
            self.gauge(left, length * order.psi_o as f32, INK);
        }
    }

    /// Bottom right: order towards the target, or the sense of rotation, from −1 to 1.
    fn signed_order(&mut self, words: &str, signed: Option<f64>) {
        let half = 0.5 * GAUGE * self.em;
        let middle = self.width - EDGE * self.em - half;
        self.gauge(middle - half, 2.0 * half, TRACK);
        let Some(signed) = signed else {
            self.write_to_right(&format!("{words} -"), self.bottom(), INK);
            return;
        };
        let text = format!("{words} {}", signed_text(signed));
        self.write_to_right(&text, self.bottom(), INK);
        let length = half * signed.abs() as f32;
        if signed < 0.0 {
            self.gauge(middle - length, length, AGAINST);
        } else {
            self.gauge(middle, length, TOWARDS);
        }
        let (tick, height) = (0.12 * self.em, 0.8 * self.em);
        let top = self.gauge_top() - 0.2 * self.em;
        self.bar(middle - tick / 2.0, top, tick, height, INK);
    }

    fn top(&self, line: u8) -> f32 {
        (EDGE + 0.75 + LINE * f32::from(line)) * self.em
    }

    /// The baseline above the gauges.
    fn bottom(&self) -> f32 {
        self.gauge_top() - 0.6 * self.em
    }

    fn gauge_top(&self) -> f32 {
        self.height - (EDGE + 0.4) * self.em
    }

    fn gauge(&mut self, x: f32, length: f32, color: Rgb) {
        self.bar(x, self.gauge_top(), length, 0.4 * self.em, color);
    }

    fn write(&mut self, text: &str, x: f32, baseline: f32, ink: Rgb) {
        self.typeface.write(self.canvas, text, x, baseline, ink);
    }

    /// Returns where the text starts.
    fn write_to_right(&mut self, text: &str, baseline: f32, ink: Rgb) -> f32 {
        let x = self.width - EDGE * self.em - self.typeface.width(text);
        self.write(text, x, baseline, ink);
        x
    }

    fn bar(&mut self, x: f32, y: f32, width: f32, height: f32, color: Rgb) {
        color.bar(self.canvas, x, y, width, height);
    }
}
