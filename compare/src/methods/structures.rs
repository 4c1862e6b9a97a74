//! The structures of `leafwalk_cpu::structures`: each with margins and the exact test, and as published.

use leafwalk_cpu::structures::bvh::{Ball, KDop, OrientedBox, Settings, Splits};
use leafwalk_cpu::structures::octrees::{NeighbourFinding, Published, TopDown, Unconstrained, published};
use leafwalk_cpu::structures::triangles::{
    BaldwinWeber, InCallersUnits, MollerTrumbore, Plucker, Projected, Watertight,
};
use leafwalk_cpu::structures::{Bounds, Bsp, Bvh, Every, Exact, Structure, Traced, bsp};
use leafwalk_cpu::{BuildError, MeshRef};

use super::{Built, Handling, Method};

pub(super) const METHODS: &[Method] = &[
    conservative("every triangle", "none", "none", |mesh| with_margins::<Every>(mesh, &())),
    conservative("BVH, surface area", "BVH", "I. Wald, 2007", |mesh| {
        with_margins::<Bvh<Bounds>>(mesh, &Settings::default())
    }),
    conservative("BVH, median", "BVH", "T. Kay, J. Kajiya, 1986", |mesh| {
        with_margins::<Bvh<Bounds>>(mesh, &Settings { splits: Splits::Median, leaf: 4 })
    }),
    conservative("BVH, balls", "BVH", "J. Ritter, 1990", |mesh| with_margins::<Bvh<Ball>>(mesh, &Settings::default())),
    conservative("BVH, oriented boxes", "BVH", "S. Gottschalk and others, 1996", |mesh| {
        with_margins::<Bvh<OrientedBox>>(mesh, &Settings::default())
    }),
    conservative("BVH, 14-DOPs", "BVH", "J. Klosowski and others, 1998", |mesh| {
        with_margins::<Bvh<KDop>>(mesh, &Settings::default())
    }),
    conservative("BSP, planes of triangles and on edges", "BSP", "T. Ize and others, 2008", |mesh| {
        with_margins::<Bsp>(mesh, &bsp::Settings::default())
    }),
    conservative("BSP, planes of triangles", "BSP", "H. Fuchs, Z. Kedem, B. Naylor, 1980", |mesh| {
        with_margins::<Bsp>(mesh, &bsp::Settings::own_planes_only())
    }),
    conservative("octree, top down", "octree", "J. Revelles and others, 2000", |mesh| {
        with_margins::<TopDown>(mesh, &Default::default())
    }),
    conservative("octree, neighbour finding", "octree", "H. Samet, 1989", |mesh| {
        with_margins::<NeighbourFinding>(mesh, &Default::default())
    }),
    conservative("octree, unconstrained links", "octree", "after R. Portalez, F. Duguet", |mesh| {
        with_margins::<Unconstrained>(mesh, &Default::default())
    }),
    conservative("octree, links, corrected", "octree", "R. Portalez, F. Duguet", |mesh| {
        with_margins::<Published>(mesh, &Default::default())
    }),
    as_published("BVH, watertight", "BVH", "watertight", "S. Woop and others, 2013", |mesh| {
        without_margins::<Bvh<Bounds>, Watertight>(mesh, &Settings::default())
    }),
    as_published("BVH, Möller-Trumbore", "BVH", "Möller-Trumbore", "T. Möller, B. Trumbore, 1997", |mesh| {
        without_margins::<Bvh<Bounds>, MollerTrumbore<false>>(mesh, &Settings::default())
    }),
    as_published(
        "BVH, Möller-Trumbore, tolerant",
        "BVH",
        "Möller-Trumbore, 1e-6",
        "T. Möller, B. Trumbore, 1997",
        |mesh| without_margins::<Bvh<Bounds>, MollerTrumbore<true>>(mesh, &Settings::default()),
    ),
    as_published("BVH, Baldwin-Weber", "BVH", "Baldwin-Weber", "D. Baldwin, M. Weber, 2016", |mesh| {
        without_margins::<Bvh<Bounds>, BaldwinWeber>(mesh, &Settings::default())
    }),
    as_published("BVH, Plücker", "BVH", "Plücker", "J. Erickson, 1997", |mesh| {
        without_margins::<Bvh<Bounds>, Plucker>(mesh, &Settings::default())
    }),
    as_published("BVH, projected", "BVH", "projected", "D. Badouel, 1990", |mesh| {
        without_margins::<Bvh<Bounds>, Projected>(mesh, &Settings::default())
    }),
    as_published("octree, top down, watertight", "octree", "watertight", "J. Revelles and others, 2000", |mesh| {
        without_margins::<TopDown, Watertight>(mesh, &Default::default())
    }),
    as_published("octree, neighbour finding, watertight", "octree", "watertight", "H. Samet, 1989", |mesh| {
        without_margins::<NeighbourFinding, Watertight>(mesh, &Default::default())
    }),
    as_published("octree, links, as printed", "octree", "watertight", "R. Portalez, F. Duguet", |mesh| {
        let settings = published::Settings { mode: published::Mode::Printed, ..Default::default() };
        without_margins::<Published, Watertight>(mesh, &settings)
    }),
];

const fn as_published(
    name: &'static str,
    family: &'static str,
    test: &'static str,
    source: &'static str,
    build: fn(MeshRef<'_>) -> Result<Built, BuildError>,
) -> Method {
    Method { name, family, test, handling: Handling::AsPublished, source, build }
}

fn without_margins<S: Structure + 'static, T: InCallersUnits>(
    mesh: MeshRef<'_>,
    settings: &S::Settings,
) -> Result<Built, BuildError> {
    let traced = Traced::<S, T>::as_published(mesh, settings)?;
    Ok(Built { bytes: traced.bytes(), tracer: Box::new(traced) })
}

const fn conservative(
    name: &'static str,
    family: &'static str,
    source: &'static str,
    build: fn(MeshRef<'_>) -> Result<Built, BuildError>,
) -> Method {
    Method { name, family, test: "exact", handling: Handling::Conservative, source, build }
}

fn with_margins<S: Structure + 'static>(mesh: MeshRef<'_>, settings: &S::Settings) -> Result<Built, BuildError> {
    let traced = Traced::<S, Exact>::conservative(mesh, settings)?;
    Ok(Built { bytes: traced.bytes(), tracer: Box::new(traced) })
}
