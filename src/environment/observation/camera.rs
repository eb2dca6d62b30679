//! The camera through which leaders see the flock: a frame may miss boats, and the leaders' picture may be one frame
//! late. In the experiment 0.3 % of the boats were not recognized in a frame (Section 3.1). By default there is no
//! camera: leaders see the flock as it is.

use super::view::FlockView;
use crate::analysis::OrderParameters;
use crate::flock::Flock;
use crate::geometry::{HullPose, Pose, Velocity};
use crate::random::Stream;
use rand_chacha::rand_core::Rng;

/// Flaws of the camera through which leaders see the flock.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Lens {
    /// Chance that a frame misses a boat, which then stays as in the frame before.
    dropout_rate: f64,
    /// Whether leaders see the frame before the latest one.
    is_late: bool,
}

impl Lens {
    /// The flaws of a camera with this chance of missing a boat and this delay; `None` if the picture is perfect.
    pub(crate) fn new(dropout_rate: f64, delay_frames: usize) -> Option<Self> {
        let lens = Self {
            dropout_rate,
            is_late: delay_frames > 0,
        };
        (lens.dropout_rate > 0.0 || lens.is_late).then_some(lens)
    }
}

/// Poses and velocities of the boats in one frame.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Frame {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
}

impl Frame {
    /// Becomes a copy of another frame, in the same memory.
    fn copy_from(&mut self, other: &Self) {
        self.poses.clone_from(&other.poses);
        self.velocities.clone_from(&other.velocities);
    }
}

/// The camera of one episode, with its last two frames. Only the frames and their number are stored.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Camera {
    /// Number of the latest frame, from 0.
    frame: u64,
    latest: Frame,
    previous: Frame,
    #[serde(skip)]
    lens: Lens,
    /// Seed of the episode's flock.
    #[serde(skip)]
    seed: u64,
    /// Poses with direction vectors in the frame that leaders see.
    #[serde(skip)]
    hulls: Vec<HullPose>,
    /// Order parameters of the normal boats in that frame; `None` if there are none.
    #[serde(skip)]
    order: Option<OrderParameters>,
}

impl Camera {
    /// A camera at an episode's start: its first frame misses no boat.
    pub(crate) fn new(lens: Lens, seed: u64, leaders: usize, flock: &Flock) -> Self {
        let latest = Frame {
            poses: flock.poses().to_vec(),
            velocities: flock.velocities().to_vec(),
        };
        let camera = Self {
            frame: 0,
            previous: latest.clone(),
            latest,
            lens,
            seed,
            hulls: Vec::new(),
            order: None,
        };
        camera.with_lens(lens, seed, leaders)
    }

    /// The camera with its lens and its episode's seed, which are not stored with the frames.
    pub(crate) fn with_lens(mut self, lens: Lens, seed: u64, leaders: usize) -> Self {
        (self.lens, self.seed) = (lens, seed);
        self.update_visible(leaders);
        self
    }

    /// Takes the next frame. Which boats it misses depends only on its rate, the seed and the frame's number.
    pub(crate) fn take_frame(&mut self, leaders: usize, flock: &Flock) {
        let (poses, velocities) = (flock.poses(), flock.velocities());
        self.frame += 1;
        let mut rng = Stream::SENSING.rng(self.seed);
        rng.set_stream(self.frame);
        self.previous.copy_from(&self.latest);
        for boat in 0..poses.len() {
            // 53 random bits as a number in [0, 1).
            let draw = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            if draw >= self.lens.dropout_rate {
                self.latest.poses[boat] = poses[boat];
                self.latest.velocities[boat] = velocities[boat];
            }
        }
        self.update_visible(leaders);
    }

    /// Computes direction vectors and order parameters for the frame that leaders see.
    fn update_visible(&mut self, leaders: usize) {
        let mut hulls = std::mem::take(&mut self.hulls);
        let frame = self.visible_frame();
        HullPose::replace_all(&mut hulls, &frame.poses);
        let order =
            OrderParameters::from_hulls(&hulls[leaders..], &frame.velocities[leaders..]).ok();
        (self.hulls, self.order) = (hulls, order);
    }

    /// The view of a flock as leaders see it now.
    pub(crate) fn through<'a>(&'a self, flock: FlockView<'a>) -> FlockView<'a> {
        FlockView {
            poses: &self.visible_frame().poses,
            velocities: &self.visible_frame().velocities,
            hulls: &self.hulls,
            order: self.order.as_ref(),
            ..flock
        }
    }

    /// The frame that leaders see.
    fn visible_frame(&self) -> &Frame {
        if self.lens.is_late {
            &self.previous
        } else {
            &self.latest
        }
    }

    /// Whether stored frames have this number of boats and finite numbers.
    pub(crate) fn fits(&self, boats: usize) -> bool {
        [&self.latest, &self.previous].into_iter().all(|frame| {
            frame.poses.len() == boats
                && frame.velocities.len() == boats
                && frame.poses.iter().all(Pose::is_finite)
                && frame.velocities.iter().all(Velocity::is_finite)
        })
    }
}
