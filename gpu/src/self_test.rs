//! What a driver makes of arithmetic: asked when a device is opened, so that no promise is made that it breaks.

use core::fmt;

use bytemuck::Zeroable;
use leafwalk_core::lanes::Lanes;

use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::gpu::Gpu;
use crate::kernel::Module;
use crate::shader;
use crate::structure::Setup;

/// Cases a matter.
const CASES: u32 = 1024;
/// Numbers that the kernel gives a case.
pub(crate) const RESULTS: usize = 7;

/// How a driver may depart from arithmetic that rounds once, to nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Matter {
    /// `a * b + c` rounded once instead of twice.
    Contraction,
    /// `(a + b) - b` taken for `a`.
    Reassociation,
    /// Quotients that are not the nearest number.
    Division,
    /// The error term of a product.
    ErrorTerm,
    /// Subnormal results taken for 0. No promise rests on them.
    Subnormals,
}

impl Matter {
    const ALL: [Self; 5] = [Self::Contraction, Self::Reassociation, Self::Division, Self::ErrorTerm, Self::Subnormals];

    /// What it is, in a few words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contraction => "fused products",
            Self::Reassociation => "regrouped sums",
            Self::Division => "rough quotients",
            Self::ErrorTerm => "error terms of products",
            Self::Subnormals => "flushed subnormals",
        }
    }

    /// Where the kernel puts the plain expression and the flavour's.
    const fn results(self) -> [usize; 2] {
        match self {
            Self::Contraction | Self::Subnormals => [0, 3],
            Self::Reassociation => [1, 4],
            Self::Division => [2, 5],
            Self::ErrorTerm => [6, 6],
        }
    }

    fn case(self, at: u32) -> [f32; 3] {
        let [a, b] = [mixed(2 * at), mixed(2 * at + 1)];
        match self {
            // c takes the product away but for what rounding left.
            Self::Contraction | Self::ErrorTerm => [a, b, -(a * b)],
            Self::Reassociation => [a, b * 1000.0, 0.0],
            // Quotients of all sizes and signs.
            Self::Division => [a * 2f32.powi(at as i32 % 90 - 45), if at & 1 == 0 { b } else { -b }, 0.0],
            Self::Subnormals => [a * f32::MIN_POSITIVE, 0.125 * b, 0.0],
        }
    }

    fn expected(self, [a, b, c]: [f32; 3]) -> f32 {
        match self {
            Self::Contraction | Self::Subnormals => a * b + c,
            Self::Reassociation => (a + b) - b,
            Self::Division => a / b,
            Self::ErrorTerm => a.product_error(b, a * b),
        }
    }
}

/// A number in 1..2, all bits of its mantissa at random (Steele et al.'s splitmix, shortened).
fn mixed(seed: u32) -> f32 {
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    f32::from_bits(0x3f80_0000 | (x ^ x >> 16) >> 9)
}

/// How many cases of a matter came out otherwise than on the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What was asked.
    pub matter: Matter,
    /// Differing cases of the plain expression: what this driver does when left alone.
    pub plain: u32,
    /// Differing cases of the flavour's expression, which is what the tracer computes with.
    pub flavoured: u32,
}

/// What a device was found to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelfTest {
    /// One a matter.
    pub findings: Vec<Finding>,
}

/// What can be relied on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// Every case had the CPU's bits, and so have hits.
    Exact,
    /// So many cases differed, and so may hits.
    Differs {
        /// How many.
        cases: u32,
        /// Of how many.
        of: u32,
    },
}

impl SelfTest {
    /// Asks the device, with the arithmetic of a shader made by [`shader::checks`].
    pub(crate) fn run(gpu: &Gpu, checks: &str) -> Result<Self, GpuError> {
        let questions: Vec<[f32; 4]> = Matter::ALL
            .iter()
            .flat_map(|matter| (0..CASES).map(|at| matter.case(at)))
            .map(|[a, b, c]| [a, b, c, 0.0])
            .collect();
        let module = Module::new(gpu, "checks", checks, 0)?;
        let kernel = module.kernel(gpu, "self_test", &[])?;
        let results: Vec<[f32; RESULTS]> =
            run(gpu, &module, &kernel, bytemuck::cast_slice(&questions), questions.len())?;
        let finding = |(matter, results): (&Matter, &[[f32; RESULTS]])| {
            let [plain, flavoured] = matter.results().map(|which| {
                let differs = |(at, result): (u32, &[f32; RESULTS])| {
                    result[which].to_bits() != matter.expected(matter.case(at)).to_bits()
                };
                (0..).zip(results).filter(|case| differs(*case)).count() as u32
            });
            Finding { matter: *matter, plain, flavoured }
        };
        Ok(Self { findings: Matter::ALL.iter().zip(results.chunks(CASES as usize)).map(finding).collect() })
    }

    /// Which promise holds on this device, with the flavour that was asked about.
    pub fn promise(&self) -> Promise {
        let counted = self.findings.iter().filter(|finding| finding.matter != Matter::Subnormals);
        let (cases, of) = counted.fold((0, 0), |(cases, of), finding| (cases + finding.flavoured, of + CASES));
        if cases == 0 { Promise::Exact } else { Promise::Differs { cases, of } }
    }
}

impl fmt::Display for Promise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => write!(f, "exact"),
            Self::Differs { cases, of } => write!(f, "{cases} of {of} cases differ"),
        }
    }
}

impl fmt::Display for SelfTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (of {CASES} cases, plain and guarded:", self.promise())?;
        for (i, finding) in self.findings.iter().enumerate() {
            let separator = if i == 0 { "" } else { "," };
            write!(f, "{separator} {} {} {}", finding.matter.name(), finding.plain, finding.flavoured)?;
        }
        write!(f, ")")
    }
}

/// Every entry of the tables as the device reads them: exit faces, then sub-faces.
pub(crate) fn table_entries(gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
    const ENTRIES: usize = (8 + 6) * 8;
    let module = Module::new(gpu, "checks", &shader::checks(Flavour::Exact), 0)?;
    let kernel = module.kernel(gpu, "table_entries", &[])?;
    run(gpu, &module, &kernel, &[0; 16], ENTRIES)
}

/// Runs a kernel that reads one buffer and writes `count` answers into another.
fn run<A: bytemuck::Pod>(
    gpu: &Gpu,
    module: &Module,
    kernel: &crate::kernel::Kernel,
    input: &[u8],
    count: usize,
) -> Result<Vec<A>, GpuError> {
    use wgpu::BufferUsages as Usage;
    let bytes = count * size_of::<A>();
    let setup = Setup::zeroed().upload(gpu)?;
    let questions = gpu.filled("questions", input, Usage::STORAGE)?;
    let results = gpu.buffer("results", bytes, Usage::STORAGE | Usage::COPY_SRC)?;
    let groups = [
        module.bind(gpu, 0, &[(&setup, size_of::<Setup>())]),
        module.bind(gpu, 1, &[(&questions, input.len()), (&results, bytes)]),
    ];
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    kernel.record(&mut encoder, [&groups[0], &groups[1]], count, None);
    gpu.queue.submit([encoder.finish()]);
    gpu.copied(&results, count)
}
