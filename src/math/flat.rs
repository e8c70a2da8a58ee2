//! Values that are numbers in a row, seen as such.

use super::{M3, Real, S3, V3};

/// Numbers in a row.
///
/// # Safety
/// The type is repr(C), and has nothing but values of type T, in itself or in types for which the same holds.
pub unsafe trait Flat<T>: Sized {
    /// All numbers of a list.
    #[inline(always)]
    fn flat(list: &[Self]) -> &[T] {
        let count = size_of_val(list) / size_of::<T>();
        // SAFETY: an implementor is numbers in a row, and so are many.
        unsafe { std::slice::from_raw_parts(list.as_ptr().cast(), count) }
    }

    /// The same, to write.
    #[inline(always)]
    fn flat_mut(list: &mut [Self]) -> &mut [T] {
        let count = size_of_val(list) / size_of::<T>();
        // SAFETY: as above, and the borrow is exclusive.
        unsafe { std::slice::from_raw_parts_mut(list.as_mut_ptr().cast(), count) }
    }

    /// All numbers of one.
    #[inline(always)]
    fn numbers_of(&self) -> &[T] {
        Self::flat(std::slice::from_ref(self))
    }

    /// The same, to write.
    #[inline(always)]
    fn numbers_of_mut(&mut self) -> &mut [T] {
        Self::flat_mut(std::slice::from_mut(self))
    }
}

// SAFETY: repr(C), of values of type T.
unsafe impl<T: Real> Flat<T> for V3<T> {}
// SAFETY: the same.
unsafe impl<T: Real> Flat<T> for S3<T> {}
// SAFETY: repr(C), of V3.
unsafe impl<T: Real> Flat<T> for M3<T> {}
