//! No structure at all.

use leafwalk::structures::Every;

use crate::comparison::compare;

#[test]
fn every_triangle() {
    compare::<Every>("every triangle", &());
}
