//! The camera between flock and leaders: frames with drop-outs, and one frame late, as in the experiment
//! (0.3 % of the boats were not recognized in a frame, Section 3.1). Off by default and free then.

use crate::analysis::OrderParameters;
use crate::environment::EnvSettings;
use crate::geometry::{HullPose, Pose, Velocity};
use crate::random::{Stream, StreamRng};
use rand_chacha::rand_core::Rng;

/// What the camera does to the leaders' picture of the flock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lens {
    /// Chance that a boat is not recognized in a frame, and stays in the picture as it was in the last one.
    dropout_rate: f64,
    /// Whether the picture is a frame late.
    is_late: bool,
}

impl Lens {
    /// That of some settings; `None` where the picture does not differ from the flock at all.
    pub(crate) fn new(settings: &EnvSettings) -> Option<Self> {
        let lens = Self {
            dropout_rate: settings.dropout_rate,
            is_late: settings.delay_frames > 0,
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

/// The frames of one episode.
#[derive(Debug, Clone)]
pub(crate) struct Camera {
    lens: Lens,
    rng: StreamRng,
    frame: u64,
    now: Frame,
    before: Frame,
    hulls: Vec<HullPose>,
    order: Option<OrderParameters>,
}

/// What a camera holds, to be stored.
pub(crate) type CameraState = (u64, Frame, Frame);

impl Camera {
    /// A camera that sees the whole flock in its first frame.
    pub(crate) fn new(
        lens: Lens,
        seed: u64,
        leaders: usize,
        poses: &[Pose],
        velocities: &[Velocity],
    ) -> Self {
        let now = Frame {
            poses: poses.to_vec(),
            velocities: velocities.to_vec(),
        };
        let mut camera = Self::unexposed(lens, seed);
        camera.set_state((0, now.clone(), now), leaders);
        camera
    }

    /// A camera without a picture yet.
    pub(crate) fn unexposed(lens: Lens, seed: u64) -> Self {
        Self {
            lens,
            rng: Stream::Sensing.rng(seed),
            frame: 0,
            now: Frame::default(),
            before: Frame::default(),
            hulls: Vec::new(),
            order: None,
        }
    }

    /// Takes the next frame. Which boats drop out depends on the seed and the frame's number alone.
    pub(crate) fn expose(&mut self, leaders: usize, poses: &[Pose], velocities: &[Velocity]) {
        self.frame += 1;
        self.rng.set_stream(self.frame);
        self.rng.set_word_pos(0);
        self.before.copy_from(&self.now);
        for boat in 0..poses.len() {
            // 53 random bits as a number in [0, 1).
            let draw = (self.rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
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
        let order = OrderParameters::of_hulls(&hulls[leaders..], &seen.velocities[leaders..]).ok();
        (self.hulls, self.order) = (hulls, order);
    }

    /// The frame that leaders see now.
    pub(crate) fn seen(&self) -> &Frame {
        if self.lens.is_late {
            &self.before
        } else {
            &self.now
        }
    }

    /// Direction vectors of the frame that leaders see.
    pub(crate) fn hulls(&self) -> &[HullPose] {
        &self.hulls
    }

    /// Order parameters of that frame.
    pub(crate) fn order(&self) -> Option<&OrderParameters> {
        self.order.as_ref()
    }

    /// Whether a stored state is one of a camera on so many boats.
    pub(crate) fn fits((_, now, before): &CameraState, boats: usize) -> bool {
        [now, before].into_iter().all(|frame| {
            frame.poses.len() == boats
                && frame.velocities.len() == boats
                && frame.poses.iter().all(Pose::is_finite)
                && frame.velocities.iter().all(Velocity::is_finite)
        })
    }

    /// The frames, to be stored.
    pub(crate) fn state(&self) -> CameraState {
        (self.frame, self.now.clone(), self.before.clone())
    }

    /// Puts back what [`Self::state`] gave, for as many boats.
    pub(crate) fn set_state(&mut self, state: CameraState, leaders: usize) {
        (self.frame, self.now, self.before) = state;
        self.develop(leaders);
    }
}
