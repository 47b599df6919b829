//! Elements without ends: their `Default`, and their templates for `bsn!`.
//!
//! The templates that Bevy derives would not let a scene omit the ends, and would start coefficients at zero.

use super::*;
use bevy::ecs::template::{EntityTemplate, SpecializeFromTemplate, TemplateContext};
use bevy::prelude::*;

/// Stands for an end that is given later.
const NOBODY: Entity = Entity::PLACEHOLDER;

macro_rules! endless {
    ($element:ident, $template:ident, $new:expr, {$($field:ident: $kind:ty),*}) => {
        /// An element without ends. Set `body_a` and `body_b`, or put [`EndNames`] beside the element. All other fields
        /// are as `new` sets them.
        impl Default for $element {
            fn default() -> Self {
                $new
            }
        }

        // As Bevy's own derive does: this lets a type have both `Default` and a template of another type.
        impl Unpin for $element where for<'a> [()]: SpecializeFromTemplate {}

        /// Template from which `bsn!` makes the element of the same name. An end that is omitted becomes
        /// [`Entity::PLACEHOLDER`].
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

/// Returns the entity of an end, or `NOBODY` if the scene gives none.
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
