//! Decides how many micro-steps a motion needs.

use super::line::Motion;
use super::thresholds::RESOLVED;
use super::tolerance::Least;

/// (ω h)² at which the micro-steps of a network follow its stiffest mode accurately. Frequencies are then right to a few
/// parts in a million. The energy oscillates so little that the oscillation does not count as an energy gain. Pinned by
/// `stiff_by_default`.
const FOLLOWED: f64 = 0.1;

/// Greatest number of micro-steps that a network of any size takes to resolve a stiff mode, whatever the settings ask for.
/// Pinned by `networks::chain_of_ten_and_lattice_of_six_follow_the_reference`.
const EXTRA_STEPS: u32 = 4;

/// Number of kicks of elements per step that a network may take to follow a mode that it resolves already. Few, because the
/// error is small then. Pinned by `dynamics::undamped::the_solver_alone_keeps_the_energy_of_a_box_on_four_springs`.
const FEW_KICKS: usize = 16;

/// Greatest number of micro-steps that resolve a lone element, whatever the settings ask for. It is enough for ω·dt = 64,
/// and takes a microsecond. Pinned by `stiff_by_default::a_lone_spring_keeps_its_phase_at_any_stiffness`; more only cost time.
const MOST_ALONE: u32 = 32;

/// Least number of micro-steps of a lone element without a damper on a body that turns. A step is exact only along the line, and
/// nothing removes the energy error that each step leaves: where the motion is chaotic, it wanders by up to 2 % in an hour with one
/// micro-step. Pinned by `dynamics::undamped::the_energy_of_a_dumbbell_that_tumbles_chaotically_wanders_little`.
const UNDAMPED_TURNING: u32 = 2;

/// Distance up to which kinks of a law are looked for, as a multiple of the change of length in a step. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const AHEAD: f64 = 1.25;

/// Micro-steps that resolve a lone element with (ω h)² = `z` over the whole step; one if they are more than
/// [`MOST_ALONE`]. They are so few that they do not come out of the budget of the networks, `most`, but a budget of 0
/// allows one. Resolved micro-steps are exact along the line. `undamped_turning` says that the element has no damper, and turns a body.
pub(super) fn lone_steps(z: f64, most: u32, undamped_turning: bool) -> Least {
    let [least, most] = match (most, undamped_turning) {
        (0, _) => [1, 1],
        (_, false) => [1, MOST_ALONE],
        (_, true) => [UNDAMPED_TURNING, MOST_ALONE],
    };
    let count = within((z / RESOLVED).sqrt(), most).map_or(1, |count| count.max(least));
    Least::of(z, count)
}

/// Micro-steps of a network whose stiffest mode has (ω h)² = `z` over the whole step. Returns those that follow the mode,
/// if they are at most `most` or few. Otherwise returns those that just resolve it, if they are at most [`EXTRA_STEPS`],
/// or else one.
pub(super) fn network_steps(z: f64, elements: usize, most: u32) -> Least {
    // Each network may take these few, however many elements share the budget. A budget of 0 allows one.
    let few = if most == 0 {
        1
    } else {
        (FEW_KICKS / elements.max(1)) as u32
    };
    let most = if z <= RESOLVED { few } else { most.max(few) };
    let count = within((z / FOLLOWED).sqrt(), most)
        .or_else(|| within((z / RESOLVED).sqrt(), EXTRA_STEPS))
        .unwrap_or(1);
    Least::of(z, count)
}

impl Least {
    /// `count` micro-steps for a motion with (ω h)² = `z` over the whole step.
    fn of(z: f64, count: u32) -> Self {
        Self {
            count,
            suffice: z <= RESOLVED * f64::from(count).powi(2),
        }
    }

    /// (ω h)² over one of the micro-steps, where `z` is that over the whole step.
    pub(super) fn in_each(self, z: f64) -> f64 {
        z / f64::from(self.count).powi(2)
    }
}

fn within(steps: f64, most: u32) -> Option<u32> {
    (steps <= f64::from(most)).then(|| steps.ceil().max(1.0) as u32)
}

/// Two predicted changes of length over a step, m: at the speed in the middle of the step and at the speed at its end,
/// both under the external forces.
pub(super) fn predicted_travel(motion: &Motion, time: f64) -> [f64; 2] {
    [0.5, 1.0].map(|share| AHEAD * time * (motion.axial + share * time * motion.pushed))
}
