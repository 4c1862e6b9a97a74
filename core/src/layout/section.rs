//! `Section`: the parts of a file.

/// The sections that this version knows, in file order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Section {
    /// [`crate::wire::Header`].
    Header,
    /// [`super::Record`]s, the root first, then blocks of eight siblings in depth-first order.
    Records,
    /// One [`super::Key`] a record.
    Keys,
    /// What leaves list, leaf after leaf, depth first: [`super::BvhNode`]s whose boxes are cut to the leaf's cell.
    Payloads,
    /// [`super::Block`]s in the order in which the BVH leads to them; empty in a compact octree.
    Blocks,
    /// In a compact octree, [`super::IndexedBlock`]s instead, in the same order.
    IndexedBlocks,
    /// Their vertices in lattice coordinates, three numbers each, in the order in which the blocks first name them.
    Vertices,
    /// [`super::BvhNode`]s: the root, then, depth first, those that each leads to by slot.
    Bvh,
    /// In wide scenes one [`super::Lattice`] a node of the BVH; else empty.
    Lattices,
    /// The entry grid: one record number a grid cell, x fastest.
    Grid,
    /// One material id a triangle; may be empty.
    Materials,
}

impl Section {
    /// All sections, in file order.
    pub const ALL: [Self; 11] = [
        Self::Header,
        Self::Records,
        Self::Keys,
        Self::Payloads,
        Self::Blocks,
        Self::IndexedBlocks,
        Self::Vertices,
        Self::Bvh,
        Self::Lattices,
        Self::Grid,
        Self::Materials,
    ];

    /// The tag that names it in the file: four ASCII characters.
    pub const fn tag(self) -> u32 {
        u32::from_le_bytes(match self {
            Self::Header => *b"head",
            Self::Records => *b"recs",
            Self::Keys => *b"keys",
            Self::Payloads => *b"payl",
            Self::Blocks => *b"blks",
            Self::IndexedBlocks => *b"iblk",
            Self::Vertices => *b"vert",
            Self::Bvh => *b"brch",
            Self::Lattices => *b"latt",
            Self::Grid => *b"grid",
            Self::Materials => *b"mats",
        })
    }

    /// Its name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Header => "header",
            Self::Records => "records",
            Self::Keys => "keys",
            Self::Payloads => "payloads",
            Self::Blocks => "blocks",
            Self::IndexedBlocks => "indexed blocks",
            Self::Vertices => "vertices",
            Self::Bvh => "BVH nodes",
            Self::Lattices => "lattices",
            Self::Grid => "entry grid",
            Self::Materials => "materials",
        }
    }
}
