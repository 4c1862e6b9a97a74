//! Commands that are stopped in the middle.

use core::time::Duration;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command};
use std::thread::sleep;

use super::*;

const MOMENT: Duration = Duration::from_millis(1);

fn interrupt(child: Child) -> Outcome {
    let kill = Command::new("kill").arg("-INT").arg(child.id().to_string()).status();
    assert!(kill.expect("the command `kill`").success());
    Outcome::of(child.wait_with_output().expect("it ends"))
}

#[test]
fn a_long_build_stops_and_leaves_nothing() {
    let shell = shell();
    // The last face is warned of when the mesh has been read.
    shell.write("soup.obj", obj(&soup(200_000, 7)) + "f 1 2\n");
    let mut child = shell.command("build soup.obj -o soup.lwk --threads 1 --budget 1000").spawn().expect("a start");
    let mut warning = String::new();
    let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
    stderr.read_line(&mut warning).expect("a line");
    assert!(warning.contains("1 faces"), "{warning}");
    sleep(200 * MOMENT);
    interrupt(child).assert_code(130);
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).expect("text");
    assert_eq!(rest, "error: cancelled\n");
    assert_eq!(shell.names(), ["soup.obj"]);
}

/// Two million rays without a direction: they are traced in no time, and take a while to write.
#[test]
fn a_long_write_stops_and_leaves_nothing() {
    const RAYS: u64 = 2_000_000;
    let shell = with_octree();
    let mut header = npy_header(&format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({RAYS}, 6), }}"));
    let length = header.len() as u64 + RAYS * 24;
    shell.write("zeros.npy", core::mem::take(&mut header));
    let file = std::fs::File::options().write(true).open(shell.path("zeros.npy")).expect("a file of ours");
    file.set_len(length).expect("room for a sparse file");
    shell.write("hits.csv", "as before");
    let before = shell.names();
    let is_writing = || {
        let unfinished = shell.names().into_iter().find(|name| name.starts_with(".leafwalk-"));
        unfinished.is_some_and(|name| shell.path(&name).metadata().is_ok_and(|metadata| metadata.len() > 0))
    };
    // On a busy machine the write may be over before the signal arrives.
    for _ in 0..20 {
        let mut child = shell.command("trace sphere.lwk zeros.npy -o hits.csv").spawn().expect("a start");
        while !is_writing() && child.try_wait().expect("a child").is_none() {
            sleep(MOMENT);
        }
        let outcome = interrupt(child);
        assert_eq!(shell.names(), before);
        let is_whole = outcome.code == Some(0);
        if !is_whole {
            outcome.assert_code(130);
        }
        let hits = shell.read("hits.csv");
        if !is_whole && hits == b"as before" {
            return;
        }
        // The file may be in its place, and whole, when the signal comes just before the end.
        let lines = hits.iter().filter(|byte| **byte == b'\n').count() as u64;
        assert!(lines == RAYS + 1, "{lines} lines of hits for {RAYS} rays");
        shell.write("hits.csv", "as before");
    }
    panic!("no write was long enough to be interrupted");
}

fn npy_header(text: &str) -> Vec<u8> {
    [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes()].concat()
}
