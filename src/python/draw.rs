//! Frames and moving pictures.

use super::arguments::{real, text, whole, wrong_type};
use super::flock::PyFlock;
use crate::draw::{AnimationEncoder, FrameRenderer};
use crate::error::FlockError;
use numpy::{PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Draws flocks at one size.
#[pyclass(name = "FrameRenderer", module = "flockenv._core")]
pub struct PyFrameRenderer(FrameRenderer);

#[pymethods]
impl PyFrameRenderer {
    #[new]
    fn new(width: &Bound<'_, PyAny>, height: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (width, height) = (side(width, "width")?, side(height, "height")?);
        Ok(Self(FrameRenderer::new(width, height)?))
    }

    /// A flock as it is now: (height, width, 3), uint8.
    fn draw<'py>(
        &mut self,
        py: Python<'py>,
        flock: &PyFlock,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let (height, width) = (self.0.height() as usize, self.0.width() as usize);
        let frame = PyArray3::zeros(py, [height, width, 3], false);
        self.0
            .draw_into(&*flock.read()?, frame.readwrite().as_slice_mut()?);
        Ok(frame)
    }

    /// Where a boat is in the frame, in pixels from the top left: (x, y, reach of its hull).
    fn place(&self, flock: &PyFlock, boat: &Bound<'_, PyAny>) -> PyResult<(f32, f32, f32)> {
        Ok(self.0.place(&*flock.read()?, whole(boat, "boat")?)?)
    }
}

/// Turns frames into the bytes of an animated PNG or a GIF.
#[pyclass(name = "AnimationEncoder", module = "flockenv._core")]
pub struct PyAnimationEncoder(Option<AnimationEncoder>);

#[pymethods]
impl PyAnimationEncoder {
    #[new]
    fn new(
        file_format: &Bound<'_, PyAny>,
        width: &Bound<'_, PyAny>,
        height: &Bound<'_, PyAny>,
        fps: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let format = text(file_format, "file_format")?.parse()?;
        let (width, height) = (side(width, "width")?, side(height, "height")?);
        let encoder = AnimationEncoder::new(format, width, height, real(fps, "fps")?)?;
        Ok(Self(Some(encoder)))
    }

    /// Adds a frame: (height, width, 3), uint8.
    fn add(&mut self, py: Python<'_>, frame: &Bound<'_, PyAny>) -> PyResult<()> {
        let frame = frame
            .extract::<PyReadonlyArray3<'_, u8>>()
            .map_err(|_| wrong_type(frame, "frame", "an array (height, width, 3) of uint8"))?;
        let shape = frame.shape();
        let encoder = self.encoder()?;
        // A broadcast view may claim far more than there is memory.
        encoder.check_shape(shape)?;
        // A copy, since other Python threads may write to the array meanwhile.
        let rgb: Vec<u8> = frame.as_array().iter().copied().collect();
        Ok(py.detach(|| encoder.add(shape, &rgb))?)
    }

    /// The file's bytes; nothing can be added any more.
    fn finish<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.encoder()?;
        let encoder = self.0.take();
        let bytes = encoder.map(AnimationEncoder::finish).transpose()?;
        Ok(PyBytes::new(py, &bytes.unwrap_or_default()))
    }
}

impl PyAnimationEncoder {
    fn encoder(&mut self) -> PyResult<&mut AnimationEncoder> {
        let finished = || FlockError::Episode("the animation is finished".to_owned());
        Ok(self.0.as_mut().ok_or_else(finished)?)
    }
}

/// A side in pixels; what does not fit 32 bits is as far out of range as the largest that does.
fn side(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<u32> {
    Ok(u32::try_from(whole(object, name)?).unwrap_or(u32::MAX))
}
