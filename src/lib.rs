#![doc = include_str!("../README.md")]

mod diagnostics;
mod dynamics;
mod element;
mod engine;
mod plugin;
mod readout;
mod recommend;
mod settings;
#[cfg(feature = "visual")]
mod visual;

pub use diagnostics::CoiloverDiagnosticsPlugin;
pub use element::{
    Anchors, Breakable, CustomDampingLaw, CustomSpringLaw, Damper, DampingLaw, ForceLaw,
    ForceTable, MaxForce, Polynomial, Preload, Spring, SpringAction, SpringAxis, SpringBroke,
    SpringDamper, SpringFault, SpringLaw, SpringTravel, SpringTuning, TorsionDamper, TorsionSpring,
    TorsionSpringDamper, WhenBroken, wire_stiffness,
};
pub use engine::SpringLoad;
pub use plugin::{CoiloverPlugin, CoiloverSystems};
pub use readout::{SpringMethod, SpringReadout};
pub use recommend::recommend;
pub use settings::CoiloverSettings;
#[cfg(feature = "visual")]
pub use visual::{
    Coil, CoiloverVisualPlugin, CoiloverVisualSystems, Handedness, Helix, HelixEnds, HelixError,
    HelixMeshBuilder, RoundWire, RoundWireMaterial, ShowSpringGizmos, SpringGizmos, SpringSkin,
    Telescope, WoundCoil, coilover,
};

use bevy::app::{PluginGroup, PluginGroupBuilder};

/// [`CoiloverPlugin`] in `FixedUpdate`, and with the `visual` feature `CoiloverVisualPlugin`.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins(CoiloverPlugins.set(CoiloverPlugin::default().with_microsteps(4)));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverPlugins;

impl PluginGroup for CoiloverPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>().add(CoiloverPlugin::default());
        #[cfg(feature = "visual")]
        let group = group.add(CoiloverVisualPlugin);
        group
    }
}

/// Everything that a game needs.
pub mod prelude {
    pub use crate::{
        Anchors, Breakable, CoiloverDiagnosticsPlugin, CoiloverPlugin, CoiloverPlugins,
        CoiloverSettings, CoiloverSystems, CustomDampingLaw, CustomSpringLaw, Damper, DampingLaw,
        ForceLaw, ForceTable, MaxForce, Polynomial, Preload, Spring, SpringAction, SpringAxis,
        SpringBroke, SpringDamper, SpringFault, SpringLaw, SpringLoad, SpringMethod, SpringReadout,
        SpringTravel, SpringTuning, TorsionDamper, TorsionSpring, TorsionSpringDamper, WhenBroken,
        recommend,
    };
    #[cfg(feature = "visual")]
    pub use crate::{
        Coil, CoiloverVisualPlugin, CoiloverVisualSystems, Handedness, Helix, HelixEnds, RoundWire,
        RoundWireMaterial, ShowSpringGizmos, SpringGizmos, SpringSkin, Telescope, WoundCoil,
        coilover,
    };
}
