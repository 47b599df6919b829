//! Ropes, buffers and elements with nothing but stops, whose bodies touch the ground or carry a load.

use super::stand::*;
use crate::dice::in_turn;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Force law of the links of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Link {
    /// Pulls when longer than its rest length, never pushes.
    Rope,
    /// Pushes when shorter than its rest length, never pulls.
    Buffer,
    /// Pulls only, by a law with separate coefficients for pull and push.
    Sided,
    /// Pulls only, by a table.
    Table,
    /// Pulls and pushes.
    Both,
    /// Has only stops, at 0.9 and 1.1 of its rest length.
    Loose,
}

impl Link {
    const ALL: [Self; 6] = [
        Self::Rope,
        Self::Sided,
        Self::Table,
        Self::Both,
        Self::Buffer,
        Self::Loose,
    ];

    /// Energy of a link at a given stretch in m, J. For a table this is `says`, the energy that the element reports.
    fn stored(self, stiffness: f32, rest_length: f64, stretch: f64, says: f32) -> f64 {
        let within = match self {
            Self::Rope | Self::Sided => stretch.max(0.0),
            Self::Buffer => stretch.min(0.0),
            Self::Table => return f64::from(says),
            Self::Both => stretch,
            Self::Loose => (stretch.abs() - 0.1 * rest_length).max(0.0),
        };
        0.5 * f64::from(stiffness) * within * within
    }
}

struct Chain {
    scene: Stand,
    link: Link,
    elements: Vec<Entity>,
}

/// A level row of balls, 2 m long and 1 kg in all, from a hook 1.5 m above the ground. If the chain hung, its weight
/// would stretch the top link by 1 / `firmness` of its length.
fn chain(plugin: CoiloverPlugin, link: Link, links: usize, firmness: f32) -> Chain {
    let mut scene = Stand::new(plugin, Engine::default());
    scene.ground();
    let pitch = 2.0 / links as f32;
    let each = 1.0 / links as f32;
    let stiffness = firmness * GRAVITY as f32 / pitch;
    let damping = 0.2 * (stiffness * each).sqrt();
    let mut last = scene.lab.point(Vec3::Y * 1.5);
    let mut elements = Vec::new();
    for i in 1..=links {
        let at = Vec3::new(pitch * i as f32, 1.5, 0.0);
        let ball = (
            Collider::ball(0.02),
            ColliderMassProperties::Mass(each),
            LockedAxes::ROTATION_LOCKED,
        );
        let next = scene.body(Transform::from_translation(at), ball);
        let law = match link {
            Link::Loose => [0.0, 0.0],
            _ => [stiffness, damping],
        };
        let element = scene.coil([last, next], [Vec3::ZERO; 2], law, Some(pitch));
        elements.push(element);
        let mut element = scene.lab.app.world_mut().entity_mut(element);
        match link {
            Link::Rope => element.insert(SpringAction::Pull),
            Link::Buffer => element.insert(SpringAction::Push),
            Link::Sided => {
                let [pull, push] = [stiffness, 0.0].map(|linear| Polynomial::new(linear, 0.0, 0.0));
                element.insert(SpringLaw::sided(pull, push))
            }
            Link::Table => element.insert(SpringLaw::table([
                (-pitch, 0.0),
                (0.0, 0.0),
                (pitch, stiffness * pitch),
            ])),
            Link::Both => &mut element,
            Link::Loose => element.insert(
                SpringTravel::new(0.9 * pitch, 1.1 * pitch, stiffness).with_stop_damping(damping),
            ),
        };
        if let Some(coil) = scene.coils.last_mut() {
            coil.stiffness = stiffness;
        }
        last = next;
    }
    Chain {
        scene,
        link,
        elements,
    }
}

impl Chain {
    fn stored(&self) -> f64 {
        let of = |(coil, element): (&SceneSpring, &Entity)| {
            let rest = f64::from(coil.rest_length);
            let stretch = self.scene.length(coil) - rest;
            let says = self.scene.lab.readout(*element).stored_energy;
            self.link.stored(coil.stiffness, rest, stretch, says)
        };
        self.scene.coils.iter().zip(&self.elements).map(of).sum()
    }

    /// Kinetic energy, energy of height and energy stored in the links, J.
    fn energy(&self) -> f64 {
        self.scene.energy() - self.scene.stored() + self.stored()
    }

    fn damp(&mut self, damping: f32) {
        let world = self.scene.lab.app.world_mut();
        for element in &self.elements {
            if let Some(mut coil) = world.get_mut::<SpringDamper>(*element) {
                coil.damping = damping;
            }
        }
    }

    fn fastest(&self) -> f32 {
        let of = |body: &Entity| self.scene.lab.velocity(*body).length();
        self.scene.bodies.iter().map(of).fold(0.0, f32::max)
    }
}

#[test]
fn a_rope_that_falls_on_the_ground_wins_nothing() {
    let mut cases = Vec::new();
    for link in Link::ALL {
        for way in ways().into_iter().step_by(2) {
            cases.push((link, way));
        }
    }
    for (link, (name, way)) in in_turn(cases) {
        let mut line = String::new();
        // ω·dt of two neighbouring balls: 5, 15, 52.
        for (links, firmness) in [(10, 100.0), (30, 100.0), (10, 1e4)] {
            let mut chain = chain(way, link, links, firmness);
            chain.scene.lab.tick();
            let first = chain.energy();
            let (mut most, mut fastest) = (f64::MIN, 0.0_f32);
            for _ in 0..chain.scene.lab.ticks(6.0) {
                chain.scene.lab.tick();
                most = most.max(chain.energy() / first);
                fastest = fastest.max(chain.fastest());
            }
            let last = chain.fastest();
            line += &format!("  {links}: {most:.4}, {fastest:.1}→{last:.2} m/s");
            assert!(most < 1.002, "{name}, {link:?}, {links}: E × {most}");
        }
        println!("{link:?}, {name} micro-steps: E ×{line}");
    }
}

/// Links of ω·dt 5·10³ and 5·10⁴, and nearly rigid dampers. A second motor shifts the range of a one-sided link. Unless
/// such a link is softened, the difference of the two motors is lost in the engine's f32.
#[test]
fn a_rope_that_is_all_but_rigid_falls_as_a_chain_does() {
    let firm = [
        (1e8, None),
        (1e10, None),
        (1e2, Some(1e3)),
        (1e2, Some(1e5)),
        (1e2, Some(1e11)),
    ];
    let ropes = Link::ALL
        .into_iter()
        .flat_map(|link| [(link, 10), (link, 13)]);
    let all = ropes.flat_map(|rope| firm.map(|firm| (rope, firm)));
    for ((link, links), (firmness, damping)) in in_turn(all.collect()) {
        let mut chain = chain(CoiloverPlugin::default(), link, links, firmness);
        if let Some(damping) = damping {
            chain.damp(damping);
        }
        let mut fastest = 0.0_f32;
        for _ in 0..chain.scene.lab.ticks(6.0) {
            chain.scene.lab.tick();
            fastest = fastest.max(chain.fastest());
        }
        let faults = chain.elements.iter();
        let faults = faults.filter_map(|e| chain.scene.lab.app.world().get::<SpringFault>(*e));
        assert_eq!(faults.count(), 0);
        println!("{links} of {link:?}, firmness {firmness}, {damping:?}: at most {fastest:.1} m/s");
        assert!(
            fastest < 12.0,
            "{links} of {link:?}, {firmness}: {fastest} m/s"
        );
    }
}

/// Planks joined by ropes, and a box of 80 kg that falls on them.
#[test]
fn a_bridge_of_ropes_holds_what_falls_on_it() {
    const PLANKS: usize = 10;
    const PITCH: f32 = 0.5;
    for stiffness in [3e4, 2e5] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let plank = |i: usize| {
            let at = Vec3::X * PITCH * (i as f32 - 0.5 * (PLANKS + 1) as f32);
            Transform::from_translation(at)
        };
        let size = Vec3::new(0.2, 0.03, 0.5);
        let bank = |scene: &mut Stand, i| scene.lab.spawn((RigidBody::Fixed, plank(i)));
        let mut all = vec![bank(&mut scene, 0)];
        for i in 1..=PLANKS {
            let collider = Collider::cuboid(size.x, size.y, size.z);
            let weight = (
                collider,
                ColliderMassProperties::Mass(8.0),
                Damping {
                    linear_damping: 0.5,
                    angular_damping: 0.5,
                },
            );
            all.push(scene.body(plank(i), weight));
        }
        all.push(bank(&mut scene, PLANKS + 1));
        for pair in all.windows(2) {
            for side in [-0.5, 0.5] {
                let anchors = [0.2, -0.2].map(|x| Vec3::new(x, 0.0, side));
                let ends = [pair[0], pair[1]];
                let rope = scene.coil(ends, anchors, [stiffness, 300.0], Some(0.15));
                let mut rope = scene.lab.app.world_mut().entity_mut(rope);
                rope.insert(SpringAction::Pull);
            }
        }
        let crate_of = (
            Collider::cuboid(0.3, 0.3, 0.3),
            ColliderMassProperties::Mass(80.0),
        );
        let load = scene.body(Transform::from_xyz(0.1, 1.0, 0.0), crate_of);
        let mut fastest = 0.0_f32;
        for _ in 0..scene.lab.ticks(20.0) {
            scene.lab.tick();
            let of = |body: &Entity| scene.lab.velocity(*body).length();
            fastest = fastest.max(scene.bodies.iter().map(of).fold(0.0, f32::max));
        }
        let of = |body: &Entity| scene.lab.velocity(*body).length();
        let last = scene.bodies.iter().map(of).fold(0.0, f32::max);
        let at = scene.lab.position(load);
        println!(
            "bridge of ropes, {stiffness} N/m: at most {fastest:.1} m/s, in the end {last:.3}, load at {at:.2}"
        );
        assert!(fastest < 10.0, "{fastest} m/s");
        assert!(
            last < 0.1 && (-2.5..0.0).contains(&at.y),
            "{last} m/s, at {at}"
        );
    }
}
