//! Measures the bytes of springs on the wire when a server sends them with Replicon.
//!
//! Run `cargo run -p netcode --features server --example wire`.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_replicon::prelude::*;
use netcode::relay::Passed;
use netcode::server::{Hosted, RATE};
use std::error::Error;

/// Number of elements that are spawned at once.
const MANY: usize = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut wire = Wire::new()?;
    println!(
        "bytes for each of {MANY}: in Replicon's messages, and on the wire without the 28 of UDP and IP a packet"
    );
    let mut points = Vec::new();
    wire.tell("a Transform, spawned", |world| {
        let at = |i: usize| Transform::from_xyz(i as f32, 1.5, -2.5);
        let spawn = |i| world.spawn((at(i), Replicated)).id();
        points = (0..=MANY).map(spawn).collect();
    });
    let mut elements = Vec::new();
    wire.tell("a SpringDamper, spawned", |world| {
        let spawn = |ends: &[Entity]| world.spawn((spring(ends), Replicated)).id();
        elements = points.windows(2).map(spawn).collect();
    });
    wire.tell("its Anchors, added", |world| {
        let anchors = Anchors::default();
        each(world, &elements, |element| _ = element.insert(anchors));
    });
    wire.tell("its Coil, added", |world| {
        let coil = Coil::default();
        each(world, &elements, |element| _ = element.insert(coil));
    });
    wire.tell("its Telescope, added", |world| {
        let telescope = Telescope::default();
        each(world, &elements, |element| _ = element.insert(telescope));
    });
    wire.tell("a number of its changed once", |world| {
        each(world, &elements, |element| {
            if let Some(mut spring) = element.get_mut::<SpringDamper>() {
                spring.stiffness += 1.0;
            }
        });
    });
    wire.tell("all of it despawned", |world| {
        elements.iter().for_each(|e| _ = world.despawn(*e));
    });
    wire.tell("SpringDamper, Anchors and Coil, spawned at once", |world| {
        for ends in points.windows(2) {
            let looks = (Anchors::default(), Coil::default());
            world.spawn((spring(ends), looks, Replicated));
        }
    });
    let wound: Vec<_> = {
        let world = wire.hosted.server.world_mut();
        let wind = |ends: &[Entity]| {
            let torsion = TorsionSpring::new(ends[0], ends[1], Vec3::X);
            let torsion = (torsion, TorsionCoil::default(), Replicated);
            world.spawn(torsion).id()
        };
        points.windows(2).map(wind).collect()
    };
    wire.hosted.run(u32::from(RATE));
    wire.tell("the turns of a TorsionCoil, in one tick", |world| {
        each(world, &wound, |element| {
            if let Some(mut readout) = element.get_mut::<SpringReadout>() {
                readout.length += 1.0;
            }
        });
    });
    wire.tell("a Transform, moved in one tick", |world| {
        each(world, &points, |point| {
            if let Some(mut place) = point.get_mut::<Transform>() {
                place.translation.y += 1.0;
            }
        });
    });
    println!("and {} a second for the connection", wire.idle.wire);
    Ok(())
}

fn spring(ends: &[Entity]) -> SpringDamper {
    SpringDamper::new(ends[0], ends[1])
        .with_stiffness(80.0)
        .with_rest_length(1.0)
}

fn each(world: &mut World, all: &[Entity], mut deed: impl FnMut(&mut EntityWorldMut)) {
    for entity in all {
        if let Ok(mut entity) = world.get_entity_mut(*entity) {
            deed(&mut entity);
        }
    }
}

/// A server with a client, and the traffic between them.
struct Wire {
    hosted: Hosted,
    /// Bytes to the client in a second without changes.
    idle: Bytes,
}

#[derive(Clone, Copy, Default)]
struct Bytes {
    messages: f64,
    wire: f64,
}

impl Wire {
    fn new() -> Result<Self, Box<dyn Error>> {
        let mut hosted = Hosted::new()?;
        hosted.join(0.0)?;
        hosted.run(u32::from(RATE));
        let mut wire = Self {
            hosted,
            idle: Bytes::default(),
        };
        wire.idle = wire.during(|_| {});
        Ok(wire)
    }

    /// Bytes to the client in the second after a change, less those of an idle second.
    fn during(&mut self, deed: impl FnOnce(&mut World)) -> Bytes {
        let before = self.seen();
        deed(self.hosted.server.world_mut());
        self.hosted.run(u32::from(RATE));
        let after = self.seen();
        Bytes {
            messages: (after.0 - before.0) as f64 - self.idle.messages,
            wire: (after.1.bytes - before.1.bytes) as f64 - self.idle.wire,
        }
    }

    fn seen(&self) -> (usize, Passed) {
        let client = &self.hosted.clients[0];
        let stats = client.app.world().resource::<ClientReplicationStats>();
        (stats.bytes, client.relay.down)
    }

    fn tell(&mut self, what: &str, deed: impl FnOnce(&mut World)) {
        let bytes = self.during(deed);
        let many = MANY as f64;
        let (messages, wire) = (bytes.messages / many, bytes.wire / many);
        println!("{what:>48}: {messages:5.1} and {wire:5.1}");
    }
}
