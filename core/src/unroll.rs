//! `unroll!`: one value for each of a few numbers, without a function in between.
//!
//! `core::array`'s functions take closures, and a closure is compiled without the target features of the kernel that it
//! ends up in: lanes would leave their registers at each of them. A loop over an array of lanes has its own price: the
//! array goes through memory. For the same reason, everything that kernels call is `#[inline(always)]`.

/// An array of the values of an expression for the numbers of a range: `unroll!(k in 0..3 => a[k] - b[k])`.
///
/// The ranges are `0..3` (axes, corners) and `0..8` (lanes, packets).
#[doc(hidden)]
#[macro_export]
macro_rules! unroll {
    ($k:ident in 0..3 => $value:expr) => {
        $crate::unroll!($k in [0 1 2] => $value)
    };
    ($k:ident in 0..8 => $value:expr) => {
        $crate::unroll!($k in [0 1 2 3 4 5 6 7] => $value)
    };
    ($k:ident in [$($number:literal)*] => $value:expr) => {
        [$({
            let $k = $number;
            $value
        }),*]
    };
}
