//! Frames.

use super::arguments::whole;
use super::flock::PyFlock;
use crate::draw::FrameRenderer;
use crate::error::Result;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Draws flocks at one size, for one thread at a time: others wait.
#[pyclass(name = "FrameRenderer", module = "flockenv._core", frozen)]
pub struct PyFrameRenderer(Mutex<FrameRenderer>);

impl PyFrameRenderer {
    fn lock(&self) -> MutexGuard<'_, FrameRenderer> {
        // Every frame is drawn again: nothing remains of one that was not finished.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyFrameRenderer {
    #[new]
    fn new(width: &Bound<'_, PyAny>, height: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (width, height) = (side(width, "width")?, side(height, "height")?);
        Ok(Self(Mutex::new(FrameRenderer::new(width, height)?)))
    }

    /// A flock as it is now: (height, width, 3), uint8.
    fn draw<'py>(&self, py: Python<'py>, flock: &PyFlock) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let (shape, frame) = py.detach(|| -> Result<_> {
            let mut renderer = self.lock();
            let shape = [renderer.height() as usize, renderer.width() as usize, 3];
            Ok((shape, renderer.draw(&*flock.read()?)))
        })?;
        PyArray1::from_vec(py, frame).reshape(shape)
    }

    /// Where a boat is in the frame, in pixels from the top left: (x, y, reach of its hull).
    fn place(
        &self,
        py: Python<'_>,
        flock: &PyFlock,
        boat: &Bound<'_, PyAny>,
    ) -> PyResult<(f32, f32, f32)> {
        let boat = whole(boat, "boat")?;
        Ok(py.detach(|| self.lock().place(&*flock.read()?, boat))?)
    }
}

/// A side in pixels; what does not fit 32 bits is as far out of range as the largest that does.
fn side(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<u32> {
    Ok(u32::try_from(whole(object, name)?).unwrap_or(u32::MAX))
}
