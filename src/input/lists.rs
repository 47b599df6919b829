//! Which components are elements, and which stand beside one. Each list stands here alone; others are made from it.

/// Calls a macro with all components that are elements.
macro_rules! with_elements {
    ($call:ident) => {
        $call! { Spring, Damper, SpringDamper, TorsionSpring, TorsionDamper, TorsionSpringDamper }
    };
}
pub(crate) use with_elements;

/// Calls a macro with the name and type of each component that can stand beside an element: first those that make its law,
/// then those that are asked only now and then, and change nothing when they go.
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
