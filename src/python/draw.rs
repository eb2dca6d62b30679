//! Frames.

use super::arguments::whole;
use super::flock::PyFlock;
use crate::draw::FrameRenderer;
use numpy::{PyArray3, PyArrayMethods};
use pyo3::prelude::*;

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

/// A side in pixels; what does not fit 32 bits is as far out of range as the largest that does.
fn side(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<u32> {
    Ok(u32::try_from(whole(object, name)?).unwrap_or(u32::MAX))
}
