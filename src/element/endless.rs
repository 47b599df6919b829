//! Elements without ends yet: their defaults, and how `bsn!` writes them.
//!
//! What Bevy derives would let no scene leave the ends out, and start coefficients at zero.

use super::*;
use bevy::ecs::template::{EntityTemplate, SpecializeFromTemplate, TemplateContext};
use bevy::prelude::*;

/// An end that is given later.
const NOBODY: Entity = Entity::PLACEHOLDER;

macro_rules! endless {
    ($element:ident, $template:ident, $new:expr, {$($field:ident: $kind:ty),*}) => {
        /// Without ends: give them, or put [`EndNames`] beside the element. The rest is as `new` makes it.
        impl Default for $element {
            fn default() -> Self {
                $new
            }
        }

        // As Bevy's own derive does: lets a type have both `Default` and a template that is not itself.
        impl Unpin for $element where for<'a> [()]: SpecializeFromTemplate {}

        /// What `bsn!` makes of the element of the same name. An end that is left out is [`Entity::PLACEHOLDER`].
        #[allow(missing_docs)]
        pub struct $template {
            pub body_a: EntityTemplate,
            pub body_b: EntityTemplate,
            $(pub $field: $kind,)*
        }

        impl Default for $template {
            fn default() -> Self {
                let $element { $($field,)* .. } = $element::default();
                Self {
                    body_a: EntityTemplate::None,
                    body_b: EntityTemplate::None,
                    $($field,)*
                }
            }
        }

        impl Template for $template {
            type Output = $element;

            fn build_template(&self, context: &mut TemplateContext) -> Result<$element> {
                Ok($element {
                    body_a: end(&self.body_a, context)?,
                    body_b: end(&self.body_b, context)?,
                    $($field: self.$field,)*
                })
            }

            fn clone_template(&self) -> Self {
                Self {
                    body_a: self.body_a.clone_template(),
                    body_b: self.body_b.clone_template(),
                    $($field: self.$field,)*
                }
            }
        }

        impl FromTemplate for $element {
            type Template = $template;
        }
    };
}

/// The entity of an end, if the scene gives one.
fn end(template: &EntityTemplate, context: &mut TemplateContext) -> Result<Entity> {
    match template {
        EntityTemplate::None => Ok(NOBODY),
        given => given.build_template(context),
    }
}

endless!(Spring, SpringTemplate, Spring::new(NOBODY, NOBODY), {
    rest_length: Option<f32>,
    stiffness: f32
});
endless!(Damper, DamperTemplate, Damper::new(NOBODY, NOBODY), { damping: f32 });
endless!(SpringDamper, SpringDamperTemplate, SpringDamper::new(NOBODY, NOBODY), {
    rest_length: Option<f32>,
    stiffness: f32,
    damping: f32
});
endless!(
    TorsionSpring,
    TorsionSpringTemplate,
    TorsionSpring::new(NOBODY, NOBODY, Vec3::X),
    { axis: Vec3, rest_angle: Option<f32>, stiffness: f32 }
);
endless!(
    TorsionDamper,
    TorsionDamperTemplate,
    TorsionDamper::new(NOBODY, NOBODY, Vec3::X),
    { axis: Vec3, damping: f32 }
);
endless!(
    TorsionSpringDamper,
    TorsionSpringDamperTemplate,
    TorsionSpringDamper::new(NOBODY, NOBODY, Vec3::X),
    { axis: Vec3, rest_angle: Option<f32>, stiffness: f32, damping: f32 }
);
