//! A server with physics, and clients that only draw, connected over UDP.

use crate::relay::Relay;
use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::state::app::StatesPlugin;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_replicon::prelude::*;
use bevy_replicon::shared::server_entity_map::ServerEntityMap;
use bevy_replicon_renet::netcode::{
    ClientAuthentication, NetcodeClientTransport, NetcodeServerTransport, ServerAuthentication,
    ServerConfig,
};
use bevy_replicon_renet::renet::ConnectionConfig;
use bevy_replicon_renet::{RenetChannelsExt, RenetClient, RenetServer, RepliconRenetPlugins};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant, SystemTime};

/// Ticks per second.
pub const RATE: u16 = 60;

/// Protocol number, which server and clients have to share.
const PROTOCOL: u64 = 21;

/// Registers the replicated components. Server and clients have to register the same ones in the same order.
pub struct SentPlugin;

impl Plugin for SentPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            StatesPlugin,
            RepliconPlugins.set(ServerPlugin::new(PostUpdate)),
            RepliconRenetPlugins,
        ))
        // Bodies and points. Drawn elements have a transform too, but nobody needs it.
        .replicate_filtered::<Transform, (Without<Coil>, Without<Telescope>, Without<TorsionCoil>)>(
        )
        // Elements. Replicon maps their ends.
        .replicate::<Spring>()
        .replicate::<Damper>()
        .replicate::<SpringDamper>()
        .replicate::<TorsionSpring>()
        .replicate::<TorsionDamper>()
        .replicate::<TorsionSpringDamper>()
        // Where and how elements are drawn.
        .replicate::<Anchors>()
        .replicate::<Coil>()
        .replicate::<Telescope>()
        .replicate::<TorsionCoil>()
        // A strip shows full turns, which do not follow from the poses of bodies.
        .replicate_filtered_as::<SpringReadout, Turned, With<TorsionCoil>>();
    }
}

/// The replicated part of a readout: the angle with full turns, rad.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Turned(f32);

impl From<SpringReadout> for Turned {
    fn from(readout: SpringReadout) -> Self {
        Self(readout.length)
    }
}

impl From<Turned> for SpringReadout {
    fn from(turned: Turned) -> Self {
        Self {
            length: turned.0,
            ..default()
        }
    }
}

/// An app that runs one tick per update.
fn bare() -> App {
    let mut app = App::new();
    let tick = Duration::from_secs_f64(1.0 / f64::from(RATE));
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        TransformPlugin,
        SentPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(tick));
    app
}

/// Adds the plugins that draw springs, without a window.
fn draw(app: &mut App) {
    app.add_plugins(AssetPlugin::default())
        .init_asset::<Mesh>()
        .init_asset::<StandardMaterial>()
        .add_plugins(CoiloverVisualPlugin);
}

fn channels(app: &App) -> ConnectionConfig {
    let channels = app.world().resource::<RepliconChannels>();
    ConnectionConfig {
        server_channels_config: channels.server_configs(),
        client_channels_config: channels.client_configs(),
        ..default()
    }
}

/// A client, which has neither Rapier nor acting springs.
pub struct Client {
    /// App of the client.
    pub app: App,
    /// Relay between the client and the server.
    pub relay: Relay,
}

/// A server and its clients.
pub struct Hosted {
    /// App of the server.
    pub server: App,
    /// Clients in the order in which they joined.
    pub clients: Vec<Client>,
    address: SocketAddr,
}

impl Hosted {
    /// Starts a server without clients, which draws nothing.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        Self::start(bare())
    }

    /// Starts a server without clients, which draws as clients do, for comparison.
    pub fn that_draws() -> Result<Self, Box<dyn Error>> {
        let mut server = bare();
        draw(&mut server);
        Self::start(server)
    }

    fn start(mut server: App) -> Result<Self, Box<dyn Error>> {
        server.add_plugins((
            CoiloverPlugin::at_hz(f64::from(RATE)),
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        ));
        server.finish();
        server.cleanup();
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
        let address = socket.local_addr()?;
        let config = ServerConfig {
            current_time: SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?,
            max_clients: 8,
            protocol_id: PROTOCOL,
            public_addresses: vec![address],
            // Anybody may join, which is for tests on one machine. A game has keys: `ServerAuthentication::Secure`.
            authentication: ServerAuthentication::Unsecure,
        };
        let transport = NetcodeServerTransport::new(config, socket)?;
        let renet = RenetServer::new(channels(&server));
        server.insert_resource(renet).insert_resource(transport);
        server.update();
        Ok(Self {
            server,
            clients: Vec::new(),
            address,
        })
    }

    /// Adds a client over a relay that loses a share `loss`. Returns once it is connected.
    pub fn join(&mut self, loss: f64) -> Result<(), Box<dyn Error>> {
        let mut app = bare();
        draw(&mut app);
        app.init_resource::<ClientReplicationStats>();
        app.finish();
        app.cleanup();
        let id = self.clients.len() as u64 + 1;
        // These entities give its scene other ids than the server's.
        for _ in 0..100 * id {
            app.world_mut().spawn_empty();
        }
        let relay = Relay::new(self.address, loss, id)?;
        let authentication = ClientAuthentication::Unsecure {
            client_id: id,
            protocol_id: PROTOCOL,
            server_addr: relay.address()?,
            user_data: None,
        };
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?;
        let transport = NetcodeClientTransport::new(now, authentication, socket)?;
        let renet = RenetClient::new(channels(&app));
        app.insert_resource(renet).insert_resource(transport);
        self.clients.push(Client { app, relay });
        let start = Instant::now();
        while self.clients.iter().any(|client| !client.is_connected()) {
            self.tick();
            if start.elapsed() > Duration::from_secs(20) {
                return Err("the client does not find the server".into());
            }
        }
        Ok(())
    }

    /// Runs a tick of the server, then of all clients.
    pub fn tick(&mut self) {
        self.server.update();
        for client in &mut self.clients {
            client.relay.pass();
            client.app.update();
            client.relay.pass();
        }
    }

    /// Runs a number of ticks.
    pub fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }
}

impl Client {
    fn is_connected(&self) -> bool {
        self.app.world().resource::<RenetClient>().is_connected()
    }

    /// The client's entity for an entity of the server.
    pub fn here(&self, there: Entity) -> Option<Entity> {
        let map = self.app.world().resource::<ServerEntityMap>();
        map.to_client().get(&there).copied()
    }

    /// The client's component of an entity of the server.
    pub fn get<C: Component>(&self, there: Entity) -> Option<&C> {
        self.app.world().get::<C>(self.here(there)?)
    }

    /// Number of drawn parts of all elements.
    pub fn drawn(&mut self) -> usize {
        let world = self.app.world_mut();
        world.query::<&Mesh3d>().iter(world).count()
    }

    /// Start and end of an element's drawn coil, in the world, m.
    pub fn coil(&self, there: Entity) -> Option<(Vec3, Vec3)> {
        let world = self.app.world();
        let parts = self.get::<Children>(there)?.iter();
        let mut coils = parts.filter(|part| world.get::<Mesh3d>(*part).is_some());
        let place = world.get::<GlobalTransform>(coils.next()?)?;
        // The mesh of a coil is one metre long.
        Some((
            place.transform_point(Vec3::ZERO),
            place.transform_point(Vec3::Y),
        ))
    }
}

/// Spawns a weight below a hook on a spring. Returns hook, weight and element.
pub fn hang(world: &mut World, at: Vec3) -> [Entity; 3] {
    let hook = (Transform::from_translation(at), Replicated);
    let hook = world.spawn(hook).id();
    let weight = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(1.0),
        Transform::from_translation(at - Vec3::new(0.2, 1.2, 0.0)),
        Replicated,
    );
    let weight = world.spawn(weight).id();
    let element = (
        SpringDamper::new(hook, weight)
            .with_stiffness(80.0)
            .with_damping(0.5)
            .with_rest_length(1.0),
        Replicated,
    );
    let element = world.spawn(element).id();
    [hook, weight, element]
}
