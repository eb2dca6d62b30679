//! The colors of frames, pages and plots, declared once: Okabe and Ito's set on pale water, which color-blind people
//! can distinguish, and counterparts for dark ground, which only pages use.

use std::fmt;

use crate::geometry::{Pose, lap_frame};
use crate::parameters::named_choice;

/// An opaque color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// A color from its hexadecimal code, as in 0xD55E00.
const fn hex(code: u32) -> Rgb {
    Rgb((code >> 16) as u8, (code >> 8) as u8, code as u8)
}

/// Writes the color as in a style sheet: `#0072b2`.
impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(r, g, b) = self;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Okabe and Ito's blue.
pub const BLUE: Rgb = hex(0x0072B2);
/// Okabe and Ito's vermilion.
pub const VERMILION: Rgb = hex(0xD55E00);
/// Okabe and Ito's bluish green.
pub const GREEN: Rgb = hex(0x009E73);
/// Okabe and Ito's reddish purple.
pub const PURPLE: Rgb = hex(0xCC79A7);
/// Okabe and Ito's orange.
pub const ORANGE: Rgb = hex(0xE69F00);
/// Okabe and Ito's sky blue.
pub const SKY_BLUE: Rgb = hex(0x56B4E9);
/// Okabe and Ito's black.
pub const BLACK: Rgb = hex(0x000000);

/// Okabe and Ito's colors by name, in the order in which plots take them. Their yellow is too pale for lines on white.
pub const OKABE_ITO: &[(&str, Rgb)] = &[
    ("blue", BLUE),
    ("vermilion", VERMILION),
    ("green", GREEN),
    ("purple", PURPLE),
    ("orange", ORANGE),
    ("sky blue", SKY_BLUE),
    ("black", BLACK),
];

/// A color of the palette, for light and for dark ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Swatch {
    /// Its name in pages.
    pub name: &'static str,
    /// On light ground, and in frames.
    pub light: Rgb,
    /// On dark ground.
    pub dark: Rgb,
}

/// Declares a constant for each color on light ground, and the list of all colors.
macro_rules! declare_palette {
    ($($(#[doc = $doc:literal])+ $constant:ident = $name:literal: $light:expr, $dark:expr;)+) => {
        $($(#[doc = $doc])+ pub const $constant: Rgb = $light;)+

        /// Every color.
        pub const PALETTE: &[Swatch] = &[
            $(Swatch { name: $name, light: $light, dark: $dark },)+
        ];
    };
}

declare_palette! {
    /// The ground around the pool, and the obstacle in its middle.
    GROUND = "ground": hex(0xF7F5F0), hex(0x14191F);
    /// The walls.
    WALL = "wall": hex(0x7C8690), hex(0x6B7680);
    /// The water.
    WATER = "water": hex(0xDCEAF3), hex(0x213544);
    /// Grid lines of open water.
    GRID = "grid": hex(0xC6D8E4), hex(0x34495A);
    /// Text.
    INK = "ink": hex(0x1F2A36), hex(0xE8EDF2);
    /// Muted text.
    FAINT = "faint": hex(0x667079), hex(0x99A5AF);
    /// The arrow that shows the target.
    TARGET = "target": hex(0xC3C9CE), hex(0x3A4651);
    /// Boats that head clockwise.
    CLOCKWISE = "clockwise": BLUE, hex(0x3D9BD6);
    /// Boats that head counter-clockwise.
    COUNTER_CLOCKWISE = "counter-clockwise": VERMILION, hex(0xE8742A);
    /// Boats that head along the radius: outward as in a jam, or inward.
    RADIAL = "radial": hex(0x9AA4AE), hex(0x8B98A5);
    /// Normal boats whose color shows their role.
    NORMAL = "normal": BLUE, hex(0x3D9BD6);
    /// Direction marks of boats.
    MARK = "mark": hex(0xFFFFFF), hex(0xFFFFFF);
    /// Leaders: their ring, or their hull if color shows the role.
    LEADER = "leader": hex(0xF0A202), hex(0xF0A202);
    /// Leaders with a counter-clockwise target, if others have a clockwise one.
    OPPONENT = "opponent": hex(0x5B1A63), hex(0xB050F8);
    /// Direction marks of leaders in amber.
    LEADER_MARK = "leader-mark": hex(0x1F2A36), hex(0x14191F);
    /// Outlines of hulls.
    OUTLINE = "outline": hex(0x1F2A36), hex(0x0C1116);
    /// Bars of contact forces.
    FORCE = "force": hex(0xC2185B), hex(0xFF5C9A);
    /// The ring around the selected boat.
    PIN = "pin": hex(0x1F2A36), hex(0xFFFFFF);
    /// The paper's law, in pages and plots. No policy has the color of a direction.
    PAPER_LAW = "paper-law": hex(0x5E2CA5), hex(0xD0B3FF);
    /// The damped law.
    DAMPED_LAW = "damped-law": hex(0x7A4A12), hex(0xA0705F);
    /// The tuned law, which is the damped law with other gains.
    TUNED_LAW = "tuned-law": ORANGE, ORANGE;
    /// The learned leaders.
    LEARNED = "learned": GREEN, hex(0x7BD88F);
    /// A run without a law, or a law's second run.
    RUN_1 = "run-1": hex(0x3A4651), hex(0xE8EDF2);
    /// Another run of that kind.
    RUN_2 = "run-2": hex(0xB5508A), hex(0xE8A0C8);
    /// Rails of gauges, and borders.
    TRACK = "track": hex(0xDDDCD6), hex(0x2C353E);
    /// Faces of buttons and cards.
    FACE = "face": hex(0xFFFFFF), hex(0x1D242C);
}

named_choice! {
    /// Meaning of a boat's color.
    pub enum Coloring ("colors") {
        /// The direction in which it circles: clockwise, counter-clockwise, or neither. Leaders are ringed.
        Direction = "direction",
        /// Whether it leads.
        Role = "role",
    }
}

/// A boat circles if |sin φ| of its LAP orientation φ is at least this: if it heads at least 30° off the radius.
pub const CIRCLES_FROM: f64 = 0.5;

/// The color of the direction in which a boat circles.
pub fn tint(pose: &Pose) -> Rgb {
    let clockwise = libm::sin(lap_frame::orientation(pose));
    if clockwise >= CIRCLES_FROM {
        CLOCKWISE
    } else if clockwise <= -CIRCLES_FROM {
        COUNTER_CLOCKWISE
    } else {
        RADIAL
    }
}

/// The palette as custom properties of a style sheet, for light ground and for dark.
pub fn style_sheet() -> String {
    let properties = |shade: fn(&Swatch) -> Rgb| -> String {
        let swatches = PALETTE.iter();
        swatches
            .map(|swatch| format!("--{}:{};", swatch.name, shade(swatch)))
            .collect()
    };
    format!(
        ":root{{color-scheme:light dark;--circles-from:{CIRCLES_FROM};{}}}\n\
         @media (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        properties(|swatch| swatch.light),
        properties(|swatch| swatch.dark),
    )
}
