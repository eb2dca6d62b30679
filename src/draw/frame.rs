//! Frames: a pool, hulls with a direction mark in colors that show order or who leads, and a legend. A frame depends only
//! on the flock, its look and its size.

use super::legend::Legend;
use super::look::{Look, target_of};
use super::view::View;
use super::{boats, water};
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::parameters::{FlockParameters, Target};
use tiny_skia::Pixmap;

/// Draws frames of one size. The background of a pool is drawn once and kept.
#[derive(Debug, Clone)]
pub struct FrameRenderer {
    canvas: Pixmap,
    legend: Legend,
    background: Option<Background>,
}

/// Water, walls and obstacles of a pool, with its target's arrow.
#[derive(Debug, Clone)]
struct Background {
    parameters: FlockParameters,
    target: Option<Target>,
    image: Pixmap,
}

impl FrameRenderer {
    /// The shortest side of a frame, in pixels.
    pub const SHORTEST: u32 = 64;
    /// The longest side of a frame, in pixels.
    pub const LONGEST: u32 = 4096;

    /// A renderer of frames of this size in pixels.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a side outside [`Self::SHORTEST`] to [`Self::LONGEST`].
    pub fn new(width: u32, height: u32) -> Result<Self> {
        for (field, side) in [("width", width), ("height", height)] {
            let accepted = format!("{} to {} pixels", Self::SHORTEST, Self::LONGEST);
            let is_accepted = (Self::SHORTEST..=Self::LONGEST).contains(&side);
            FlockError::unless(is_accepted, field, side, accepted)?;
        }
        let canvas = Pixmap::new(width, height)
            .ok_or_else(|| FlockError::parameter("width", width, "a size that fits memory"))?;
        Ok(Self {
            legend: Legend::new(width, height),
            canvas,
            background: None,
        })
    }

    /// Width of a frame in pixels.
    pub fn width(&self) -> u32 {
        self.canvas.width()
    }

    /// Height of a frame in pixels.
    pub fn height(&self) -> u32 {
        self.canvas.height()
    }

    /// A flock as it is now: red, green and blue of each pixel, row by row from the top left.
    pub fn draw(&mut self, flock: &Flock) -> Vec<u8> {
        self.draw_with(flock, Look::default())
    }

    /// As [`Self::draw`], with another look.
    pub fn draw_with(&mut self, flock: &Flock, look: Look<'_>) -> Vec<u8> {
        self.draw_canvas(flock, look);
        let mut frame = Vec::with_capacity(self.canvas.pixels().len() * 3);
        // The canvas is opaque, so its premultiplied colors are the plain colors.
        for pixel in self.canvas.data().chunks_exact(4) {
            frame.extend_from_slice(&pixel[..3]);
        }
        frame
    }

    /// A flock as it is now, as a PNG file.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the picture cannot be encoded.
    pub fn png(&mut self, flock: &Flock) -> Result<Vec<u8>> {
        self.draw_canvas(flock, Look::default());
        let refuse = |error| FlockError::parameter("frame", error, "a picture that PNG can hold");
        self.canvas.encode_png().map_err(refuse)
    }

    fn draw_canvas(&mut self, flock: &Flock, look: Look<'_>) {
        let view = View::from_flock(flock, self.width(), self.height());
        self.draw_background(flock, &view);
        boats::draw(&mut self.canvas, flock, &view, look.coloring);
        let is_open_water = !flock.parameters().pool.has_outer_wall();
        let grid_cm = is_open_water.then(|| water::grid_spacing(&view));
        self.legend.draw(&mut self.canvas, flock, grid_cm, look);
    }

    fn draw_background(&mut self, flock: &Flock, view: &View) {
        let (parameters, target) = (flock.parameters(), target_of(flock));
        if !parameters.pool.has_outer_wall() {
            water::draw(&mut self.canvas, parameters, target, view);
            return;
        }
        if let Some(background) = &self.background
            && background.target == target
            && background.parameters.has_same_water(parameters)
        {
            let image = background.image.data();
            self.canvas.data_mut().copy_from_slice(image);
            return;
        }
        water::draw(&mut self.canvas, parameters, target, view);
        self.background = Some(Background {
            parameters: parameters.clone(),
            target,
            image: self.canvas.clone(),
        });
    }
}
