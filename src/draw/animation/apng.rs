//! Animated PNG. The number of frames stands before the frames, and is filled in at the end.

use super::changes::Changes;
use super::refused;
use crate::error::Result;
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

/// Where PNG's fixed header leaves the chunk `acTL`: signature (8), IHDR (25), the chunk's length (4).
const ACTL: usize = 37;
/// More frames than any file has, until their number is known.
const UNKNOWN: u32 = i32::MAX as u32;

#[derive(Debug, Clone, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Writes frames as differences to the ones before.
pub struct ApngEncoder {
    sink: Sink,
    writer: png::Writer<Sink>,
}

impl std::fmt::Debug for ApngEncoder {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("ApngEncoder")
            .finish_non_exhaustive()
    }
}

impl ApngEncoder {
    pub fn new(width: u32, height: u32, fps: f64) -> Result<Self> {
        let sink = Sink::default();
        let mut encoder = png::Encoder::new(sink.clone(), width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_animated(UNKNOWN, 0).map_err(refused)?;
        let hundredths = (fps * 100.0).round() as u16;
        encoder.set_frame_delay(100, hundredths).map_err(refused)?;
        encoder.set_blend_op(png::BlendOp::Over).map_err(refused)?;
        let dispose = png::DisposeOp::None;
        encoder.set_dispose_op(dispose).map_err(refused)?;
        let writer = encoder.write_header().map_err(refused)?;
        Ok(Self { sink, writer })
    }

    pub fn add(&mut self, changes: &Changes) -> Result<()> {
        let region = changes.region;
        let writer = &mut self.writer;
        writer.reset_frame_position().map_err(refused)?;
        writer
            .set_frame_dimension(region.width, region.height)
            .map_err(refused)?;
        writer
            .set_frame_position(region.left, region.top)
            .map_err(refused)?;
        let rgba = |pixel: Option<[u8; 3]>| pixel.map_or([0; 4], |[r, g, b]| [r, g, b, 0xFF]);
        let data: Vec<u8> = changes.pixels().flat_map(rgba).collect();
        writer.write_image_data(&data).map_err(refused)
    }

    pub fn finish(self, frames: u32) -> Result<Vec<u8>> {
        self.writer.finish().map_err(refused)?;
        let mut bytes = self.sink.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut bytes = std::mem::take(&mut *bytes);
        bytes[ACTL + 4..ACTL + 8].copy_from_slice(&frames.to_be_bytes());
        let check = crc32fast::hash(&bytes[ACTL..ACTL + 12]);
        bytes[ACTL + 12..ACTL + 16].copy_from_slice(&check.to_be_bytes());
        Ok(bytes)
    }
}
