//! Four numbers or four vectors side by side, for the processor's vector instructions.
//!
//! No function here or in the rest of the folder passes them to a closure, for a closure cannot be forced inline: a call would pass
//! vectors through memory, and even single additions would be calls. With closures, the lanes took half as long again.

use crate::dynamics::line::{AT_ORIGIN, COINCIDENT};
use bevy::math::DVec3;
use pulp::Simd;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Number of elements side by side.
pub(crate) const LANES: usize = 4;

/// One number for each lane.
pub(super) type Each = [f64; LANES];

/// One vector for each lane, stored axis by axis.
pub(super) type EachVector = [Each; 3];

/// Puts a vector into a lane.
#[inline(always)]
pub(super) fn put(into: &mut EachVector, lane: usize, vector: DVec3) {
    for axis in 0..3 {
        into[axis][lane] = vector[axis];
    }
}

/// Returns the vector in a lane.
#[inline(always)]
pub(super) fn get(from: &EachVector, lane: usize) -> DVec3 {
    DVec3::new(from[0][lane], from[1][lane], from[2][lane])
}

/// Four numbers, and the instruction set for them, whose vectors must have four lanes.
#[derive(Clone, Copy)]
pub(super) struct Four<S: Simd>(S::f64s, S);

/// A condition for each lane.
#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd>(S::m64s, S);

impl<S: Simd> Four<S> {
    #[inline(always)]
    pub(super) fn load(simd: S, from: &Each) -> Self {
        Self(pulp::cast(*from), simd)
    }

    #[inline(always)]
    pub(super) fn store(self) -> Each {
        pulp::cast(self.0)
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(super) fn all(simd: S, number: f64) -> Self {
        Self(simd.splat_f64s(number), simd)
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self(self.1.sqrt_f64s(self.0), self.1)
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self(self.1.abs_f64s(self.0), self.1)
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Self(self.1.max_f64s(self.0, other.0), self.1)
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        Self(self.1.min_f64s(self.0, other.0), self.1)
    }

    #[inline(always)]
    pub(super) fn copysign(self, sign: Self) -> Self {
        let simd = self.1;
        let bit = simd.and_f64s(sign.0, simd.splat_f64s(-0.0));
        Self(simd.or_f64s(simd.abs_f64s(self.0), bit), simd)
    }

    /// Rounded to single precision.
    #[inline(always)]
    fn rounded(self) -> Self {
        let mut each = self.store();
        for x in &mut each {
            *x = f64::from(*x as f32);
        }
        Self::load(self.1, &each)
    }

    /// Whether each number is at most the other; false where either is NaN.
    #[inline(always)]
    pub(super) fn at_most(self, other: Self) -> Mask<S> {
        let so = self.1.less_than_or_equal_f64s(self.0, other.0);
        Mask(so, self.1)
    }
}

impl<S: Simd> Mask<S> {
    /// Returns `yes` in lanes where the condition holds, and `no` in the others.
    #[inline(always)]
    pub(super) fn select(self, yes: Four<S>, no: Four<S>) -> Four<S> {
        Four(self.1.select_f64s(self.0, yes.0, no.0), self.1)
    }

    /// The conditions as a bit mask.
    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        let (one, nothing) = (Four::all(self.1, 1.0), Four::all(self.1, 0.0));
        let each = self.select(one, nothing).store();
        let bits = each.iter().enumerate();
        bits.fold(0, |bits, (lane, x)| bits | u32::from(*x != 0.0) << lane)
    }
}

macro_rules! operators {
    ($($of:ident $operator:ident $function:ident $simd:ident),*) => {$(
        impl<S: Simd> $operator for $of<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.1.$simd(self.0, other.0), self.1)
            }
        }
    )*};
}

operators!(
    Four Add add add_f64s,
    Four Sub sub sub_f64s,
    Four Mul mul mul_f64s,
    Four Div div div_f64s,
    Mask BitAnd bitand and_m64s,
    Mask BitOr bitor or_m64s
);

impl<S: Simd> Neg for Four<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.1.neg_f64s(self.0), self.1)
    }
}

/// Four vectors.
#[derive(Clone, Copy)]
pub(super) struct Vectors<S: Simd>(pub [Four<S>; 3]);

impl<S: Simd> Vectors<S> {
    #[inline(always)]
    pub(super) fn load(simd: S, from: &EachVector) -> Self {
        let [x, y, z] = from;
        Self([
            Four::load(simd, x),
            Four::load(simd, y),
            Four::load(simd, z),
        ])
    }

    #[inline(always)]
    pub(super) fn store(&self) -> EachVector {
        let [x, y, z] = self.0;
        [x.store(), y.store(), z.store()]
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    #[inline(always)]
    pub(super) fn times(self, by: Four<S>) -> Self {
        let [a, b, c] = self.0;
        Self([by * a, by * b, by * c])
    }

    #[inline(always)]
    pub(super) fn over(self, by: Four<S>) -> Self {
        let [a, b, c] = self.0;
        Self([a / by, b / by, c / by])
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Four<S> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    #[inline(always)]
    pub(super) fn length(self) -> Four<S> {
        self.dot(self).sqrt()
    }

    /// The greatest magnitude of a component.
    #[inline(always)]
    fn largest(self) -> Four<S> {
        let [x, y, z] = self.0;
        x.abs().max(y.abs()).max(z.abs())
    }

    /// Rounded to single precision.
    #[inline(always)]
    pub(super) fn rounded(self) -> Self {
        let [x, y, z] = self.0;
        Self([x.rounded(), y.rounded(), z.rounded()])
    }
}

/// Distance up to which two points count as coincident, m; see [`crate::dynamics::element::rounding`].
#[inline(always)]
pub(super) fn rounding<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Four<S> {
    let least = Four::all(simd, AT_ORIGIN);
    Four::all(simd, COINCIDENT) * a.largest().max(b.largest()).max(least)
}
