//! How fast and how right ways to trace rays are, beside each other.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`measure`] | how right answers are |
//! | [`ladder`] | scenes and rays made harder step by step |
//! | [`charts`] | that as pictures |
//! | [`methods`] | the structures and triangle tests, ours and others, by name |
//! | [`rays`], [`random`] | rays aimed where methods fail, from a seed: the same on every machine |
//! | [`scenes`] | scenes made of a mesh |
//! | [`workloads`] | the four kinds of rays that speed is measured with |
//! | [`truth`] | what rays hit, decided exactly on the caller's own mesh, and what is to be said of an answer |
#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]

pub mod charts;
pub mod ladder;
pub mod measure;
pub mod methods;
pub mod random;
pub mod rays;
pub mod scenes;
pub mod truth;
pub mod workloads;
