//! What can only be said with a device. Every test runs on each adapter of this machine, software or not, or on the one
//! that LEAFWALK_ADAPTER picks. Without any, tests are reported as ignored; with LEAFWALK_REQUIRE_GPU set, they fail.

mod answers;
mod arithmetic;
mod batches;
mod generating;
mod pinhole;
mod scenes;
mod splitting;
mod staying;

use std::process::ExitCode;

use leafwalk_gpu::testing::choices;
use leafwalk_gpu::{AdapterChoice, Gpu};
use libtest_mimic::{Arguments, Failed, Trial};

/// A test, by its name.
type Test = (&'static str, fn(&Gpu));

fn main() -> ExitCode {
    // One after the other: Mesa 22's software adapters compile and close on several threads at their peril.
    let arguments = Arguments { test_threads: Some(1), ..Arguments::from_args() };
    let is_required = std::env::var_os("LEAFWALK_REQUIRE_GPU").is_some();
    let tests: Vec<Test> =
        [answers::TESTS, arithmetic::TESTS, batches::TESTS, generating::TESTS, splitting::TESTS, staying::TESTS]
            .concat();
    let choices = choices();
    let mut trials = Vec::new();
    for (name, test) in tests {
        for choice in &choices {
            let choice = choice.clone();
            trials.push(Trial::test(format!("{name}, on {}", name_of(&choice)), move || {
                let gpu = Gpu::open(&choice).map_err(|error| error.to_string())?;
                test(&gpu);
                Ok(())
            }));
        }
        if choices.is_empty() && is_required {
            trials
                .push(Trial::test(name, || Err(Failed::from("there is no adapter, and LEAFWALK_REQUIRE_GPU is set"))));
        } else if choices.is_empty() {
            let reason = format!("{name}: no adapter (Debian has some in software: apt install mesa-vulkan-drivers)");
            trials.push(Trial::test(reason, || Ok(())).with_ignored_flag(true));
        }
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn name_of(choice: &AdapterChoice) -> String {
    match choice {
        AdapterChoice::Name(name) => name.clone(),
        choice => choice.to_string(),
    }
}

/// Another device on the same adapter.
fn open_again(gpu: &Gpu) -> Gpu {
    Gpu::open(&AdapterChoice::Name(gpu.adapter().to_string())).expect("an adapter that was opened before")
}
