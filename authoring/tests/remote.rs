//! Tests that another program can place springs in a running game, over Bevy's remote protocol and real HTTP.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_remote::RemotePlugin;
use bevy_remote::http::RemoteHttpPlugin;
use serde_json::{Value, json};
use std::net::TcpListener;
use std::sync::mpsc;

/// A game that listens for requests, and its address.
struct Remote {
    app: App,
    address: String,
}

impl Remote {
    fn new() -> Self {
        // A port that is free now. Another program is unlikely to take it before the game does.
        let port = || {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
            listener.local_addr().expect("its address").port()
        };
        let at = port();
        let mut app = app();
        app.add_plugins((
            CoiloverPlugin::default(),
            RemotePlugin::default(),
            RemoteHttpPlugin::default().with_port(at),
        ));
        prime(&mut app);
        Self {
            app,
            address: format!("http://127.0.0.1:{at}"),
        }
    }

    /// Sends a request from another thread, as another program would, while the game keeps running. Returns the result.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        let (answer, answers) = mpsc::channel();
        let address = self.address.clone();
        let question = json!({ "jsonrpc": "2.0", "id": 1, "method": method, "params": params });
        std::thread::spawn(move || {
            let told = (0..50).find_map(|_| {
                let sent = ureq::post(&address).send(question.to_string());
                let read = |mut sent: ureq::http::Response<ureq::Body>| {
                    sent.body_mut().read_to_string().ok()
                };
                let text = sent.ok().and_then(read);
                if text.is_none() {
                    // Perhaps the server does not listen yet.
                    std::thread::sleep(std::time::Duration::from_millis(50));
                }
                text
            });
            answer.send(told).expect("the test waits");
        });
        let told = until(&mut self.app, method, |_| answers.try_recv().ok());
        let told: Value = serde_json::from_str(&told.expect("an answer")).expect("JSON");
        assert!(told.get("error").is_none(), "{told}");
        told["result"].clone()
    }
}

fn entity(of: &Value) -> Entity {
    let bits = of["entity"].as_u64().expect("an entity");
    Entity::from_bits(bits)
}

#[test]
fn a_spring_spawned_over_http_finds_its_ends_by_name() {
    let mut remote = Remote::new();
    let made = remote.ask(
        "world.spawn_entity",
        json!({ "components": {
            "bevy_coilover::SpringDamper": { "stiffness": 100.0, "damping": 2.0 },
            "bevy_coilover::EndNames": { "a": "Hook", "b": "Weight" },
            "bevy_coilover::Preload": 3.0,
        } }),
    );
    let element = entity(&made);
    run(&mut remote.app, 0.1);
    let told = remote.ask(
        "world.get_components",
        json!({ "entity": made["entity"], "components": ["bevy_coilover::SpringFault"] }),
    );
    let reason = &told["components"]["bevy_coilover::SpringFault"]["reason"];
    assert_eq!(reason, "names 'Hook', which no entity has");
    // Its ends are also spawned over HTTP.
    for (name, height, body) in [("Hook", 2.0, "Fixed"), ("Weight", 0.0, "Dynamic")] {
        remote.ask(
            "world.spawn_entity",
            json!({ "components": {
                "bevy_ecs::name::Name": name,
                "bevy_transform::components::transform::Transform": {
                    "translation": [0.0, height, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0],
                },
                "bevy_rapier3d::dynamics::rigid_body::RigidBody": body,
                "bevy_rapier3d::dynamics::rigid_body::AdditionalMassProperties": { "Mass": 1.0 },
            } }),
        );
    }
    run(&mut remote.app, 0.5);
    let (a, b) = (
        named(&mut remote.app, "Hook"),
        named(&mut remote.app, "Weight"),
    );
    let world = remote.app.world();
    let pair = world.get::<SpringDamper>(element).expect("a pair");
    assert_eq!([pair.body_a, pair.body_b], [a, b]);
    assert!(world.get::<SpringFault>(element).is_none());
    let told = remote.ask(
        "world.get_components",
        json!({ "entity": made["entity"], "components": ["bevy_coilover::SpringReadout"] }),
    );
    let force = told["components"]["bevy_coilover::SpringReadout"]["spring_force"].as_f64();
    assert!(force.is_some_and(|force| force > 3.0), "{told}");
    // New names must give new ends.
    remote.ask(
        "world.insert_components",
        json!({ "entity": made["entity"], "components": {
            "bevy_coilover::EndNames": { "a": "Weight", "b": "Hook" },
        } }),
    );
    run(&mut remote.app, 0.1);
    let pair = remote
        .app
        .world()
        .get::<SpringDamper>(element)
        .expect("a pair");
    assert_eq!([pair.body_a, pair.body_b], [b, a]);
}
