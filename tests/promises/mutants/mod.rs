//! Each clause of the contract broken on purpose: a check that passes on the real thing must fail.

mod arithmetic;
mod clauses;
mod lattice;
mod links;
mod padding;
mod spawn;
mod stop;
mod truth;
mod vertices;
