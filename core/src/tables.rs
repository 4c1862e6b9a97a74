//! The exit-face and sub-face tables of Portalez & Duguet ("Lancer de rayon dans un octree", eq. 8 and 9), made from
//! the convention instead of copied: face = 2 * axis + positive, `neg` bit k = direction k below zero,
//! `index` bit k = component k of (P - origin) x direction below zero.

/// Stands where no ray can come by in exact arithmetic.
pub const UNREACHABLE: u8 = 7;

/// Flips of the sign pattern that turn it into three comparisons of exit distances (one bit an axis).
pub const fn mask(neg: u32) -> u32 {
    let (x, y, z) = (neg & 1, neg >> 1 & 1, neg >> 2 & 1);
    (y ^ z) | (z ^ x) << 1 | (x ^ y) << 2
}

/// Exit axis, two bits an entry, by `index ^ mask(neg)`: bit 0 says t_y < t_z, bit 1 t_z < t_x, bit 2 t_x < t_y.
///
/// Patterns 0 and 7 are cyclic, so only rounding brings them about; any axis serves there, since every forward step
/// makes progress: z for 0, y for 7.
pub const EXIT_AXIS: u32 = {
    const AXES: [u32; 8] = [2, 1, 2, 1, 0, 0, 2, 1];
    let (mut packed, mut c) = (0, 0);
    while c < 8 {
        packed |= AXES[c] << (2 * c);
        c += 1;
    }
    packed
};

/// Exit face of a ray of octant `neg` whose three signs are `index`, or [`UNREACHABLE`].
pub const fn exit_face(neg: u32, index: u32) -> u8 {
    let c = index ^ mask(neg);
    if c == 0 || c == 7 {
        return UNREACHABLE;
    }
    let axis = EXIT_AXIS >> (2 * c) & 3;
    (2 * axis + (1 - (neg >> axis & 1))) as u8
}

/// Sub-face through which a ray leaves by `face`, from the three signs `index` taken at the centre of the face:
/// high_u + 2 * high_v, u < v the two other axes.
pub const fn sub_face(face: u32, index: u32) -> u8 {
    let axis = face >> 1;
    let positive = face & 1;
    let (next, after) = ((axis + 1) % 3, (axis + 2) % 3);
    let high_next = index >> after & 1 ^ positive;
    let high_after = index >> next & 1 ^ positive ^ 1;
    // The axis after the exit axis is u, but for y, whose next axis is z.
    (if next < after { high_next | high_after << 1 } else { high_after | high_next << 1 }) as u8
}

/// The corner of the cell where the exit faces of octant `neg` meet (bit k: upper side).
pub const fn exit_corner(neg: u32) -> u32 {
    !neg & 7
}

/// [`exit_face`] as a table: row `neg`, column `index`.
pub const EXIT_FACE: [[u8; 8]; 8] = {
    let mut table = [[0; 8]; 8];
    let mut at = 0;
    while at < 64 {
        table[at >> 3][at & 7] = exit_face(at as u32 >> 3, at as u32 & 7);
        at += 1;
    }
    table
};

/// [`sub_face`] as a table: row `face`, column `index`.
pub const SUB_FACE: [[u8; 8]; 6] = {
    let mut table = [[0; 8]; 6];
    let mut at = 0;
    while at < 48 {
        table[at >> 3][at & 7] = sub_face(at as u32 >> 3, at as u32 & 7);
        at += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER_EXIT: [[u8; 8]; 8] = [
        [7, 2, 5, 2, 3, 3, 5, 7],
        [5, 7, 1, 1, 5, 2, 7, 2],
        [3, 3, 7, 5, 0, 7, 0, 5],
        [0, 5, 0, 7, 7, 5, 1, 1],
        [2, 4, 2, 7, 7, 4, 3, 3],
        [1, 1, 7, 4, 2, 7, 2, 4],
        [4, 7, 3, 3, 4, 0, 7, 0],
        [7, 0, 4, 0, 1, 1, 4, 7],
    ];
    const PAPER_SUB: [[u8; 8]; 6] = [
        [1, 3, 1, 3, 0, 2, 0, 2],
        [2, 2, 0, 0, 3, 3, 1, 1],
        [2, 0, 2, 0, 3, 1, 3, 1],
        [1, 1, 3, 3, 0, 0, 2, 2],
        [2, 0, 3, 1, 2, 0, 3, 1],
        [1, 3, 0, 2, 1, 3, 0, 2],
    ];
    /// The paper's faces are -y, -x, +y, +x, -z, +z.
    const CANONICAL_OF_PAPER: [usize; 6] = [2, 0, 3, 1, 4, 5];

    #[test]
    fn every_printed_entry_is_generated() {
        for neg in 0..8 {
            for index in 0..8 {
                let face = match PAPER_EXIT[neg][index] {
                    UNREACHABLE => UNREACHABLE,
                    face => CANONICAL_OF_PAPER[face as usize] as u8,
                };
                assert_eq!(EXIT_FACE[neg][index], face, "row {neg}, column {index}");
            }
        }
        for (paper, canonical) in CANONICAL_OF_PAPER.into_iter().enumerate() {
            assert_eq!(SUB_FACE[canonical], PAPER_SUB[paper], "face {canonical}");
        }
    }

    /// Integer rays from a point inside the cube 0..N, N even: the exit is the plane of smallest distance, compared
    /// as fractions, and the sub-face is the half of the face that holds the exit point.
    #[test]
    fn exact_integer_rays_leave_by_the_tabled_face_and_quadrant() {
        const N: i64 = 12;
        let mut seen = [[false; 8]; 8];
        let directions = [-7i64, -3, -2, -1, 1, 2, 5];
        let points = [1i64, 2, 5, 6, 7, 11];
        for d in cube(&directions) {
            for o in cube(&points) {
                let neg = (0..3).fold(0, |bits, k| bits | usize::from(d[k] < 0) << k);
                let exit = core::array::from_fn(|k| if d[k] < 0 { 0 } else { N });
                // t_k = n_k / |d_k|: compare by cross products, all exact.
                let n: [i64; 3] = core::array::from_fn(|k| (exit[k] - o[k]).abs());
                let before = |a: usize, b: usize| n[a] * d[b].abs() < n[b] * d[a].abs();
                let Some(axis) = (0..3).find(|&a| (0..3).all(|b| b == a || before(a, b))) else { continue };
                let index = signs(exit, o, d);
                seen[neg][index] = true;
                let face = 2 * axis + usize::from(d[axis] > 0);
                assert_eq!(EXIT_FACE[neg][index] as usize, face, "o {o:?} d {d:?}");

                let mut centre = [N / 2; 3];
                centre[axis] = exit[axis];
                // Exit point times |d_axis|, against the centre times |d_axis|.
                let high = |k: usize| (o[k] * d[axis].abs() + d[k] * n[axis]) - centre[k] * d[axis].abs();
                let (u, v) = (usize::from(axis == 0), if axis == 2 { 1 } else { 2 });
                if high(u) != 0 && high(v) != 0 {
                    let expected = usize::from(high(u) > 0) + 2 * usize::from(high(v) > 0);
                    assert_eq!(SUB_FACE[face][signs(centre, o, d)] as usize, expected, "o {o:?} d {d:?}");
                }
            }
        }
        for neg in 0..8 {
            for index in 0..8 {
                assert_eq!(seen[neg][index], EXIT_FACE[neg][index] != UNREACHABLE, "row {neg}, column {index}");
            }
        }
    }

    fn signs(p: [i64; 3], o: [i64; 3], d: [i64; 3]) -> usize {
        let w: [i64; 3] = core::array::from_fn(|k| p[k] - o[k]);
        (0..3).fold(0, |bits, k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            bits | usize::from(w[a] * d[b] - w[b] * d[a] < 0) << k
        })
    }

    fn cube(values: &[i64]) -> impl Iterator<Item = [i64; 3]> + '_ {
        let n = values.len();
        (0..n * n * n).map(move |i| [values[i % n], values[i / n % n], values[i / n / n]])
    }
}
