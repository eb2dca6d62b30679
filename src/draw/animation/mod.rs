//! Moving pictures: animated PNG (lossless) and GIF (shown everywhere). Each frame holds only what has
//! changed since the one before.

mod apng;
mod changes;
mod gif;

use crate::error::{FlockError, Result};
use crate::parameters::named_choice;
use apng::ApngEncoder;
use changes::{Changes, Region};
use gif::GifEncoder;

named_choice! {
    /// A file format of moving pictures.
    pub enum AnimationFormat ("file_format") {
        /// Animated PNG: every color as it is.
        Apng = "apng",
        /// GIF: up to 255 new colors a frame.
        Gif = "gif",
    }
}

/// Turns frames into the bytes of a file, one after another.
#[derive(Debug)]
pub struct AnimationEncoder {
    size: (u32, u32),
    frames: u32,
    last: Vec<u8>,
    encoder: Encoder,
}

#[derive(Debug)]
enum Encoder {
    Apng(Box<ApngEncoder>),
    Gif(Box<GifEncoder>),
}

impl AnimationEncoder {
    /// The slowest and the fastest animation, in frames per second.
    pub const RATES: (f64, f64) = (0.1, 100.0);
    /// The longest side in pixels: GIF counts in 16 bits.
    pub const LONGEST: u32 = 65_535;

    /// For frames of a size in pixels, shown at a constant rate, over and over.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a size or rate out of range.
    pub fn new(format: AnimationFormat, width: u32, height: u32, fps: f64) -> Result<Self> {
        for (field, side) in [("width", width), ("height", height)] {
            if !(1..=Self::LONGEST).contains(&side) {
                let accepted = format!("1 to {} pixels", Self::LONGEST);
                return Err(FlockError::parameter(field, side, accepted));
            }
        }
        let (slowest, fastest) = Self::RATES;
        if !(slowest..=fastest).contains(&fps) {
            let accepted = format!("{slowest} to {fastest} frames per second");
            return Err(FlockError::parameter("fps", fps, accepted));
        }
        let encoder = match format {
            AnimationFormat::Apng => Encoder::Apng(Box::new(ApngEncoder::new(width, height, fps)?)),
            AnimationFormat::Gif => Encoder::Gif(Box::new(GifEncoder::new(width, height, fps)?)),
        };
        Ok(Self {
            size: (width, height),
            frames: 0,
            last: Vec::new(),
            encoder,
        })
    }

    /// Frames added so far.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Checks that a frame of a shape (height, width, 3) can be added.
    ///
    /// # Errors
    /// [`FlockError::Shape`] for another shape than that of this animation's frames.
    pub fn check_shape(&self, shape: &[usize]) -> Result<()> {
        let (width, height) = self.size;
        if shape == [height as usize, width as usize, 3] {
            return Ok(());
        }
        Err(FlockError::Shape {
            field: "frame",
            found: format!("{shape:?}").replace('[', "(").replace(']', ")"),
            expected: format!("({height}, {width}, 3)"),
        })
    }

    /// Adds a frame of a shape (height, width, 3): red, green and blue of each pixel, row by row from the
    /// top left.
    ///
    /// # Errors
    /// [`FlockError::Shape`] for another shape than that of this animation's frames.
    pub fn add(&mut self, shape: &[usize], rgb: &[u8]) -> Result<()> {
        self.check_shape(shape)?;
        let (width, height) = self.size;
        if rgb.len() != shape.iter().product::<usize>() {
            let accepted = "as many bytes as its shape has";
            return Err(FlockError::parameter("frame", rgb.len(), accepted));
        }
        let region = if self.frames == 0 {
            Region::whole(width, height)
        } else {
            Region::changed(width, &self.last, rgb)
        };
        let changes = Changes {
            region,
            width: width as usize,
            last: &self.last,
            rgb,
        };
        match &mut self.encoder {
            Encoder::Apng(encoder) => encoder.add(&changes)?,
            Encoder::Gif(encoder) => encoder.add(&changes)?,
        }
        self.frames += 1;
        self.last.clear();
        self.last.extend_from_slice(rgb);
        Ok(())
    }

    /// The file's bytes.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if there is no frame.
    pub fn finish(self) -> Result<Vec<u8>> {
        if self.frames == 0 {
            return Err(FlockError::parameter(
                "frames",
                "none",
                "at least one frame",
            ));
        }
        match self.encoder {
            Encoder::Apng(encoder) => encoder.finish(self.frames),
            Encoder::Gif(encoder) => encoder.finish(),
        }
    }
}

/// Writing to memory fails only where the format's own limits are passed.
fn refused(error: impl std::fmt::Display) -> FlockError {
    FlockError::parameter("frames", error, "frames that the file format can hold")
}
