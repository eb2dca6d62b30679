//! GIF. Each frame has a palette of the colors that are new in it; what has not changed is left out, so
//! that still parts of the picture never flicker.

use super::changes::Changes;
use super::refused;
use crate::error::Result;
use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use std::collections::BTreeSet;

/// Index of what has not changed; colors have the others.
const UNCHANGED: u8 = 255;
/// Pixels that train a palette: more give better colors and take longer.
const TRAINING: usize = 20_000;

pub struct GifEncoder {
    encoder: Encoder<Vec<u8>>,
    fps: f64,
    frames: u32,
}

impl std::fmt::Debug for GifEncoder {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("GifEncoder").finish_non_exhaustive()
    }
}

impl GifEncoder {
    pub fn new(width: u32, height: u32, fps: f64) -> Result<Self> {
        let (width, height) = (width as u16, height as u16);
        let mut encoder = Encoder::new(Vec::new(), width, height, &[]).map_err(refused)?;
        encoder.set_repeat(Repeat::Infinite).map_err(refused)?;
        Ok(Self {
            encoder,
            fps,
            frames: 0,
        })
    }

    pub fn add(&mut self, changes: &Changes) -> Result<()> {
        let (region, palette) = (changes.region, Palette::of(changes));
        let indices: Vec<u8> = changes.pixels().map(|pixel| palette.index(pixel)).collect();
        let frame = Frame {
            delay: self.delay(),
            dispose: DisposalMethod::Keep,
            transparent: Some(UNCHANGED),
            left: region.left as u16,
            top: region.top as u16,
            width: region.width as u16,
            height: region.height as u16,
            palette: Some(palette.colors()),
            buffer: indices.into(),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(refused)?;
        self.frames += 1;
        Ok(())
    }

    /// Hundredths of a second that this frame is shown, so that the sum of all stays true.
    fn delay(&self) -> u16 {
        let end = |frames: u32| (f64::from(frames) * 100.0 / self.fps).round();
        (end(self.frames + 1) - end(self.frames)) as u16
    }

    pub fn finish(self) -> Result<Vec<u8>> {
        self.encoder.into_inner().map_err(refused)
    }
}

/// The colors of a frame's changes.
enum Palette {
    Exact(Vec<[u8; 3]>),
    Quantised(Box<NeuQuant>),
}

impl Palette {
    fn of(changes: &Changes) -> Self {
        let most = usize::from(UNCHANGED);
        let mut colors = BTreeSet::new();
        for color in changes.pixels().flatten() {
            colors.insert(color);
            if colors.len() > most {
                let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 0xFF];
                let pixels: Vec<u8> = changes.pixels().flatten().flat_map(opaque).collect();
                // Every so manieth pixel is used; the quantiser takes 1 to 30.
                let sampling = (pixels.len() / 4 / TRAINING).clamp(1, 30) as i32;
                return Self::Quantised(Box::new(NeuQuant::new(sampling, most, &pixels)));
            }
        }
        Self::Exact(colors.into_iter().collect())
    }

    fn index(&self, pixel: Option<[u8; 3]>) -> u8 {
        let Some(color) = pixel else {
            return UNCHANGED;
        };
        match self {
            Self::Exact(colors) => colors.binary_search(&color).unwrap_or(0) as u8,
            Self::Quantised(network) => {
                let [r, g, b] = color;
                network.index_of(&[r, g, b, 0xFF]) as u8
            }
        }
    }

    /// 256 colors, row by row.
    fn colors(&self) -> Vec<u8> {
        let mut colors = match self {
            Self::Exact(colors) => colors.concat(),
            Self::Quantised(network) => network.color_map_rgb(),
        };
        colors.resize(3 * 256, 0);
        colors
    }
}
