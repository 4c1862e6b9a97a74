//! Maps an octree's file into memory and traces it from several threads, where it lies: nothing is read twice, nothing
//! copied, and processes that map the same file share its memory. Writes `mapped_file.lwk` into the current folder.
//!
//! `cargo run --release --example mapped_file -- mesh.ply`

mod mesh;

use core::error::Error;
use core::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::fs::File;
use std::thread;

use glam::{DVec3, Vec3};
use leafwalk::{Builder, CpuTracer, Octree, Ray, save_octree};
use memmap2::Mmap;

const PATH: &str = "mapped_file.lwk";
/// A square of rays, straight down.
const SIDE: usize = 512;

fn main() -> Result<(), Box<dyn Error>> {
    save_octree(&Builder::new().build(&mesh::from_arguments()?)?, PATH)?;

    let file = File::open(PATH)?;
    // SAFETY: nobody changes the file while it is mapped. `save_octree` does not: it replaces a file as a whole, and the
    // one that is mapped stays as it was.
    #[expect(unsafe_code, reason = "the file belongs to this program, but the compiler cannot know")]
    let bytes = unsafe { Mmap::map(&file)? };

    // All bytes are checked, once, and then are the octree.
    let octree = Octree::from_bytes(&bytes)?;
    let bounds = octree.bounds();
    let tracer = CpuTracer::new(octree);
    println!("{PATH}: {} bytes mapped", bytes.len());

    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let size = upper - lower;
    let height_at = |row: usize, column: usize| {
        let [x, z] = [column, row].map(|place| (place as f32 + 0.5) / SIDE as f32);
        let ray = Ray::new(lower + size * Vec3::new(x, 2.0, z), Vec3::NEG_Y);
        tracer.closest_hit(&ray).map(|hit| ray.origin[1] - hit.t)
    };

    // The threads share the tracer, since tracing changes nothing; each takes another row of rays when it is done with one.
    let next_row = AtomicUsize::new(0);
    let measure = || {
        let (mut rows, mut hits, mut highest) = (0, 0, lower.y);
        loop {
            let row = next_row.fetch_add(1, Relaxed);
            if row >= SIDE {
                return (rows, hits, highest);
            }
            for height in (0..SIDE).filter_map(|column| height_at(row, column)) {
                (hits, highest) = (hits + 1, highest.max(height));
            }
            rows += 1;
        }
    };
    let threads = thread::available_parallelism()?.get();
    thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(measure)).collect();
        for (number, thread) in running.into_iter().enumerate() {
            let (rows, hits, highest) = thread.join().expect("the thread does not panic");
            println!("thread {number}: {rows} rows, {hits} of {} rays hit, the highest at {highest}", rows * SIDE);
        }
    });
    Ok(())
}
