//! Traces an octree that is part of the program, as firmware has it in flash: without a file, without a heap, and with
//! no more of leafwalk than the crate `leafwalk-core`, which needs no operating system.
//!
//! `cargo run --release --example embedded`
//!
//! `embedded.lwk` holds a hill, 800 metres wide and deep. In the repository `tests/format/embedded.rs` has the mesh, and
//! checks that the file is what the builder makes of it; `leafwalk build mesh.ply -o mesh.lwk --compact --for-walks`
//! makes a file of a mesh of your own.

use core::error::Error;

use leafwalk_core::{AlignedBytes, Octree, Ray};

static HILL: &AlignedBytes<[u8]> = &AlignedBytes { bytes: *include_bytes!("embedded.lwk") };

/// How high something at this place is above ground; `None` where there is no ground below.
fn altitude(ground: &Octree<&[u32]>, place: [f32; 3]) -> Option<f32> {
    Some(ground.closest_hit(&Ray::new(place, [0.0, -1.0, 0.0]))?.t)
}

fn main() -> Result<(), Box<dyn Error>> {
    // All bytes are checked, once. From then on they are traced as they are.
    let ground = Octree::from_bytes(&HILL.bytes)?;
    println!("{} bytes, {} triangles", HILL.bytes.len(), ground.stats().primitives);

    // A glider crosses the hill and leaves its far side.
    for second in 0..10 {
        let place = [20.0 + 90.0 * second as f32, 400.0 - 6.0 * second as f32, 410.0];
        match altitude(&ground, place) {
            Some(altitude) => println!("after {second} s: {altitude:.1} m above ground"),
            None => println!("after {second} s: no ground below"),
        }
    }
    Ok(())
}
