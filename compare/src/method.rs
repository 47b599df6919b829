//! The methods that make a spring, the accuracy dial of each method, and the settings that are compared.

use std::fmt;

/// Implementation of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    Ours,
    Force,
    Joint,
    Avian,
    /// Avian's joint without damping: that damping would also brake motion across the line of the spring.
    AvianBare,
}

impl Method {
    pub const ALL: [Self; 5] = [
        Self::Ours,
        Self::Force,
        Self::Joint,
        Self::Avian,
        Self::AvianBare,
    ];

    /// Whether the method runs in Avian instead of Rapier.
    pub fn is_avian(self) -> bool {
        matches!(self, Self::Avian | Self::AvianBare)
    }

    /// Name on the command line and in the CSV files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Force => "force",
            Self::Joint => "joint",
            Self::Avian => "avian",
            Self::AvianBare => "avian-bare",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    pub fn title(self) -> &'static str {
        match self {
            Self::Ours => "bevy_coilover",
            Self::Force => "force once per step",
            Self::Joint => "Rapier SpringJoint",
            Self::Avian => "Avian distance joint",
            Self::AvianBare => "Avian, undamped",
        }
    }

    /// The dial that a user gets by default.
    pub fn default_dial(self) -> Dial {
        match self {
            Self::Ours => Dial::Microsteps(1),
            Self::Force => Dial::None,
            Self::Joint => Dial::Iterations(4),
            Self::Avian | Self::AvianBare => Dial::Substeps(6),
        }
    }

    /// All dial positions, or only a few for a quick run.
    pub fn dials(self, quick: bool) -> Vec<Dial> {
        let pick = |all: &[u32], few: &[u32]| if quick { few.to_vec() } else { all.to_vec() };
        match self {
            Self::Ours => {
                let mut dials: Vec<Dial> = pick(&[1, 2, 4, 8, 16], &[1, 4])
                    .into_iter()
                    .map(Dial::Microsteps)
                    .collect();
                dials.push(Dial::Extrapolated(1));
                dials.extend(pick(&[2, 3, 4], &[3]).into_iter().map(Dial::Tolerance));
                dials
            }
            Self::Force => vec![Dial::None],
            Self::Joint => pick(&[4, 8, 16, 32], &[4, 16])
                .into_iter()
                .map(Dial::Iterations)
                .collect(),
            Self::Avian | Self::AvianBare => pick(&[6, 12, 24, 48], &[6, 24])
                .into_iter()
                .map(Dial::Substeps)
                .collect(),
        }
    }
}

/// Position of a method's own accuracy dial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Dial {
    None,
    Microsteps(u32),
    /// Extrapolated from this number of micro-steps and twice as many.
    Extrapolated(u32),
    /// Tolerance of 10⁻ⁿ m/s.
    Tolerance(u32),
    Iterations(u32),
    Substeps(u32),
}

impl fmt::Display for Dial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "-"),
            Self::Microsteps(1) => write!(f, "default"),
            Self::Microsteps(n) => write!(f, "{n} micro-steps"),
            Self::Extrapolated(1) => write!(f, "extrapolated"),
            Self::Extrapolated(n) => write!(f, "extrapolated from {n}"),
            Self::Tolerance(n) => write!(f, "tolerance 1e-{n}"),
            Self::Iterations(n) => write!(f, "{n} iterations"),
            Self::Substeps(n) => write!(f, "{n} substeps"),
        }
    }
}

/// A method with its dial and tick rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Setting {
    pub method: Method,
    pub dial: Dial,
    /// Steps per second.
    pub rate: u32,
}

impl Setting {
    /// The method with its default dial, at `rate` steps per second.
    pub fn default_of(method: Method, rate: u32) -> Self {
        Self {
            method,
            dial: method.default_dial(),
            rate,
        }
    }

    /// Length of a step, s.
    pub fn dt(self) -> f64 {
        f64::from(self.rate).recip()
    }

    pub fn is_default(self) -> bool {
        self.dial == self.method.default_dial()
    }
}

/// Steps per second that are compared.
pub fn rates(quick: bool) -> &'static [u32] {
    if quick {
        &[60, 240]
    } else {
        &[30, 60, 120, 240, 480, 960]
    }
}
