//! The colors of frames and pages, declared once: Okabe and Ito's set, which color-blind eyes distinguish too, on
//! pale water, and their counterparts on dark ground, which pages alone have.

use crate::geometry::{Pose, lap_frame};
use crate::parameters::named_choice;

/// An opaque color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl Rgb {
    const fn hex(code: u32) -> Self {
        Self((code >> 16) as u8, (code >> 8) as u8, code as u8)
    }
}

/// A color on light ground, and on dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Swatch {
    /// Its name in pages.
    pub name: &'static str,
    /// On light ground, and in frames.
    pub light: Rgb,
    /// On dark ground.
    pub dark: Rgb,
}

macro_rules! declare_palette {
    ($($(#[doc = $doc:literal])+ $constant:ident = $name:literal $light:literal $dark:literal,)+) => {
        $($(#[doc = $doc])+ pub const $constant: Rgb = Rgb::hex($light);)+

        /// Every color.
        pub const PALETTE: &[Swatch] = &[
            $(Swatch { name: $name, light: Rgb::hex($light), dark: Rgb::hex($dark) },)+
        ];
    };
}

declare_palette! {
    /// What surrounds the pool, and the obstacle in its middle.
    GROUND = "ground" 0xF7F5F0 0x14191F,
    /// The walls.
    WALL = "wall" 0x7C8690 0x6B7680,
    /// The water.
    WATER = "water" 0xDCEAF3 0x213544,
    /// Grid lines of open water.
    GRID = "grid" 0xC6D8E4 0x34495A,
    /// Text.
    INK = "ink" 0x1F2A36 0xE8EDF2,
    /// Text that stands back.
    FAINT = "faint" 0x667079 0x99A5AF,
    /// The arrow that shows the target.
    TARGET = "target" 0xC3C9CE 0x3A4651,
    /// Boats that head clockwise.
    CLOCKWISE = "clockwise" 0x0072B2 0x3D9BD6,
    /// Boats that head counter-clockwise.
    COUNTER_CLOCKWISE = "counter-clockwise" 0xD55E00 0xE8742A,
    /// Boats that head along the radius: outward as in a jam, or inward.
    RADIAL = "radial" 0x9AA4AE 0x8B98A5,
    /// Normal boats whose color shows their role.
    NORMAL = "normal" 0x0072B2 0x3D9BD6,
    /// Direction marks of boats.
    MARK = "mark" 0xFFFFFF 0xFFFFFF,
    /// Leaders: their ring, or their hull where color shows the role.
    LEADER = "leader" 0xF0A202 0xF0A202,
    /// Leaders with a counter-clockwise target, where others have a clockwise one.
    OPPONENT = "opponent" 0x5B1A63 0x5B1A63,
    /// Direction marks of leaders in amber.
    LEADER_MARK = "leader-mark" 0x1F2A36 0x14191F,
    /// Outlines of hulls.
    OUTLINE = "outline" 0x1F2A36 0x0C1116,
    /// Bars of contact forces.
    FORCE = "force" 0xC2185B 0xFF5C9A,
    /// The ring around the boat that is chosen.
    PIN = "pin" 0x1F2A36 0xFFFFFF,
    /// The first run's lines.
    RUN_1 = "run-1" 0x5E2CA5 0xD0B3FF,
    /// The second run's lines.
    RUN_2 = "run-2" 0x2E7D32 0x7BD88F,
    /// Rails of gauges, and borders.
    TRACK = "track" 0xDDDCD6 0x2C353E,
    /// Faces of buttons and cards.
    FACE = "face" 0xFFFFFF 0x1D242C,
}

named_choice! {
    /// What the color of a boat shows.
    pub enum Coloring ("colors") {
        /// The direction in which it circles: clockwise, counter-clockwise, or neither. Leaders are ringed.
        Direction = "direction",
        /// Whether it leads.
        Role = "role",
    }
}

/// The least |sin φ| of a boat that circles: 30° off the radius.
pub const CIRCLES_FROM: f64 = 0.5;

/// The color of the direction that a boat heads in.
pub fn tint(pose: &Pose) -> Rgb {
    let along = libm::sin(lap_frame::orientation(pose));
    if along >= CIRCLES_FROM {
        CLOCKWISE
    } else if along <= -CIRCLES_FROM {
        COUNTER_CLOCKWISE
    } else {
        RADIAL
    }
}

/// The palette as custom properties of a style sheet, for light ground and for dark.
pub fn style_sheet() -> String {
    let colors = |of: fn(&Swatch) -> Rgb| -> String {
        let lines = PALETTE.iter().map(|each| (each.name, of(each)));
        lines
            .map(|(name, Rgb(r, g, b))| format!("--{name}:#{r:02x}{g:02x}{b:02x};"))
            .collect()
    };
    format!(
        ":root{{color-scheme:light dark;--circles-from:{CIRCLES_FROM};{}}}\n\
         @media (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        colors(|each| each.light),
        colors(|each| each.dark),
    )
}
