//! Converts the row of an element to the integrator's element.

use crate::backend::Sight;
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End, Path};
use crate::dynamics::guide::Guide;
use crate::input::check::Fault;
use crate::scene::rows::{BodyRow, ElementFlags, ElementRow, Held, Rows};
use crate::scene::step::Step;

impl Step {
    /// An end as the integrator sees it.
    pub(crate) fn end(
        &self,
        row: &ElementRow,
        end: usize,
        bodies: &(impl Rows<BodyRow> + ?Sized),
        sight: &impl Sight,
    ) -> End {
        let held = row.rare.held[end];
        if let (Held::Body { body, local, .. }, Some(index)) = (held, row.movable(end))
            && let Some(body) = sight.see(body)
        {
            return End::Body {
                index: bodies[index].rare.slot as usize,
                arm: local - body.local_center.as_dvec3(),
            };
        }
        let [from, to] = self.path(&held, sight);
        let mut path = Path::straight(from, (to - from) / self.plan.time);
        if let Held::Body { body, .. } = held
            && row.rare.guide.turns()
            && let Some(turning) = sight.turning(body, self.plan.time)
        {
            (path.rotation, path.turning) = turning;
        }
        End::Path(path)
    }
}

/// Returns the integrator's element, or none if it has a fault, which is then stored in the row.
/// Captures the rest length if there is none.
pub(crate) fn element(row: &mut ElementRow, ends: [End; 2], bodies: &[Body]) -> Option<Element> {
    row.trouble.set_passing(None);
    let p = row.numbers;
    let mut element = Element {
        ends,
        stiffness: f64::from(p.stiffness),
        damping: f64::from(p.damping),
        rest_length: f64::from(p.rest_length.unwrap_or(0.0)),
        guide: row.rare.guide,
        law: row.law.clone(),
        angle: row.rare.angle,
        heat: 0.0,
        work: 0.0,
        direction: row.direction(),
        stiff_damper: false,
    };
    if p.rest_length.is_some()
        && element.law.is_none()
        && let Some(inverse_mass) = element.plain_inverse_mass(bodies)
    {
        row.inverse_mass = inverse_mass;
        return Some(element);
    }
    let guided = element.guide != Guide::Centres;
    let mut line = element.line(bodies);
    if p.rest_length.is_none() {
        let length = line.map_or(0.0, |line| line.distance()) as f32;
        element.rest_length = f64::from(length);
        line = element.line(bodies);
        // Without a line there is nothing to measure yet.
        if line.is_some() {
            row.numbers.rest_length = Some(length);
            row.flags.insert(ElementFlags::CAPTURED);
        }
    }
    let Some(line) = line else {
        let reason = if guided {
            "is tilted half a turn against body_a, where a twist has no meaning"
        } else {
            "coincides with body_a, so nothing says which way to push; move one or set Anchors"
        };
        let fault = Fault::new(row.rare.ties.names.ends[1], reason);
        row.trouble.set_passing(Some(fault));
        return None;
    };
    if element.guide.is_twist() && line.inverse_mass == 0.0 {
        let reason = "acts on nothing, for neither end can be turned about its axis";
        row.trouble
            .set_passing(Some(Fault::new(row.rare.ties.names.axis, reason)));
        return None;
    }
    if element.law.is_some()
        && !element.is_sound(line.distance(), line.motion(&element, bodies, 0.0).axial)
    {
        let fault = Fault::UNSOUND_LAW;
        row.trouble.set_passing(Some(fault));
        return None;
    }
    row.inverse_mass = line.inverse_mass;
    Some(element)
}
