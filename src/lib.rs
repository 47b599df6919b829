// The guide pages link to each other as files. `on_docs_rs.md` defines the same links as links to modules. The first
// definition of a Markdown link counts, so `on_docs_rs.md` comes first.
#![doc = include_str!("../docs/guide/on_docs_rs.md")]
#![doc = include_str!("../README.md")]
#![cfg_attr(docsrs, feature(doc_cfg))]

/// Everything that differs between versions of Bevy. Each folder with a manifest has its own `src/compat.rs`.
mod compat {
    include!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/compat.rs"));
}
mod backend;
mod diagnostics;
mod dynamics;
mod element;
mod functions;
#[cfg(feature = "gltf")]
mod gltf;
mod input;
mod mouse_spring;
mod plugin;
mod readout;
mod recommend;
mod scene;
mod settings;
mod snapshot;
mod threads;
#[cfg(feature = "visual")]
mod visual;
#[cfg(feature = "workbench")]
mod workbench;

pub use backend::rapier::forces::SpringLoad;
pub use diagnostics::CoiloverDiagnosticsPlugin;
pub use element::{
    Anchors, Breakable, CustomDampingLaw, CustomSpringLaw, Damper, DampingLaw, EndNames, ForceLaw,
    ForceTable, HeldEnd, HoldPose, MaxForce, Polynomial, Preload, Spring, SpringAction, SpringAxis,
    SpringBroke, SpringDamper, SpringFault, SpringLaw, SpringTravel, SpringTuning, TorsionDamper,
    TorsionSpring, TorsionSpringDamper, WhenBroken, WorldAnchors, wire_stiffness,
};
#[cfg(feature = "gltf")]
pub use gltf::{CoiloverGltfPlugin, ExportedGltf, export_gltf};
pub use mouse_spring::MouseSpring;
pub use plugin::{CoiloverPlugin, CoiloverSystems};
pub use readout::{SpringMethod, SpringReadout};
pub use recommend::recommend;
pub use settings::CoiloverSettings;
pub use snapshot::{CoiloverSnapshot, RapierSnapshot, SnapshotError};
#[cfg(feature = "visual")]
pub use visual::{
    Coil, Coilover, CoiloverVisualPlugin, CoiloverVisualSystems, Handedness, Helix, HelixEnds,
    HelixError, HelixMeshBuilder, RoundWire, RoundWireMaterial, ShowSpringGizmos, SpringGizmos,
    SpringSkin, Telescope, TorsionCoil, WoundCoil, coilover,
};
#[cfg(feature = "workbench")]
pub use workbench::{CoiloverWorkbench, CoiloverWorkbenchPlugin};

use bevy::app::{PluginGroup, PluginGroupBuilder};

/// Plugin group: [`CoiloverPlugin`] in `FixedUpdate`, with the feature `visual` also `CoiloverVisualPlugin`, and with
/// the feature `gltf` also `CoiloverGltfPlugin`.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins(CoiloverPlugins.set(CoiloverPlugin::default().with_microsteps(4)));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverPlugins;

impl CoiloverPlugins {
    /// Returns the group with [`CoiloverPlugin::at_hz`]: physics and `FixedUpdate` both run at `hertz` ticks per
    /// second.
    ///
    /// ```no_run
    /// # use bevy::prelude::*;
    /// # use bevy_coilover::prelude::*;
    /// # use bevy_rapier3d::prelude::*;
    /// App::new()
    ///     .add_plugins((DefaultPlugins, CoiloverPlugins::at_hz(60.0)))
    ///     .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule())
    ///     .run();
    /// ```
    pub fn at_hz(hertz: f64) -> PluginGroupBuilder {
        Self.set(CoiloverPlugin::at_hz(hertz))
    }
}

impl PluginGroup for CoiloverPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>().add(CoiloverPlugin::default());
        #[cfg(feature = "visual")]
        let group = group.add(CoiloverVisualPlugin);
        #[cfg(feature = "gltf")]
        let group = group.add(CoiloverGltfPlugin);
        group
    }
}

#[doc = include_str!("../docs/guide/on_docs_rs.md")]
#[doc = include_str!("../docs/guide/README.md")]
pub mod guide {
    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/how_it_works.md")]
    pub mod how_it_works {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/first_spring.md")]
    pub mod first_spring {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/stiffness_and_damping.md")]
    pub mod stiffness_and_damping {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/blender.md")]
    pub mod blender {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/car.md")]
    pub mod car {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/ropes.md")]
    pub mod ropes {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/cloth.md")]
    pub mod cloth {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/torsion.md")]
    pub mod torsion {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/breaking_and_stops.md")]
    pub mod breaking_and_stops {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/actuators.md")]
    pub mod actuators {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/custom_forces.md")]
    pub mod custom_forces {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/looks.md")]
    pub mod looks {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/scenes.md")]
    pub mod scenes {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/gltf.md")]
    pub mod gltf {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/accuracy.md")]
    pub mod accuracy {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/performance.md")]
    pub mod performance {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/multiplayer.md")]
    pub mod multiplayer {}

    // The code of this page needs networking crates, which are no dependencies here. The folder `netcode/` compiles it.
    #[cfg(not(doctest))]
    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/netcode.md")]
    pub mod netcode {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/workbench.md")]
    pub mod workbench {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/troubleshooting.md")]
    pub mod troubleshooting {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/guide/coming_from.md")]
    pub mod coming_from {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/accuracy.md")]
    pub mod measured {}

    #[doc = include_str!("../docs/guide/on_docs_rs.md")]
    #[doc = include_str!("../docs/limits.md")]
    pub mod limits {}
}

/// All types and functions that a game needs.
pub mod prelude {
    pub use crate::{
        Anchors, Breakable, CoiloverDiagnosticsPlugin, CoiloverPlugin, CoiloverPlugins,
        CoiloverSettings, CoiloverSnapshot, CoiloverSystems, CustomDampingLaw, CustomSpringLaw,
        Damper, DampingLaw, EndNames, ForceLaw, ForceTable, HeldEnd, HoldPose, MaxForce,
        MouseSpring, Polynomial, Preload, RapierSnapshot, SnapshotError, Spring, SpringAction,
        SpringAxis, SpringBroke, SpringDamper, SpringFault, SpringLaw, SpringLoad, SpringMethod,
        SpringReadout, SpringTravel, SpringTuning, TorsionDamper, TorsionSpring,
        TorsionSpringDamper, WhenBroken, WorldAnchors, recommend, wire_stiffness,
    };
    #[cfg(feature = "visual")]
    pub use crate::{
        Coil, Coilover, CoiloverVisualPlugin, CoiloverVisualSystems, Handedness, Helix, HelixEnds,
        HelixError, HelixMeshBuilder, RoundWire, RoundWireMaterial, ShowSpringGizmos, SpringGizmos,
        SpringSkin, Telescope, TorsionCoil, WoundCoil, coilover,
    };
    #[cfg(feature = "gltf")]
    pub use crate::{CoiloverGltfPlugin, ExportedGltf, export_gltf};
    #[cfg(feature = "workbench")]
    pub use crate::{CoiloverWorkbench, CoiloverWorkbenchPlugin};
}
