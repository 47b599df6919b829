//! The workbench: a panel over a running game that shows, plots and edits its springs.
//!
//! - [`model`] is plain data: the numbers of an element, edits, the record, and figures derived from them.
//! - [`bench`] holds this data between frames. [`view`] draws it with egui and does not access the world.
//! - [`gather`] reads the world and [`apply`] changes it. [`commands`] carries out requests of the view, with
//!   [`clipboard`].
//! - In the scene, [`scene`] draws and picks, [`handles`] moves anchors, and [`grab`] pulls bodies. [`pointer`] is
//!   the mouse.

mod apply;
mod bench;
mod clipboard;
mod commands;
mod gather;
mod grab;
mod handles;
mod model;
mod pointer;
mod scene;
#[cfg(test)]
mod tests;
mod view;

use crate::plugin::CoiloverSystems;
use crate::settings::CoiloverSettings;
use bench::Bench;
use bevy::input::InputSystems;
use bevy::prelude::*;
use bevy_egui::{
    EguiGlobalSettings, EguiPlugin, EguiPostUpdateSet, EguiPreUpdateSet, EguiPrimaryContextPass,
};
use std::path::PathBuf;

/// Adds the workbench: F9 opens and closes it. See [`CoiloverWorkbench`] for its settings.
///
/// It needs [`CoiloverPlugin`](crate::CoiloverPlugin), a window and a camera. If the app adds an `EguiPlugin` itself,
/// add that first. While the workbench is closed, only the system that watches the key runs.
///
/// The panel is on the camera with `bevy_egui`'s `PrimaryEguiContext`: the first camera of the app. If that camera is despawned,
/// the panel goes to another one that draws into the primary window.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # let mut app = App::new();
/// app.add_plugins((DefaultPlugins, CoiloverPlugins, CoiloverWorkbenchPlugin));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverWorkbenchPlugin;

/// Settings and state of the workbench.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct CoiloverWorkbench {
    /// Whether the workbench is shown.
    pub open: bool,
    /// Key that opens and closes the workbench; `None` for no key.
    pub key: Option<KeyCode>,
    /// Key that is held while the mouse pulls bodies in the scene; `None` for no pulling.
    pub grab: Option<KeyCode>,
    /// Element that is shown.
    pub selected: Option<Entity>,
    /// Folder for presets, tables and pictures. It is created when the first file is saved.
    pub folder: PathBuf,
}

impl Default for CoiloverWorkbench {
    fn default() -> Self {
        Self {
            open: false,
            key: Some(KeyCode::F9),
            grab: Some(KeyCode::ShiftLeft),
            selected: None,
            folder: "workbench".into(),
        }
    }
}

impl Plugin for CoiloverWorkbenchPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
            // Keys that are typed into a field must not reach the game behind it, nor a mouse that drags out of a panel.
            if let Some(mut settings) = app.world_mut().get_resource_mut::<EguiGlobalSettings>() {
                settings.enable_absorb_bevy_input_system = true;
            }
        }
        app.init_resource::<CoiloverWorkbench>()
            .init_resource::<Bench>()
            .init_resource::<handles::Handles>()
            .init_resource::<pointer::Free>()
            .init_resource::<grab::Hand>()
            .add_systems(
                PreUpdate,
                toggle
                    .after(InputSystems)
                    .before(EguiPreUpdateSet::ProcessInput),
            )
            .add_systems(
                PreUpdate,
                scene::find_camera
                    .run_if(is_open)
                    .before(EguiPreUpdateSet::InitContexts),
            )
            .add_systems(
                PreUpdate,
                pointer::absorb
                    .run_if(is_open)
                    .after(EguiPreUpdateSet::ProcessInput),
            )
            .add_systems(
                Update,
                (
                    (scene::pick, handles::drag).chain().run_if(is_open),
                    // Also runs once after the workbench was closed, to let go.
                    grab::grab.run_if(is_open.or_else(grab::holds)),
                ),
            )
            .add_systems(
                PostUpdate,
                gather::gather
                    .run_if(is_open)
                    .after(TransformSystems::Propagate)
                    .before(EguiPostUpdateSet::EndPass),
            )
            .add_systems(EguiPrimaryContextPass, scene::show.run_if(is_open))
            .add_systems(Last, commands::obey.run_if(is_open));
        scene::add_gizmos(app);
    }

    fn finish(&self, app: &mut App) {
        let Some(settings) = app.world().get_resource::<CoiloverSettings>() else {
            log::error!(
                "bevy_coilover: CoiloverWorkbenchPlugin needs CoiloverPlugin; add CoiloverPlugins"
            );
            return;
        };
        let schedule = settings.schedule;
        app.add_systems(
            schedule,
            (
                // Edits wait for a tick, so that the engine notices removed components. Edits made just before the
                // workbench was closed are applied too.
                apply::apply
                    .run_if(apply::has_edits)
                    .before(CoiloverSystems::Prepare)
                    .before(bevy_rapier3d::prelude::PhysicsSet::SyncBackend),
                grab::pull
                    .run_if(grab::holds)
                    .before(CoiloverSystems::Prepare)
                    .before(bevy_rapier3d::prelude::PhysicsSet::SyncBackend),
                gather::record
                    .run_if(is_open)
                    .after(CoiloverSystems::Readout),
            ),
        );
    }
}

fn is_open(workbench: Res<CoiloverWorkbench>) -> bool {
    workbench.open
}

fn toggle(keys: Res<ButtonInput<KeyCode>>, mut workbench: ResMut<CoiloverWorkbench>) {
    if workbench.key.is_some_and(|key| keys.just_pressed(key)) {
        workbench.open = !workbench.open;
    }
}
