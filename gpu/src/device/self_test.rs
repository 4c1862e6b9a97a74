//! `SelfTest`: what a driver makes of the shader's arithmetic, tried whenever a tracer is made, so that no tracer promises
//! what its driver breaks.

use core::fmt;

use super::departure::{CASES, Departure};
use super::error::DeviceError;
use super::gpu::Gpu;
use super::map_kernel::MapKernel;
use crate::flavour::Flavour;
use crate::shader::{self, RESULTS};

/// How many cases of a departure came out otherwise than on the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DepartureCount {
    /// What the cases try.
    pub departure: Departure,
    /// Cases that differ where the driver is left alone with a plain expression.
    pub plain: u32,
    /// Cases that differ with the flavour's expression, which is what the tracer computes with.
    pub flavoured: u32,
}

/// What a device was found to do with the arithmetic of a flavour.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelfTest {
    /// One count a departure.
    pub counts: Vec<DepartureCount>,
}

/// Whether the hits of a tracer have the bits of the CPU's hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Exactness {
    /// Every case of the self-test had the CPU's bits, and so have all hits.
    Exact,
    /// Some cases of the self-test had other bits, and so may some hits.
    Inexact {
        /// How many cases differed.
        differing: u32,
        /// How many cases were tried.
        of: u32,
    },
}

impl SelfTest {
    /// Tries a flavour's arithmetic on a device.
    ///
    /// # Errors
    /// When the device fails.
    pub fn of(gpu: &Gpu, flavour: Flavour) -> Result<Self, DeviceError> {
        Self::of_text(gpu, &shader::checks(flavour.into()))
    }

    /// Tries the arithmetic of a text like those that [`shader::checks`] makes.
    pub(crate) fn of_text(gpu: &Gpu, checks: &str) -> Result<Self, DeviceError> {
        let questions: Vec<[f32; 4]> = Departure::ALL
            .iter()
            .flat_map(|departure| (0..CASES).map(|at| departure.case(at)))
            .map(|[a, b, c]| [a, b, c, 0.0])
            .collect();
        let kernel = MapKernel::compile(gpu, checks, "self_test")?;
        let shape = (questions.len(), size_of::<[f32; RESULTS]>());
        let results = kernel.run(gpu, bytemuck::cast_slice(&questions), 0, shape)?;
        let results: Vec<[f32; RESULTS]> = gpu.copied(&results, questions.len())?;
        let count = |(departure, results): (Departure, &[[f32; RESULTS]])| {
            let [plain, flavoured] = departure.results().map(|which| {
                let differs = |(at, result): (u32, &[f32; RESULTS])| {
                    result[which].to_bits() != departure.expected(departure.case(at)).to_bits()
                };
                (0..).zip(results).filter(|case| differs(*case)).count() as u32
            });
            DepartureCount { departure, plain, flavoured }
        };
        Ok(Self { counts: Departure::ALL.into_iter().zip(results.chunks(CASES as usize)).map(count).collect() })
    }

    /// Whether hits have the CPU's bits on this device, with the flavour that was tried.
    pub fn exactness(&self) -> Exactness {
        let counted = self.counts.iter().filter(|count| count.departure.matters());
        let (differing, of) = counted.fold((0, 0), |(differing, of), count| (differing + count.flavoured, of + CASES));
        if differing == 0 { Exactness::Exact } else { Exactness::Inexact { differing, of } }
    }
}

impl fmt::Display for Exactness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => write!(f, "exact"),
            Self::Inexact { differing, of } => write!(f, "{differing} of {of} cases differ"),
        }
    }
}

impl fmt::Display for SelfTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (of {CASES} cases, plain and flavoured:", self.exactness())?;
        for (i, count) in self.counts.iter().enumerate() {
            let separator = if i == 0 { "" } else { "," };
            write!(f, "{separator} {} {} {}", count.departure.name(), count.plain, count.flavoured)?;
        }
        write!(f, ")")
    }
}
