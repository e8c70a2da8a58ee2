//! One function, compiled twice: for every machine, and with the wider registers of those that have them.

/// Calls `$plain`, or on a machine with AVX2 `$wide` in a function compiled for it; both are the same operations, `inline(always)`, so
/// the bits are the same. Each argument is named and typed: `(this: &Rows = self, n: usize = n)`.
macro_rules! wide {
    ($plain:expr, $wide:expr, ($($name:ident: $type:ty = $argument:expr),+) $(-> $out:ty)?) => {{
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2,fma")]
            fn wide($($name: $type),+) $(-> $out)? {
                $wide($($name),+)
            }
            if $crate::math::X4::<false>::is_available() {
                // SAFETY: the machine has just been asked for both features.
                return unsafe { wide($($argument),+) };
            }
        }
        $plain($($argument),+)
    }};
}

pub(crate) use wide;
