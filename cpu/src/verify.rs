//! Checks that decoding cannot afford: every triangle is binned again, and compared with the mesh.

use core::fmt;

use leafwalk_core::layout::{BVH_WIDTH, Block, Child, Key, LatticeBox, Record, Triangle};
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
    /// A leaf whose dilated cell meets a triangle lists nothing that leads to it: rays would miss it.
    MissingReference {
        /// Record number of the leaf.
        leaf: u32,
        /// The triangle.
        primitive: u32,
    },
    /// A triangle's part inside a leaf's cell sticks out of the box by which the leaf leads to it: rays would miss it.
    SmallBox {
        /// Record number of the leaf.
        leaf: u32,
        /// The triangle.
        primitive: u32,
    },
    /// A triangle sticks out of the box of its block in the BVH: rays that descend would miss it.
    SmallBlockBox {
        /// Number of the block.
        block: u32,
        /// The triangle.
        primitive: u32,
    },
    /// Two lanes of blocks hold the same triangle.
    ListedTwice {
        /// The triangle.
        primitive: u32,
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
                write!(
                    f,
                    "in leaf {leaf} triangle {primitive} sticks out of the box that leads to it: build the octree anew"
                )
            }
            Self::SmallBlockBox { block, primitive } => {
                write!(
                    f,
                    "triangle {primitive} sticks out of the box of block {block} in the BVH: build the octree anew"
                )
            }
            Self::ListedTwice { primitive } => {
                write!(f, "triangle {primitive} stands in two lanes of blocks: build the octree anew")
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

fn verify_triangles(parts: &Parts<'_>, listed: &[Listed]) -> Result<Verified, VerifyError> {
    let check = Check { parts, listed, places: Places::new(parts) };
    check.bvh()?;
    let references = check.node(0, (0..listed.len() as u32).collect())?;
    Ok(Verified { triangles: listed.len() as u64, references })
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
    match found.iter().zip(&expected).find(|(found, expected)| found.triangle != **expected) {
        Some((found, expected)) => differs("corners", Some(found.triangle.primitive.min(expected.primitive))),
        None if found.len() != expected.len() => differs("number of triangles listed", None),
        None => verify_triangles(&parts, &found),
    }
}

/// A triangle, and the block that holds it.
#[derive(Clone, Copy)]
struct Listed {
    triangle: Triangle,
    block: u32,
}

/// The triangles of all blocks, by ascending primitive.
fn gather(parts: &Parts<'_>) -> Result<Vec<Listed>, VerifyError> {
    let in_block =
        |(number, block): (u32, Block)| block.triangles().map(move |triangle| Listed { triangle, block: number });
    let mut listed: Vec<Listed> = (0..).zip(parts.blocks.iter()).flat_map(in_block).collect();
    listed.par_sort_unstable_by_key(|listed| listed.triangle.primitive);
    match listed.windows(2).find(|pair| pair[0].triangle.primitive == pair[1].triangle.primitive) {
        Some(pair) => Err(VerifyError::ListedTwice { primitive: pair[0].triangle.primitive }),
        None => Ok(listed),
    }
}

/// Where nodes and blocks lie in the BVH.
struct Places {
    /// Per node, that which leads to it; the root's own for the root.
    parent_of_node: Vec<u32>,
    /// Per block, the node that leads to it, and the box there.
    of_block: Vec<(u32, LatticeBox)>,
}

impl Places {
    fn new(parts: &Parts<'_>) -> Self {
        let mut places = Self {
            parent_of_node: vec![0; parts.bvh.len()],
            of_block: vec![(0, LatticeBox::EMPTY); parts.blocks.len()],
        };
        for (number, node) in (0..).zip(parts.bvh) {
            for (boxed, child) in (0..BVH_WIDTH).map(|slot| node.child(slot)) {
                match child {
                    Child::Node(child) => places.parent_of_node[child as usize] = number,
                    Child::Block(block) => places.of_block[block as usize] = (number, boxed),
                    Child::Vacant => {}
                }
            }
        }
        places
    }

    /// All that leads to a block, itself first.
    fn above(&self, block: u32) -> impl Iterator<Item = Child> {
        let parent = self.of_block[block as usize].0;
        let up = move |node: &u32| (*node > 0).then(|| self.parent_of_node[*node as usize]);
        core::iter::once(Child::Block(block)).chain(core::iter::successors(Some(parent), up).map(Child::Node))
    }
}

struct Check<'a> {
    parts: &'a Parts<'a>,
    listed: &'a [Listed],
    places: Places,
}

impl Check<'_> {
    /// Whether each triangle lies in the box of its block; the decoder has seen that those above hold it.
    fn bvh(&self) -> Result<(), VerifyError> {
        let sticks_out = |&&Listed { triangle, block }: &&Listed| {
            let (node, boxed) = self.places.of_block[block as usize];
            match self.parts.lattices.get(node as usize) {
                Some(lattice) => !triangle.corners.iter().all(|corner| lattice.touches(boxed, *corner)),
                None => {
                    let needed = box_inside(&self.parts.frame, Key::ROOT, &triangle.corners, self.parts.header.padding);
                    !boxed.contains(needed)
                }
            }
        };
        match self.listed.par_iter().find_first(sticks_out) {
            Some(Listed { triangle: Triangle { primitive, .. }, block }) => {
                Err(VerifyError::SmallBlockBox { block: *block, primitive: *primitive })
            }
            None => Ok(()),
        }
    }

    /// Checks a node that these triangles, given by their place in the list, all meet; returns the references below it.
    fn node(&self, number: u32, triangles: Vec<u32>) -> Result<u64, VerifyError> {
        let record = &self.parts.records[number as usize];
        let key = self.parts.key(number);
        if !record.head().is_inner() {
            return self.leaf(number, key, record, &triangles);
        }
        let split = Split::new(&self.parts.frame, key, self.parts.header.padding);
        let met = |&at: &u32| split.children_met(&self.listed[at as usize].triangle.corners);
        let masks: Vec<u8> = triangles.par_iter().map(met).collect();
        let counts = (0..8u32).into_par_iter().map(|child| {
            let met = triangles.iter().zip(&masks).filter(|(_, mask)| **mask >> child & 1 == 1);
            self.node(record.offset + child, met.map(|(at, _)| *at).collect())
        });
        counts.try_reduce(|| 0, |a, b| Ok(a + b))
    }

    /// Checks that a leaf leads to each of the triangles that its cell meets, by a box that holds what lies inside.
    fn leaf(&self, number: u32, key: Key, leaf: &Record, triangles: &[u32]) -> Result<u64, VerifyError> {
        let entries: Vec<_> = self.parts.payload_of(leaf).map_or_else(Vec::new, |payload| {
            (0..BVH_WIDTH).map(|slot| payload.child(slot)).filter(|(_, child)| *child != Child::Vacant).collect()
        });
        for at in triangles {
            let Listed { triangle: Triangle { primitive, corners }, block } = self.listed[*at as usize];
            let above = self.places.above(block);
            let mut leading = above.flat_map(|child| entries.iter().filter(move |entry| entry.1 == child)).peekable();
            if leading.peek().is_none() {
                return Err(VerifyError::MissingReference { leaf: number, primitive });
            }
            let needed = box_inside(&self.parts.frame, key, &corners, self.parts.header.padding);
            if !leading.any(|(boxed, _)| boxed.contains(needed)) {
                return Err(VerifyError::SmallBox { leaf: number, primitive });
            }
        }
        Ok(triangles.len() as u64)
    }
}
