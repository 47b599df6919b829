//! Tests which elements a glTF file does not hold: those beside what is exported, and those with a fault that would be gone
//! after the file.

use crate::gltf_export::root;
use crate::gltf_left_out::assert_told;
use crate::harness::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use serde_json::{Value, json};

/// All elements of an exported file.
fn elements(text: &str) -> Vec<Value> {
    let file: Value = serde_json::from_str(text).expect("JSON");
    let nodes = file["nodes"].as_array().into_iter().flatten();
    let elements = nodes.map(|node| node["extensions"]["BEVY_coilover"].clone());
    elements.filter(|element| !element.is_null()).collect()
}

#[test]
fn what_acts_on_exported_entities_from_beside_them_is_said() {
    let mut app = game();
    let [hook, weight] = spawn_ends(&mut app);
    let world = app.world_mut();
    let root = root(world);
    let spot = world.spawn((Transform::default(), ChildOf(root))).id();
    world.entity_mut(weight).insert(ChildOf(root));
    world.spawn((Name::new("Rope"), Spring::new(weight, spot)));
    world.spawn((Name::new("Off"), Damper::new(spot, weight), Disabled));
    world.spawn((Name::new("Out"), Spring::new(weight, hook)));
    world.spawn((Name::new("Far"), Spring::new(hook, Entity::PLACEHOLDER)));
    // Springs of a mouse are not told of one by one, whether it is below the root or not.
    let mouse = MouseSpring::new(weight, Vec3::ZERO, Vec3::Y);
    world.spawn((Name::new("Mouse"), mouse));
    world.spawn((Name::new("Hand"), mouse, ChildOf(root)));
    run(&mut app, 3.0 * DT);
    let exported = export_gltf(app.world(), [root]);
    let beside = "acts on what is exported, but is below none of the roots";
    assert_told(
        &exported.left_out,
        &[
            ("Rope", beside),
            ("Off", beside),
            ("Out", beside),
            ("Mouse", beside),
            ("Hand", "MouseSpring is not written"),
        ],
    );
    assert_eq!(exported.left_out.len(), 5, "{:#?}", exported.left_out);
    assert_eq!(elements(&exported.text), Vec::<Value>::new());
}

#[test]
fn an_element_with_a_fault_that_json_cannot_hold_is_not_written() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let [a, b] = [0.0, 1.0].map(|y| {
        let end = (Transform::from_xyz(0.0, y, 0.0), ChildOf(root));
        world.spawn(end).id()
    });
    let mut spawn = |name: &str, beside: &mut dyn FnMut(&mut EntityWorldMut)| {
        beside(&mut world.spawn((Name::new(name.to_owned()), ChildOf(root))));
    };
    let spring = Spring::new(a, b);
    let [nan, inf] = [f32::NAN, f32::INFINITY];
    spawn("stiffness", &mut |e| {
        e.insert(spring.with_stiffness(inf));
    });
    spawn("restLength", &mut |e| {
        e.insert(spring.with_rest_length(nan));
    });
    spawn("damping", &mut |e| {
        e.insert(Damper::new(a, b).with_damping(nan));
    });
    spawn("axis", &mut |e| {
        e.insert(TorsionSpring::new(a, b, Vec3::splat(nan)));
    });
    spawn("anchors", &mut |e| {
        e.insert((spring, Anchors::new(Vec3::Y * inf, Vec3::ZERO)));
    });
    spawn("preload", &mut |e| {
        e.insert((spring, Preload(inf)));
    });
    spawn("maxForce", &mut |e| {
        e.insert((spring, MaxForce(nan)));
    });
    spawn("stopStiffness", &mut |e| {
        e.insert((spring, SpringTravel::new(0.0, inf, inf)));
    });
    spawn("minLength", &mut |e| {
        e.insert((spring, SpringTravel::new(-inf, inf, 1.0)));
    });
    spawn("force", &mut |e| {
        e.insert((spring, Breakable::at_force(nan)));
    });
    spawn("springLaw", &mut |e| {
        let table = ForceTable::new([(0.0, 0.0), (1.0, nan)]);
        e.insert((spring, SpringLaw::Table(table)));
    });
    spawn("several elements", &mut |e| {
        e.insert((spring, Damper::new(a, b)));
    });
    spawn("Endless", &mut |e| {
        let travel = SpringTravel::new(-inf, inf, 1.0);
        let breakable = Breakable::at_length(inf);
        let axis = SpringAxis::World(Vec3::Y);
        e.insert((spring, travel, breakable, axis, MaxForce(inf)));
    });
    // The element acts without its looks.
    spawn("radius", &mut |e| {
        e.insert((spring, Coil::new(nan, 0.01, 8.0)));
    });
    let exported = export_gltf(world, [root]);
    let told = &exported.left_out;
    assert_eq!(told.len(), 13, "{told:#?}");
    for line in told {
        let (name, rest) = line.split_once(" (").expect("the name of an entity");
        assert!(rest.contains(name) && rest.contains("writ"), "{line}");
    }
    let written = elements(&exported.text);
    assert_eq!(written.len(), 2, "{written:#?}");
    assert_eq!(
        written[0]["springTravel"],
        json!({ "stopStiffness": 1.0, "progression": 0.0, "stopDamping": 0.0 })
    );
    assert_eq!(written[0]["breakable"], json!({ "then": "Despawn" }));
    assert!(written.iter().all(|element| element.get("coil").is_none()));
}
