//! What differs between two frames.

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    pub left: u32,
    pub top: u32,
    pub width: u32,
    pub height: u32,
}

impl Region {
    pub fn whole(width: u32, height: u32) -> Self {
        Self {
            left: 0,
            top: 0,
            width,
            height,
        }
    }

    /// The smallest rectangle around all changes; one pixel if there is none, since files hold no
    /// empty frames.
    pub fn changed(width: u32, last: &[u8], rgb: &[u8]) -> Self {
        let (mut left, mut right, mut top, mut bottom) = (u32::MAX, 0, u32::MAX, 0);
        let row = width as usize * 3;
        for (y, (old, new)) in last
            .chunks_exact(row)
            .zip(rgb.chunks_exact(row))
            .enumerate()
        {
            if old == new {
                continue;
            }
            let differs = |x: &usize| old[3 * x..3 * x + 3] != new[3 * x..3 * x + 3];
            let columns = 0..width as usize;
            let first = columns.clone().find(differs).unwrap_or(0) as u32;
            let end = columns.rev().find(differs).unwrap_or(0) as u32;
            (left, right) = (left.min(first), right.max(end));
            (top, bottom) = (top.min(y as u32), y as u32);
        }
        if left > right {
            return Self::whole(1, 1);
        }
        Self {
            left,
            top,
            width: right - left + 1,
            height: bottom - top + 1,
        }
    }
}

/// A frame beside the one before it, which is empty for the first.
#[derive(Debug)]
pub struct Changes<'a> {
    pub region: Region,
    /// Pixels in a row of the frame.
    pub width: usize,
    pub last: &'a [u8],
    pub rgb: &'a [u8],
}

impl Changes<'_> {
    /// The pixels of the region, row by row; `None` where nothing has changed.
    pub fn pixels(&self) -> impl Iterator<Item = Option<[u8; 3]>> {
        let Region {
            left,
            top,
            width,
            height,
        } = self.region;
        let rows = top as usize..(top + height) as usize;
        rows.flat_map(move |y| {
            let start = y * self.width + left as usize;
            (start..start + width as usize).map(|pixel| {
                let place = 3 * pixel..3 * pixel + 3;
                let new = &self.rgb[place.clone()];
                (self.last.get(place) != Some(new)).then(|| [new[0], new[1], new[2]])
            })
        })
    }
}
