//! Anchors that were given as points of the world become points of the ends.

use super::parts::IsElement;
use crate::element::*;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// The ends of an element, whichever it is.
#[derive(QueryData)]
pub(crate) struct EndsOf {
    spring: Option<&'static Spring>,
    damper: Option<&'static Damper>,
    pair: Option<&'static SpringDamper>,
    torsion_spring: Option<&'static TorsionSpring>,
    torsion_damper: Option<&'static TorsionDamper>,
    torsion_pair: Option<&'static TorsionSpringDamper>,
}

impl EndsOfItem<'_, '_> {
    fn ends(&self) -> Option<[Entity; 2]> {
        let linear = self.spring.map(|e| [e.body_a, e.body_b]);
        let linear = linear.or(self.damper.map(|e| [e.body_a, e.body_b]));
        let linear = linear.or(self.pair.map(|e| [e.body_a, e.body_b]));
        let torsion = self.torsion_spring.map(|e| [e.body_a, e.body_b]);
        let torsion = torsion.or(self.torsion_damper.map(|e| [e.body_a, e.body_b]));
        linear
            .or(torsion)
            .or(self.torsion_pair.map(|e| [e.body_a, e.body_b]))
    }
}

/// Turns [`WorldAnchors`] into [`Anchors`]. Where an end is not there yet, it waits; the element says so itself.
pub(crate) fn anchor(
    mut given: Query<(Entity, EndsOf, &WorldAnchors, &mut Anchors), IsElement>,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    for (entity, element, points, mut anchors) in &mut given {
        // Composed from local transforms: the global ones are a frame old here.
        let local = |end: Entity, point: Vec3| {
            let global = transforms.compute_global_transform(end).ok()?;
            Some(global.affine().inverse().transform_point3(point))
        };
        let Some([a, b]) = element.ends() else {
            continue;
        };
        let (Some(a), Some(b)) = (local(a, points.a), local(b, points.b)) else {
            continue;
        };
        // What cannot be turned (an end that is scaled to nothing) is no number, and that is told as any bad anchor is.
        anchors.set_if_neq(Anchors::new(a, b));
        commands.entity(entity).try_remove::<WorldAnchors>();
    }
}
