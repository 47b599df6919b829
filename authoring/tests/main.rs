//! Tests of springs that designers place: in scene files, over Bevy's remote protocol, with Skein, and in glTF.

mod harness;

mod blender;
mod data;
mod gltf_again;
mod gltf_companions;
mod gltf_elements;
mod gltf_export;
mod gltf_fixed;
mod gltf_joints;
mod gltf_left_out;
mod gltf_not_written;
mod gltf_out;
mod gltf_physics;
mod gltf_sample;
mod gltf_samples;
mod gltf_scenes;
mod remote;
mod saved_world;
mod skein;
mod snapshot;
mod untrusted;
