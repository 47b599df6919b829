//! The list of components that are elements, and that of their companions. Other code is generated from these two
//! lists.

/// Calls a macro with all components that are elements.
macro_rules! with_elements {
    ($call:ident) => {
        $call! { Spring, Damper, SpringDamper, TorsionSpring, TorsionDamper, TorsionSpringDamper }
    };
}
pub(crate) use with_elements;

/// Calls a macro with the name and type of each companion. The first list makes up the law of an element. The second
/// list is read only now and then, and the law stays the same when one of its components is removed.
macro_rules! with_companions {
    ($call:ident) => {
        $call! {
            [
                spring: SpringLaw,
                own_spring: CustomSpringLaw,
                damping: DampingLaw,
                own_damping: CustomDampingLaw,
                action: SpringAction,
                travel: SpringTravel,
                preload: Preload,
                max_force: MaxForce,
                axis: SpringAxis
            ]
            [breakable: Breakable, tuning: SpringTuning, pose: HoldPose]
        }
    };
}
pub(crate) use with_companions;
