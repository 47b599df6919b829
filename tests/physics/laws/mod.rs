//! Elements with a force law or another companion component move as that law says.

mod axis;
mod bad;
mod blows;
mod breaking;
mod computed;
mod driven;
mod extreme;
mod given;
mod hold;
mod ledger;
mod light;
mod off_centre;
mod one_way;
pub mod random;
mod shock;
mod smooth;
mod torsion;
mod tuning;
mod unloaded;
