//! The builder: what it makes of any mesh, within which limits, and that its lists are complete.

mod full_leaves;
mod inputs;
mod limits;
mod listing;
mod structure;
mod threads;
mod utm;
mod verification;
