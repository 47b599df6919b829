//! Change ticks of the companions of an element.

use crate::element::*;
use crate::input::lists::with_companions;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

macro_rules! stamps {
    ([$($law:ident: $kind:ident),*] [$($other:ident: $other_kind:ident),*]) => {
        /// Each companion, with its change tick.
        #[derive(QueryData)]
        pub(crate) struct Stamps {
            $($law: Option<Ref<'static, $kind>>,)*
            $($other: Option<Ref<'static, $other_kind>>,)*
        }

        impl StampsItem<'_, '_> {
            /// Whether any companion changed after the tick `since`.
            pub(crate) fn is_after(&self, since: Tick, now: Tick) -> bool {
                fn at<T: Component>(part: &Option<Ref<T>>) -> Option<Tick> {
                    part.as_ref().map(Ref::last_changed)
                }
                let mut all = [$(at(&self.$law),)* $(at(&self.$other),)*].into_iter().flatten();
                all.any(|at| at.is_newer_than(since, now))
            }
        }
    };
}
with_companions!(stamps);
