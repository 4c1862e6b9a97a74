//! Checks that decoding cannot afford: every triangle is binned again, and compared with the mesh.

use core::fmt;

use leafwalk_core::layout::{BVH_WIDTH, Block, Child, Key, LatticeBox, NONE, Payload, Record, Triangle};
use leafwalk_core::{Octree, Parts};
use rayon::prelude::*;

use crate::build::{BuildError, NonFinite, Split, box_inside, normalise_with};
use crate::mesh::MeshRef;

/// What a verification found in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verified {
    /// Triangles that were binned again.
    pub triangles: u64,
    /// References that were needed and found.
    pub references: u64,
}

/// What is wrong with an octree that decodes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum VerifyError {
    /// A leaf whose dilated cell meets a triangle does not list it: rays would miss it.
    MissingReference {
        /// Record number of the leaf.
        leaf: u32,
        /// The triangle.
        primitive: u32,
    },
    /// A leaf lists a triangle whose part inside the cell sticks out of its block's box: rays would miss it.
    SmallBox {
        /// Record number of the leaf.
        leaf: u32,
        /// The triangle.
        primitive: u32,
    },
    /// The nodes do not lead to a block, or only with a box that is smaller than the one in its leaf: rays that descend
    /// would miss it.
    LostBlock {
        /// Number of the block.
        block: u32,
    },
    /// Two leaves list a triangle with different corners.
    CornersDiffer {
        /// Record number of the second leaf.
        leaf: u32,
        /// The triangle.
        primitive: u32,
    },
    /// The number of triangles listed anywhere is not the one that the header gives.
    TriangleCount {
        /// Listed somewhere.
        listed: u64,
        /// Triangles of the mesh less those dropped.
        expected: u64,
    },
    /// The octree was built from another mesh.
    OtherMesh {
        /// The first thing that differs.
        what: &'static str,
        /// The triangle that differs, where one does.
        primitive: Option<u32>,
    },
    /// The mesh to compare with cannot be built at all.
    Mesh(BuildError),
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissingReference { leaf, primitive } => {
                write!(f, "leaf {leaf} does not list triangle {primitive}, which meets it: build the octree anew")
            }
            Self::SmallBox { leaf, primitive } => {
                write!(f, "in leaf {leaf} triangle {primitive} sticks out of its block's box: build the octree anew")
            }
            Self::LostBlock { block } => {
                write!(
                    f,
                    "no BVH node leads to block {block} with a box as large as in its leaf: build the octree anew"
                )
            }
            Self::CornersDiffer { leaf, primitive } => {
                write!(f, "leaf {leaf} has other corners for triangle {primitive} than an earlier leaf: build it anew")
            }
            Self::TriangleCount { listed, expected } => {
                write!(f, "{listed} triangles are listed, but the header says {expected}: build the octree anew")
            }
            Self::OtherMesh { what, primitive: Some(primitive) } => {
                write!(f, "built from another mesh: {what} of triangle {primitive} differ")
            }
            Self::OtherMesh { what, primitive: None } => write!(f, "built from another mesh: the {what} differs"),
            Self::Mesh(error) => write!(f, "the mesh to compare with: {error}"),
        }
    }
}

impl core::error::Error for VerifyError {}

/// Bins every triangle of an octree again and compares with what the leaves list.
///
/// # Errors
/// [`VerifyError`] names the first thing that is wrong.
pub fn verify<W: AsRef<[u32]>>(octree: &Octree<W>) -> Result<Verified, VerifyError> {
    let parts = octree.parts();
    verify_triangles(&parts, &gather(&parts)?)
}

fn verify_triangles(parts: &Parts<'_>, triangles: &[Triangle]) -> Result<Verified, VerifyError> {
    let listed = triangles.len() as u64;
    let expected = u64::from(parts.header.primitives - parts.header.dropped);
    if listed != expected {
        return Err(VerifyError::TriangleCount { listed, expected });
    }
    check_bvh(parts)?;
    let references = Check { parts, triangles }.node(0, (0..triangles.len() as u32).collect())?;
    Ok(Verified { triangles: listed, references })
}

/// Whether the nodes lead to every block that leaves list.
fn check_bvh(parts: &Parts<'_>) -> Result<(), VerifyError> {
    let mut found = vec![LatticeBox::EMPTY; parts.blocks.len()];
    let children = parts.bvh.iter().flat_map(|node| (0..BVH_WIDTH).map(|slot| node.child(slot)));
    for (boxed, child) in children {
        if let Child::Block(block) = child {
            found[block as usize] = boxed;
        }
    }
    let listed = parts
        .payloads
        .iter()
        .flat_map(|payload| (0..payload.count).map(|b| (payload.first + b, payload.boxed(b as usize))));
    let is_lost = |(block, boxed): &(u32, LatticeBox)| !found[*block as usize].contains(*boxed);
    match listed.into_iter().find(is_lost) {
        Some((block, _)) => Err(VerifyError::LostBlock { block }),
        None => Ok(()),
    }
}

/// As [`verify`], and checks that the octree was built from this mesh.
///
/// # Errors
/// [`VerifyError`] names the first thing that is wrong.
pub fn verify_against<'a, W: AsRef<[u32]>>(
    octree: &Octree<W>,
    mesh: impl Into<MeshRef<'a>>,
) -> Result<Verified, VerifyError> {
    let (parts, mesh) = (octree.parts(), mesh.into());
    let differs = |what, primitive| Err(VerifyError::OtherMesh { what, primitive });
    let normalised = normalise_with(mesh, NonFinite::Dropped).map_err(VerifyError::Mesh)?;
    if parts.header.primitives as usize != mesh.triangles.len() {
        return differs("number of triangles", None);
    }
    if parts.frame != normalised.frame {
        return differs("frame", None);
    }
    if parts.materials != mesh.material_ids {
        return differs("list of materials", None);
    }
    let found = gather(&parts)?;
    let expected = normalised.triangles;
    match found.iter().zip(&expected).find(|(found, expected)| found != expected) {
        Some((found, expected)) => differs("corners", Some(found.primitive.min(expected.primitive))),
        None if found.len() != expected.len() => differs("number of triangles listed", None),
        None => verify_triangles(&parts, &found),
    }
}

/// The triangles that leaves list, by ascending primitive. The header's counts are not trusted with memory.
fn gather(parts: &Parts<'_>) -> Result<Vec<Triangle>, VerifyError> {
    let in_leaf = |(_, leaf)| parts.triangles_of(leaf).map(|triangle| triangle.primitive);
    let mut primitives: Vec<u32> = parts.leaves().flat_map(in_leaf).collect();
    primitives.par_sort_unstable();
    primitives.dedup();
    let mut corners = vec![None; primitives.len()];
    for (number, leaf) in parts.leaves() {
        for Triangle { primitive, corners: found } in parts.triangles_of(leaf) {
            let at = primitives.partition_point(|before| *before < primitive);
            if *corners[at].get_or_insert(found) != found {
                return Err(VerifyError::CornersDiffer { leaf: number, primitive });
            }
        }
    }
    let whole = primitives.into_iter().zip(corners.into_iter().flatten());
    Ok(whole.map(|(primitive, corners)| Triangle { primitive, corners }).collect())
}

struct Check<'a> {
    parts: &'a Parts<'a>,
    triangles: &'a [Triangle],
}

impl Check<'_> {
    /// Checks a node that these triangles, given by their place in the list, all meet; returns the references below it.
    fn node(&self, number: u32, triangles: Vec<u32>) -> Result<u64, VerifyError> {
        let record = &self.parts.records[number as usize];
        let key = self.parts.key(number);
        if !record.head().is_inner() {
            return self.leaf(number, key, record, &triangles);
        }
        let split = Split::new(&self.parts.frame, key, self.parts.header.padding);
        let met = |&at: &u32| split.children_met(&self.triangles[at as usize].corners);
        let masks: Vec<u8> = triangles.par_iter().map(met).collect();
        let counts = (0..8u32).into_par_iter().map(|child| {
            let met = triangles.iter().zip(&masks).filter(|(_, mask)| **mask >> child & 1 == 1);
            self.node(record.offset + child, met.map(|(at, _)| *at).collect())
        });
        counts.try_reduce(|| 0, |a, b| Ok(a + b))
    }

    fn leaf(&self, number: u32, key: Key, leaf: &Record, triangles: &[u32]) -> Result<u64, VerifyError> {
        let mut listed = Vec::new();
        for payload in self.parts.payloads_of(leaf) {
            for (b, block) in self.parts.blocks.of(payload).enumerate() {
                self.block(number, key, payload, b, &block)?;
                listed.extend(block.primitives.iter().filter(|primitive| **primitive != NONE));
            }
        }
        listed.sort_unstable();
        let mut expected = triangles.iter().map(|at| self.triangles[*at as usize].primitive);
        match expected.find(|primitive| listed.binary_search(primitive).is_err()) {
            Some(primitive) => Err(VerifyError::MissingReference { leaf: number, primitive }),
            None => Ok(triangles.len() as u64),
        }
    }

    fn block(&self, leaf: u32, key: Key, payload: &Payload, b: usize, block: &Block) -> Result<(), VerifyError> {
        for Triangle { primitive, corners } in block.triangles() {
            let needed = box_inside(&self.parts.frame, key, &corners, self.parts.header.padding);
            if !payload.boxed(b).contains(needed) {
                return Err(VerifyError::SmallBox { leaf, primitive });
            }
        }
        Ok(())
    }
}
