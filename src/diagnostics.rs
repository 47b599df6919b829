//! Sums over the springs of the scene, for an overlay or a log.

use crate::plugin::CoiloverSystems;
use crate::readout::{SpringMethod, SpringReadout};
use crate::settings::CoiloverSettings;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

/// Publishes sums over all elements as Bevy diagnostics, once a tick. Add it beside
/// [`CoiloverPlugin`](crate::CoiloverPlugin); without that it logs an error and does nothing. Bevy's
/// `LogDiagnosticsPlugin` prints the sums.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverDiagnosticsPlugin;

impl CoiloverDiagnosticsPlugin {
    /// Energy stored in all springs, J.
    pub const STORED_ENERGY: DiagnosticPath = DiagnosticPath::const_new("coilover/stored_energy");
    /// Power that all dampers turn into heat, W.
    pub const DISSIPATED_POWER: DiagnosticPath =
        DiagnosticPath::const_new("coilover/dissipated_power");
    /// Energy that the present elements have turned into heat so far, J.
    pub const DISSIPATED_ENERGY: DiagnosticPath =
        DiagnosticPath::const_new("coilover/dissipated_energy");
    /// Work done so far on the present elements, by changed parameters and moved ends, J.
    pub const WORK: DiagnosticPath = DiagnosticPath::const_new("coilover/work");
    /// Largest phase per step ([`SpringReadout::omega_dt`]), rad.
    pub const WORST_OMEGA_DT: DiagnosticPath = DiagnosticPath::const_new("coilover/worst_omega_dt");
    /// Number of elements that were solved alone in closed form.
    pub const CLOSED_FORM: DiagnosticPath = DiagnosticPath::const_new("coilover/closed_form");
    /// Number of elements in networks that were solved by factorisation.
    pub const DIRECT: DiagnosticPath = DiagnosticPath::const_new("coilover/direct");
    /// Number of elements in networks that were solved by iteration.
    pub const ITERATIVE: DiagnosticPath = DiagnosticPath::const_new("coilover/iterative");
    /// Number of elements that the engine solved, because contacts or joints hold their bodies.
    pub const ENGINE: DiagnosticPath = DiagnosticPath::const_new("coilover/engine");
    /// Number of elements that were not solved: at fault, or without a body that can move. A sleeping element counts
    /// under the method of its last step.
    pub const RESTING: DiagnosticPath = DiagnosticPath::const_new("coilover/resting");
}

impl Plugin for CoiloverDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for (path, unit) in [
            (Self::STORED_ENERGY, " J"),
            (Self::DISSIPATED_POWER, " W"),
            (Self::DISSIPATED_ENERGY, " J"),
            (Self::WORK, " J"),
            (Self::WORST_OMEGA_DT, " rad"),
            (Self::CLOSED_FORM, ""),
            (Self::DIRECT, ""),
            (Self::ITERATIVE, ""),
            (Self::ENGINE, ""),
            (Self::RESTING, ""),
        ] {
            app.register_diagnostic(Diagnostic::new(path).with_suffix(unit));
        }
    }

    fn finish(&self, app: &mut App) {
        let Some(settings) = app.world().get_resource::<CoiloverSettings>() else {
            log::error!(
                "bevy_coilover: CoiloverDiagnosticsPlugin needs CoiloverPlugin; add CoiloverPlugin::default()"
            );
            return;
        };
        let schedule = settings.schedule;
        app.add_systems(schedule, sum.after(CoiloverSystems::Readout));
    }
}

fn sum(readouts: Query<&SpringReadout>, mut diagnostics: Diagnostics) {
    let mut sums = [0.0; 5];
    let mut methods = [0.0; 5];
    for readout in &readouts {
        sums[0] += f64::from(readout.stored_energy);
        sums[1] += f64::from(readout.dissipated_power);
        sums[2] += f64::from(readout.dissipated_energy);
        sums[3] += f64::from(readout.work);
        sums[4] = f64::from(readout.omega_dt).max(sums[4]);
        methods[match readout.method {
            SpringMethod::ClosedForm => 0,
            SpringMethod::Direct => 1,
            SpringMethod::Iterative => 2,
            SpringMethod::Engine => 3,
            SpringMethod::None => 4,
        }] += 1.0;
    }
    use CoiloverDiagnosticsPlugin as P;
    for (path, value) in [
        (&P::STORED_ENERGY, sums[0]),
        (&P::DISSIPATED_POWER, sums[1]),
        (&P::DISSIPATED_ENERGY, sums[2]),
        (&P::WORK, sums[3]),
        (&P::WORST_OMEGA_DT, sums[4]),
        (&P::CLOSED_FORM, methods[0]),
        (&P::DIRECT, methods[1]),
        (&P::ITERATIVE, methods[2]),
        (&P::ENGINE, methods[3]),
        (&P::RESTING, methods[4]),
    ] {
        diagnostics.add_measurement(path, || value);
    }
}
