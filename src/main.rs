//! The command `leafwalk`.
#![forbid(unsafe_code)]

mod camera;
mod command;
mod picture;
mod scene;

fn main() -> std::process::ExitCode {
    command::main()
}
