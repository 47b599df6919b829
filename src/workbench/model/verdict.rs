//! Explains the numbers of an element in sentences.

use super::facts::{EndKind, Facts, Stepping};
use super::snapshot::Snapshot;
use crate::dynamics::poles::RESOLVED_PHASE;
use crate::readout::SpringMethod;
use crate::recommend::{error_per_second, recommend};

/// Phase ω·dt per kick up to which the motion is followed closely, rad.
const CLOSE: f32 = 1.0;
/// Phase ω·dt per kick beyond which the motion is not resolved, rad.
const UNRESOLVED: f32 = RESOLVED_PHASE as f32;

/// Tolerances for which `recommend` is asked, m per s.
const TOLERANCES: [f32; 2] = [1e-3, 1e-5];

/// Severity of a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    Good,
    Plain,
    Warning,
    Bad,
}

/// A sentence with its severity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sentence {
    pub tone: Tone,
    pub text: String,
}

fn say(tone: Tone, text: impl Into<String>) -> Sentence {
    let text = text.into();
    Sentence { tone, text }
}

/// Returns all sentences about an element.
pub(crate) fn verdict(now: &Snapshot, facts: &Facts) -> Vec<Sentence> {
    if facts.is_disabled {
        let text = "It is disabled, and does not act until the component Disabled is removed.";
        return vec![say(Tone::Warning, text)];
    }
    if let Some(fault) = &facts.fault {
        return vec![say(Tone::Bad, fault)];
    }
    let mut out = vec![];
    out.extend(method(facts));
    out.extend(resolved(facts));
    out.extend(held(facts));
    if facts.readout.capped {
        out.push(say(
            Tone::Warning,
            "A cap of CoiloverSettings kept the last step from being finer: raise max_microsteps, max_iterations, \
             max_substeps or resolve.",
        ));
    }
    out.extend(damped(now, facts));
    out.extend(advice(now, facts));
    out
}

fn method(facts: &Facts) -> Option<Sentence> {
    let readout = &facts.readout;
    let steps = match readout.microsteps {
        1 => "1 kick".into(),
        n => format!("{n} kicks"),
    };
    Some(match readout.method {
        SpringMethod::None => {
            let asleep = facts.ends.iter().any(|end| end.asleep);
            let why = if asleep {
                "its bodies sleep"
            } else {
                "nothing that it holds can move, or it has not been stepped yet"
            };
            say(
                Tone::Plain,
                format!("It took no part in the last step: {why}."),
            )
        }
        SpringMethod::ClosedForm => say(
            Tone::Good,
            format!("Alone on its ends: solved in closed form, {steps} a step."),
        ),
        SpringMethod::Direct => say(
            Tone::Good,
            format!("Solved by one factorisation, {steps} a step."),
        ),
        SpringMethod::Iterative => say(
            Tone::Plain,
            format!("Solved by iteration, as its network is wide or soft: {steps} a step."),
        ),
        SpringMethod::Engine => say(
            Tone::Plain,
            format!(
                "Solved inside Rapier, in {} substeps, because contacts or joints hold an end.",
                readout.microsteps
            ),
        ),
    })
}

/// Says whether the vibration is resolved.
fn resolved(facts: &Facts) -> Option<Sentence> {
    let readout = &facts.readout;
    if readout.method == SpringMethod::None || readout.omega_dt.is_nan() || readout.omega_dt <= 0.0
    {
        return None;
    }
    let omega_dt = readout.omega_dt;
    // The phase is divided evenly among the kicks of a step.
    let each = omega_dt / readout.microsteps.max(1) as f32;
    Some(if each <= CLOSE {
        say(
            Tone::Good,
            format!("Resolved: ω·dt is {omega_dt:.2}, {each:.2} a kick."),
        )
    } else if each <= UNRESOLVED {
        say(
            Tone::Plain,
            format!(
                "Resolved coarsely: ω·dt is {omega_dt:.2}, {each:.2} a kick; up to 1 it is followed closely."
            ),
        )
    } else {
        say(
            Tone::Warning,
            format!(
                "Not resolved, only stable: ω·dt is {omega_dt:.2}, {each:.2} a kick. Use micro-steps, more mass or less \
                 stiffness."
            ),
        )
    })
}

/// Says what the ends are.
fn held(facts: &Facts) -> Option<Sentence> {
    let cannot_move = |kind| matches!(kind, EndKind::Fixed | EndKind::Kinematic | EndKind::Point);
    let word = |kind| match kind {
        EndKind::Missing => "does not exist",
        EndKind::Point => "is no body: it stands where its Transform says",
        EndKind::Fixed => "is fixed",
        EndKind::Kinematic => "is kinematic",
        EndKind::Dynamic => "moves",
    };
    let [a, b] = &facts.ends;
    let tone = if a.kind == EndKind::Missing || b.kind == EndKind::Missing {
        Tone::Bad
    } else if cannot_move(a.kind) && cannot_move(b.kind) {
        Tone::Warning
    } else {
        Tone::Plain
    };
    Some(say(
        tone,
        format!("End A {}; end B {}.", word(a.kind), word(b.kind)),
    ))
}

/// Says how fast an oscillation decays.
fn damped(now: &Snapshot, facts: &Facts) -> Option<Sentence> {
    let load = facts.load_of(now)?;
    let stiffness = now.part.stiffness().filter(|k| *k > 0.0)?;
    if !now.damper_is_linear() || facts.custom[1] {
        return None;
    }
    let ratio = load.ratio(stiffness, now.part.damping().unwrap_or(0.0));
    let what = if ratio == 0.0 {
        "it swings for ever"
    } else if ratio < 0.2 {
        "it swings for long"
    } else if ratio < 0.7 {
        "it swings a few times"
    } else if ratio < 1.0 {
        "it overshoots a little"
    } else if ratio < 1.5 {
        "it does not overshoot"
    } else {
        "it creeps back"
    };
    Some(say(
        Tone::Plain,
        format!("Damping ratio {ratio:.2}: {what}."),
    ))
}

/// Says how large the error of the steps is, and what `recommend` advises.
fn advice(now: &Snapshot, facts: &Facts) -> Vec<Sentence> {
    let mut out = vec![];
    let Some(load) = facts.load_of(now) else {
        return out;
    };
    let Stepping {
        dt,
        microsteps,
        tolerance,
    } = facts.stepping;
    if facts.readout.method == SpringMethod::Engine || now.part.is_torsion() {
        return out;
    }
    let stiffness = now.part.stiffness().unwrap_or(0.0);
    let damping = now.part.damping().unwrap_or(0.0);
    if let Some(tolerance) = tolerance {
        let text = format!(
            "A tolerance of {} a second is asked for; the last step added about {}.",
            metres(tolerance),
            metres(facts.readout.error)
        );
        out.push(say(Tone::Plain, text));
    } else {
        let error = error_per_second(stiffness, damping, load.mass, dt, microsteps);
        let text = format!(
            "With {microsteps} micro-step{} a step, swinging adds an error of about {} a second.",
            if microsteps == 1 { "" } else { "s" },
            metres(error)
        );
        out.push(say(Tone::Plain, text));
    }
    let [coarse, fine] =
        TOLERANCES.map(|tolerance| recommend(stiffness, damping, load.mass, dt, tolerance));
    let text = format!(
        "recommend: {coarse} micro-step{} for 1 mm a second, {fine} for 0.01 mm.",
        if coarse == 1 { "" } else { "s" }
    );
    let tone = if tolerance.is_none() && microsteps < coarse {
        Tone::Warning
    } else {
        Tone::Plain
    };
    out.push(say(tone, text));
    out
}

/// Formats a short length in a suitable unit.
fn metres(length: f32) -> String {
    let size = length.abs();
    if size >= 1.0 {
        format!("{length:.2} m")
    } else if size >= 1e-3 {
        format!("{:.1} mm", 1e3 * length)
    } else if size >= 1e-6 {
        format!("{:.1} µm", 1e6 * length)
    } else {
        format!("{:.1e} m", length)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::element::*;
    use crate::readout::SpringReadout;
    use crate::workbench::model::facts::End;
    use crate::workbench::model::snapshot::Part;
    use bevy::prelude::Entity;

    pub(crate) fn scene() -> (Snapshot, Facts) {
        let [a, b] = [1, 2].map(|i| Entity::from_raw_u32(i).expect("a number of an entity"));
        let pair = SpringDamper::new(a, b)
            .with_stiffness(500.0)
            .with_damping(5.0);
        let end = |kind| End {
            kind,
            ..End::default()
        };
        let facts = Facts {
            readout: SpringReadout {
                omega_dt: 0.37,
                effective_mass: 1.0,
                method: SpringMethod::ClosedForm,
                microsteps: 1,
                ..SpringReadout::default()
            },
            is_disabled: false,
            fault: None,
            ends: [end(EndKind::Fixed), end(EndKind::Dynamic)],
            gravity: 9.81,
            slope: None,
            stepping: Stepping {
                dt: 1.0 / 60.0,
                microsteps: 1,
                tolerance: None,
            },
            custom: [false; 2],
            curve: None,
        };
        (Snapshot::new(Part::SpringDamper(pair)), facts)
    }

    fn text(now: &Snapshot, facts: &Facts) -> String {
        let sentences = verdict(now, facts);
        let texts: Vec<_> = sentences.into_iter().map(|s| s.text).collect();
        texts.join("\n")
    }

    #[test]
    fn a_plain_spring_is_resolved() {
        let (now, facts) = scene();
        let text = text(&now, &facts);
        assert!(text.contains("closed form, 1 kick"), "{text}");
        assert!(text.contains("Resolved: ω·dt is 0.37"), "{text}");
        assert!(text.contains("End A is fixed; end B moves."), "{text}");
        assert!(text.contains("Damping ratio 0.11"), "{text}");
        assert!(text.contains("adds an error of about 377.8 µm"), "{text}");
        assert!(text.contains("recommend: 1 micro-step for 1 mm"), "{text}");
    }

    #[test]
    fn a_stiff_one_is_not() {
        let (now, mut facts) = scene();
        facts.readout.omega_dt = 8.0;
        facts.readout.capped = true;
        let sentences = verdict(&now, &facts);
        let warned = |part: &str| {
            sentences
                .iter()
                .any(|s| s.tone == Tone::Warning && s.text.contains(part))
        };
        assert!(warned("Not resolved, only stable: ω·dt is 8.00"));
        assert!(warned("A cap of CoiloverSettings"));
        facts.readout.microsteps = 16;
        assert!(text(&now, &facts).contains("Resolved: ω·dt is 8.00, 0.50 a kick"));
    }

    #[test]
    fn a_fault_is_all_there_is_to_say() {
        let (now, mut facts) = scene();
        facts.fault = Some("Spring::stiffness is NaN".into());
        let sentences = verdict(&now, &facts);
        assert_eq!(sentences.len(), 1);
        assert_eq!(sentences[0].tone, Tone::Bad);
    }

    #[test]
    fn that_it_is_disabled_is_all_there_is_to_say() {
        let (now, mut facts) = scene();
        facts.is_disabled = true;
        facts.fault = Some("Spring::stiffness is NaN".into());
        let sentences = verdict(&now, &facts);
        assert_eq!(sentences.len(), 1);
        assert!(sentences[0].text.contains("It is disabled"));
    }

    #[test]
    fn what_nothing_moves_is_told() {
        let (now, mut facts) = scene();
        facts.ends[1].kind = EndKind::Kinematic;
        facts.readout.method = SpringMethod::None;
        facts.readout.effective_mass = f32::INFINITY;
        let text = text(&now, &facts);
        assert!(text.contains("took no part"), "{text}");
        assert!(
            text.contains("End A is fixed; end B is kinematic."),
            "{text}"
        );
        assert!(!text.contains("recommend"), "{text}");
    }
}
