//! All editable numbers of one element.

use super::like::is_like;
use crate::element::*;
use bevy::prelude::*;
use std::fmt::Debug;

/// The component that makes an entity an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    Spring(Spring),
    Damper(Damper),
    SpringDamper(SpringDamper),
    TorsionSpring(TorsionSpring),
    TorsionDamper(TorsionDamper),
    TorsionSpringDamper(TorsionSpringDamper),
}

/// An element and its companions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    pub part: Part,
    pub anchors: Option<Anchors>,
    pub spring_law: Option<SpringLaw>,
    pub damping_law: Option<DampingLaw>,
    pub action: Option<SpringAction>,
    pub travel: Option<SpringTravel>,
    pub axis: Option<SpringAxis>,
    pub preload: Option<Preload>,
    pub max_force: Option<MaxForce>,
    pub breakable: Option<Breakable>,
}

/// Calls a macro for each companion.
macro_rules! each_companion {
    ($action:ident) => {
        $action!(anchors);
        $action!(spring_law);
        $action!(damping_law);
        $action!(action);
        $action!(travel);
        $action!(axis);
        $action!(preload);
        $action!(max_force);
        $action!(breakable);
    };
}

/// Evaluates an expression for whichever component makes the element.
macro_rules! each_part {
    ($part:expr, $name:ident => $value:expr) => {
        match $part {
            Part::Spring($name) => $value,
            Part::Damper($name) => $value,
            Part::SpringDamper($name) => $value,
            Part::TorsionSpring($name) => $value,
            Part::TorsionDamper($name) => $value,
            Part::TorsionSpringDamper($name) => $value,
        }
    };
}

impl Part {
    fn read(entity: EntityRef) -> Option<Self> {
        let part = entity.get().copied().map(Self::SpringDamper);
        let part = part.or_else(|| entity.get().copied().map(Self::Spring));
        let part = part.or_else(|| entity.get().copied().map(Self::Damper));
        let part = part.or_else(|| entity.get().copied().map(Self::TorsionSpringDamper));
        let part = part.or_else(|| entity.get().copied().map(Self::TorsionSpring));
        part.or_else(|| entity.get().copied().map(Self::TorsionDamper))
    }

    /// Returns the name of the component.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Spring(_) => "Spring",
            Self::Damper(_) => "Damper",
            Self::SpringDamper(_) => "SpringDamper",
            Self::TorsionSpring(_) => "TorsionSpring",
            Self::TorsionDamper(_) => "TorsionDamper",
            Self::TorsionSpringDamper(_) => "TorsionSpringDamper",
        }
    }

    pub fn ends(&self) -> [Entity; 2] {
        each_part!(self, part => [part.body_a, part.body_b])
    }

    pub fn is_torsion(&self) -> bool {
        self.twist().is_some()
    }

    /// Returns the axis of a torsion element, in body A's frame.
    pub fn twist(&self) -> Option<Vec3> {
        match self {
            Self::TorsionSpring(part) => Some(part.axis),
            Self::TorsionDamper(part) => Some(part.axis),
            Self::TorsionSpringDamper(part) => Some(part.axis),
            _ => None,
        }
    }

    pub fn twist_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::TorsionSpring(part) => Some(&mut part.axis),
            Self::TorsionDamper(part) => Some(&mut part.axis),
            Self::TorsionSpringDamper(part) => Some(&mut part.axis),
            _ => None,
        }
    }

    /// Returns the stiffness (N/m or N m/rad) if there is a spring.
    pub fn stiffness_mut(&mut self) -> Option<&mut f32> {
        match self {
            Self::Spring(part) => Some(&mut part.stiffness),
            Self::SpringDamper(part) => Some(&mut part.stiffness),
            Self::TorsionSpring(part) => Some(&mut part.stiffness),
            Self::TorsionSpringDamper(part) => Some(&mut part.stiffness),
            Self::Damper(_) | Self::TorsionDamper(_) => None,
        }
    }

    /// Returns the damping (N s/m or N m s/rad) if there is a damper.
    pub fn damping_mut(&mut self) -> Option<&mut f32> {
        match self {
            Self::Damper(part) => Some(&mut part.damping),
            Self::SpringDamper(part) => Some(&mut part.damping),
            Self::TorsionDamper(part) => Some(&mut part.damping),
            Self::TorsionSpringDamper(part) => Some(&mut part.damping),
            Self::Spring(_) | Self::TorsionSpring(_) => None,
        }
    }

    /// Returns the rest length (m) or rest angle (rad) if there is a spring.
    pub fn rest_mut(&mut self) -> Option<&mut Option<f32>> {
        match self {
            Self::Spring(part) => Some(&mut part.rest_length),
            Self::SpringDamper(part) => Some(&mut part.rest_length),
            Self::TorsionSpring(part) => Some(&mut part.rest_angle),
            Self::TorsionSpringDamper(part) => Some(&mut part.rest_angle),
            Self::Damper(_) | Self::TorsionDamper(_) => None,
        }
    }

    pub fn stiffness(mut self) -> Option<f32> {
        self.stiffness_mut().copied()
    }

    pub fn damping(mut self) -> Option<f32> {
        self.damping_mut().copied()
    }

    pub fn rest(mut self) -> Option<f32> {
        self.rest_mut().copied().flatten()
    }

    /// Copies from `to` the numbers in which `from` and `to` differ.
    fn carry(&mut self, from: &Self, to: &Self) {
        if !is_like(&from.stiffness(), &to.stiffness())
            && let (Some(mine), Some(value)) = (self.stiffness_mut(), to.stiffness())
        {
            *mine = value;
        }
        if !is_like(&from.damping(), &to.damping())
            && let (Some(mine), Some(value)) = (self.damping_mut(), to.damping())
        {
            *mine = value;
        }
        if !is_like(&from.rest(), &to.rest())
            && let Some(mine) = self.rest_mut()
        {
            *mine = to.rest();
        }
        if !is_like(&from.twist(), &to.twist())
            && let (Some(mine), Some(value)) = (self.twist_mut(), to.twist())
        {
            *mine = value;
        }
    }
}

impl Snapshot {
    /// Returns a snapshot without companions.
    pub fn new(part: Part) -> Self {
        Self {
            part,
            anchors: None,
            spring_law: None,
            damping_law: None,
            action: None,
            travel: None,
            axis: None,
            preload: None,
            max_force: None,
            breakable: None,
        }
    }

    /// Reads an entity; `None` if it is not an element.
    pub fn read(entity: EntityRef) -> Option<Self> {
        let mut snapshot = Self::new(Part::read(entity)?);
        macro_rules! read {
            ($field:ident) => {
                snapshot.$field = entity.get().cloned();
            };
        }
        each_companion!(read);
        Some(snapshot)
    }

    /// Writes to an entity the components that differ from it.
    pub fn write(&self, entity: &mut EntityWorldMut) {
        fn part<T: Component<Mutability = bevy::ecs::component::Mutable> + PartialEq + Debug>(
            value: T,
            entity: &mut EntityWorldMut,
        ) {
            if let Some(mut part) = entity.get_mut::<T>()
                && !is_like(&*part, &value)
            {
                *part = value;
            }
        }
        fn beside<T: Component + PartialEq + Debug + Clone>(
            value: &Option<T>,
            entity: &mut EntityWorldMut,
        ) {
            let before = entity.get::<T>();
            match value {
                Some(value) if before.is_none_or(|before| !is_like(before, value)) => {
                    entity.insert(value.clone());
                }
                None if entity.contains::<T>() => {
                    entity.remove::<T>();
                }
                _ => {}
            }
        }
        each_part!(self.part, value => part(value, entity));
        macro_rules! write {
            ($field:ident) => {
                beside(&self.$field, entity);
            };
        }
        each_companion!(write);
    }

    /// Copies from `to` the numbers and companions in which `from` and `to` differ. The rest stays as it is, so
    /// changes that the game has made meanwhile are not lost.
    pub fn carry(&mut self, from: &Self, to: &Self) {
        self.part.carry(&from.part, &to.part);
        macro_rules! carry {
            ($field:ident) => {
                if !is_like(&from.$field, &to.$field) {
                    self.$field.clone_from(&to.$field);
                }
            };
        }
        each_companion!(carry);
    }

    /// Whether the length can be negative: it is an angle, or a distance along an axis.
    pub fn has_sign(&self) -> bool {
        self.part.is_torsion() || self.axis.is_some()
    }

    /// Whether the spring force is stiffness · stretch, apart from force limits and stops.
    pub fn spring_is_linear(&self) -> bool {
        matches!(self.spring_law, None | Some(SpringLaw::Linear))
    }

    /// Whether the damper force is damping · rate.
    pub fn damper_is_linear(&self) -> bool {
        matches!(self.damping_law, None | Some(DampingLaw::Linear))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world() -> (World, Entity) {
        let mut world = World::new();
        let [a, b] = [world.spawn_empty().id(), world.spawn_empty().id()];
        let pair = SpringDamper::new(a, b).with_stiffness(80.0);
        let entity = world.spawn((pair, Preload(5.0))).id();
        (world, entity)
    }

    #[test]
    fn what_is_written_is_read() {
        let (mut world, entity) = world();
        let mut snapshot = Snapshot::read(world.entity(entity)).expect("an element");
        assert_eq!(snapshot.part.stiffness(), Some(80.0));
        assert_eq!(snapshot.preload, Some(Preload(5.0)));
        if let Some(damping) = snapshot.part.damping_mut() {
            *damping = 3.0;
        }
        snapshot.preload = None;
        snapshot.action = Some(SpringAction::Pull);
        snapshot.write(&mut world.entity_mut(entity));
        assert_eq!(
            Snapshot::read(world.entity(entity)).as_ref(),
            Some(&snapshot)
        );
        assert!(!world.entity(entity).contains::<Preload>());
    }

    #[test]
    fn what_is_equal_is_not_touched() {
        for number in [5.0, f32::NAN] {
            let (mut world, entity) = world();
            world.entity_mut(entity).insert(Preload(number));
            if let Some(mut pair) = world.get_mut::<SpringDamper>(entity) {
                pair.stiffness = number;
            }
            let before = world.change_tick();
            world.increment_change_tick();
            let snapshot = Snapshot::read(world.entity(entity)).expect("an element");
            snapshot.write(&mut world.entity_mut(entity));
            let element = world.entity(entity);
            let part = element.get_change_ticks::<SpringDamper>();
            let beside = element.get_change_ticks::<Preload>();
            for ticks in [part, beside] {
                let ticks = ticks.expect("it is there");
                assert!(!ticks.is_changed(before, world.read_change_tick()));
            }
        }
    }

    #[test]
    fn an_edit_leaves_what_the_game_has_changed() {
        let (world, entity) = world();
        let before = Snapshot::read(world.entity(entity)).expect("an element");
        let mut after = before.clone();
        if let Some(stiffness) = after.part.stiffness_mut() {
            *stiffness = 90.0;
        }
        let mut now = after.clone();
        if let Some(rest) = now.part.rest_mut() {
            *rest = Some(1.5);
        }
        now.carry(&after, &before);
        assert_eq!(now.part.stiffness(), Some(80.0));
        assert_eq!(now.part.rest(), Some(1.5));
    }

    #[test]
    fn a_nan_that_the_game_has_mended_does_not_come_back_with_an_edit_of_another_number() {
        let (world, entity) = world();
        let mended = Snapshot::read(world.entity(entity)).expect("an element");
        let mut before = mended.clone();
        if let Some(stiffness) = before.part.stiffness_mut() {
            *stiffness = f32::NAN;
        }
        before.preload = Some(Preload(f32::NAN));
        let mut after = before.clone();
        if let Some(damping) = after.part.damping_mut() {
            *damping = 3.0;
        }
        let mut now = mended.clone();
        now.carry(&before, &after);
        assert_eq!(now.part.damping(), Some(3.0));
        assert_eq!(now.part.stiffness(), mended.part.stiffness());
        assert_eq!(now.preload, mended.preload);
    }
}
