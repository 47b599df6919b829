//! The wire as a formula: the surface of the wire of a coil of a given length.
//!
//! `assets/shaders/tube.wgsl` evaluates the same formula on the graphics card; change both.

use super::{Helix, HelixEnds};
use bevy::math::Vec3;
use std::f32::consts::TAU;

/// Number of turns at each closed end that lie wire on wire.
const DEAD: f32 = 1.0;
/// Number of turns over which the pitch changes from that of the closed end to that of the active turns.
const BLEND: f32 = 0.5;

/// A point on the surface of the wire.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WirePoint {
    pub position: Vec3,
    /// Outward unit vector.
    pub normal: Vec3,
}

/// The centre line after some turns, with the frame of the wire's cross-section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WireFrame {
    pub center: Vec3,
    /// Along the wire, towards the top.
    pub tangent: Vec3,
    /// Away from the coil's axis.
    pub outward: Vec3,
    /// Perpendicular to `tangent` and `outward`, upwards.
    pub upward: Vec3,
    /// A ground end cuts off the section below this share of the wire's radius; −1 cuts off nothing.
    low: f32,
    /// A ground end cuts off the section above this share of the wire's radius; 1 cuts off nothing.
    high: f32,
}

/// A wire wound about the Y axis, from y = 0 to y = `length`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wire {
    radius: f32,
    wire_radius: f32,
    turns: f32,
    /// +1 for a right-handed coil, −1 for a left-handed one.
    hand: f32,
    ground: bool,
    /// Number of turns of one closed end.
    dead: f32,
    /// Number of turns of the blend beside a closed end.
    blend: f32,
    /// Rise per turn of the closed ends, m.
    end_pitch: f32,
    /// Rise per turn of the active turns, m.
    pitch: f32,
    /// Height of the centre line at its start, m.
    start: f32,
    /// Height that the centre line climbs from end to end, m.
    rise: f32,
}

impl Wire {
    pub fn new(helix: &Helix) -> Self {
        let Helix {
            radius,
            wire_radius,
            turns,
            length,
            ..
        } = *helix;
        let open = helix.ends == HelixEnds::Open;
        let dead = if open { 0.0 } else { DEAD.min(turns / 4.0) };
        let blend = if open {
            0.0
        } else {
            BLEND.min((turns - 2.0 * dead) / 4.0)
        };
        let mut wire = Self {
            radius,
            wire_radius,
            turns,
            hand: helix.handedness.sign(),
            ground: helix.ends == HelixEnds::ClosedGround,
            dead,
            blend,
            end_pitch: 0.0,
            pitch: 0.0,
            start: 0.0,
            rise: 0.0,
        };
        // The tip of the wire touches the seat. Its height depends on the slope of the wire there, and the slope
        // depends on the height that is left to climb. Three iterations converge to rounding.
        for _ in 0..3 {
            let slope = wire.end_pitch / (TAU * radius);
            let cosine = 1.0 / (1.0 + slope * slope).sqrt();
            wire.start = if wire.ground {
                0.0
            } else {
                wire_radius * cosine
            };
            wire.rise = (length - 2.0 * wire.start).max(0.0);
            let even = wire.rise / turns;
            // Closed ends lie wire on wire. In a coil that is shorter than that allows, all turns have the same pitch.
            wire.end_pitch = if open {
                even
            } else {
                even.min(2.0 * wire_radius)
            };
            wire.pitch =
                (wire.rise - wire.end_pitch * (2.0 * dead + blend)) / (turns - 2.0 * dead - blend);
        }
        wire
    }

    /// Height that the centre line has climbed after some turns from an end, m, and its rise per turn there, m.
    fn climb(&self, turn: f32) -> (f32, f32) {
        let (dead, blend) = (self.dead, self.blend);
        let more = self.pitch - self.end_pitch;
        if turn <= dead {
            (self.end_pitch * turn, self.end_pitch)
        } else if turn <= dead + blend {
            let x = turn - dead;
            (
                self.end_pitch * turn + more * x * x / (2.0 * blend),
                self.end_pitch + more * x / blend,
            )
        } else {
            (
                self.end_pitch * turn + more * (turn - dead - 0.5 * blend),
                self.pitch,
            )
        }
    }

    /// Cross-section of the wire after this number of turns from the foot.
    pub fn frame(&self, turn: f32) -> WireFrame {
        let (from_foot, from_top) = (turn.max(0.0), (self.turns - turn).max(0.0));
        let lower = from_foot <= from_top;
        let (climbed, pitch) = self.climb(from_foot.min(from_top));
        // The upper half is the lower half turned over.
        let above = self.start + climbed;
        let height = if lower {
            above
        } else {
            2.0 * self.start + self.rise - above
        };
        let (sin, cos) = (TAU * turn).sin_cos();
        let steep = pitch / (TAU * self.radius);
        let cosine = 1.0 / (1.0 + steep * steep).sqrt();
        let round = Vec3::new(-sin, 0.0, -self.hand * cos);
        let outward = Vec3::new(cos, 0.0, -self.hand * sin);
        let tangent = cosine * (round + Vec3::Y * steep);
        let upward = self.hand * outward.cross(tangent);
        let cut = if self.ground {
            (-above / (self.wire_radius * cosine)).max(-1.0)
        } else {
            -1.0
        };
        WireFrame {
            center: self.radius * outward + Vec3::Y * height,
            tangent,
            outward,
            upward,
            low: if lower { cut } else { -1.0 },
            high: if lower { 1.0 } else { -cut },
        }
    }

    /// Point of the surface at an angle (rad) about the wire, counted from `outward`.
    pub fn surface(&self, frame: &WireFrame, angle: f32) -> WirePoint {
        let (sin, cos) = angle.sin_cos();
        let cut = sin.clamp(frame.low, frame.high);
        let normal = if sin < cut {
            Vec3::NEG_Y
        } else if sin > cut {
            Vec3::Y
        } else {
            cos * frame.outward + sin * frame.upward
        };
        WirePoint {
            position: frame.center + self.wire_radius * (cos * frame.outward + cut * frame.upward),
            normal,
        }
    }

    /// Middle of the section, from which an end cap is drawn.
    pub fn middle(&self, frame: &WireFrame) -> Vec3 {
        let up = 0.5 * (frame.low + frame.high);
        frame.center + self.wire_radius * up * frame.upward
    }

    /// Length of the centre line, m.
    pub fn length(&self) -> f32 {
        let along = |pitch: f32, turns: f32| turns * pitch.hypot(TAU * self.radius);
        let active = self.turns - 2.0 * (self.dead + self.blend);
        // Simpson's rule is accurate enough over half a turn of slowly changing pitch.
        let middle = 0.5 * (self.end_pitch + self.pitch);
        let blend =
            (along(self.end_pitch, 1.0) + 4.0 * along(middle, 1.0) + along(self.pitch, 1.0)) / 6.0
                * self.blend;
        along(self.pitch, active) + 2.0 * (along(self.end_pitch, self.dead) + blend)
    }
}
