//! One value an axis, without a function in between.
//!
//! `core::array`'s functions take closures, and a closure is compiled without the target features of the kernel that it
//! ends up in: lanes would leave their registers at each of them.

/// The values of an expression for 0, 1 and 2: `per_axis!(k => a[k] - b[k])`.
#[doc(hidden)]
#[macro_export]
macro_rules! per_axis {
    ($k:ident => $value:expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
            {
                let $k = 2;
                $value
            },
        ]
    };
}
