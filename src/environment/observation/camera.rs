//! The camera between flock and leaders: its frames miss boats and may come one frame late. In the experiment 0.3 % of
//! the boats were not recognized in a frame (Section 3.1). It is off by default, and then costs nothing.

use super::view::FlockView;
use crate::analysis::OrderParameters;
use crate::flock::Flock;
use crate::geometry::{HullPose, Pose, Velocity};
use crate::random::Stream;
use rand_chacha::rand_core::Rng;

/// Flaws of the camera through which leaders see the flock.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Lens {
    /// Chance that a boat is not recognized in a frame, which then shows it as in the last one.
    dropout_rate: f64,
    /// Whether the picture is a frame late.
    is_late: bool,
}

impl Lens {
    /// A lens that loses boats at a rate and is some frames late; `None` for a perfect picture.
    pub(crate) fn new(dropout_rate: f64, delay_frames: usize) -> Option<Self> {
        let lens = Self {
            dropout_rate,
            is_late: delay_frames > 0,
        };
        (lens.dropout_rate > 0.0 || lens.is_late).then_some(lens)
    }
}

/// Poses and velocities as seen in one frame.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Frame {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
}

impl Frame {
    fn copy_from(&mut self, other: &Self) {
        self.poses.clone_from(&other.poses);
        self.velocities.clone_from(&other.velocities);
    }
}

/// The frames of one episode. Only the frames are stored.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Camera {
    frame: u64,
    now: Frame,
    before: Frame,
    #[serde(skip)]
    lens: Lens,
    #[serde(skip)]
    seed: u64,
    #[serde(skip)]
    hulls: Vec<HullPose>,
    #[serde(skip)]
    order: Option<OrderParameters>,
}

impl Camera {
    /// A camera at an episode's start: its first frame loses no boat.
    pub(crate) fn new(lens: Lens, seed: u64, leaders: usize, flock: &Flock) -> Self {
        let now = Frame {
            poses: flock.poses().to_vec(),
            velocities: flock.velocities().to_vec(),
        };
        let camera = Self {
            frame: 0,
            before: now.clone(),
            now,
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
        self.develop(leaders);
        self
    }

    /// Takes the next frame. The dropped boats depend on the seed and the frame's number alone.
    pub(crate) fn expose(&mut self, leaders: usize, flock: &Flock) {
        let (poses, velocities) = (flock.poses(), flock.velocities());
        self.frame += 1;
        let mut rng = Stream::SENSING.rng(self.seed);
        rng.set_stream(self.frame);
        self.before.copy_from(&self.now);
        for boat in 0..poses.len() {
            // 53 random bits as a number in [0, 1).
            let draw = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            if draw >= self.lens.dropout_rate {
                self.now.poses[boat] = poses[boat];
                self.now.velocities[boat] = velocities[boat];
            }
        }
        self.develop(leaders);
    }

    fn develop(&mut self, leaders: usize) {
        let mut hulls = std::mem::take(&mut self.hulls);
        let seen = self.seen();
        HullPose::replace_all(&mut hulls, &seen.poses);
        let order =
            OrderParameters::from_hulls(&hulls[leaders..], &seen.velocities[leaders..]).ok();
        (self.hulls, self.order) = (hulls, order);
    }

    /// The view of a flock as leaders see it now.
    pub(crate) fn through<'a>(&'a self, flock: FlockView<'a>) -> FlockView<'a> {
        FlockView {
            poses: &self.seen().poses,
            velocities: &self.seen().velocities,
            hulls: &self.hulls,
            order: self.order.as_ref(),
            ..flock
        }
    }

    fn seen(&self) -> &Frame {
        if self.lens.is_late {
            &self.before
        } else {
            &self.now
        }
    }

    /// Whether stored frames have this number of boats.
    pub(crate) fn fits(&self, boats: usize) -> bool {
        [&self.now, &self.before].into_iter().all(|frame| {
            frame.poses.len() == boats
                && frame.velocities.len() == boats
                && frame.poses.iter().all(Pose::is_finite)
                && frame.velocities.iter().all(Velocity::is_finite)
        })
    }
}
