//! A number of each plant in a register of the vector unit: sums, products, choices and roots, lane by lane; no
//! multiply-add is fused.

use pulp::Simd;

/// Plants side by side.
pub(in crate::plant) const LANES: usize = 4;

/// A number of each plant.
pub(super) type Row = [f64; LANES];

/// A row in a register.
#[inline(always)]
pub(super) fn loaded<S: Simd>(simd: S, row: &Row, part: usize) -> Number<S> {
    Number(simd, S::as_simd_f64s(row).0[part])
}

/// A number of each plant in a register.
#[derive(Clone, Copy)]
pub(super) struct Number<S: Simd>(pub(super) S, pub(super) S::f64s);

macro_rules! operator {
    ($Trait: ident, $method: ident, $own: ident) => {
        impl<S: Simd> std::ops::$Trait for Number<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.$own(self.1, other.1))
            }
        }
    };
}
operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Number<S> {
    #[inline(always)]
    pub(super) fn of(self, value: f64) -> Self {
        Self(self.0, self.0.splat_f64s(value))
    }

    /// One of two, by whether this is more than another.
    #[inline(always)]
    pub(super) fn more_than(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(self.0, self.0.select_f64s(self.0.greater_than_f64s(self.1, other.1), then.1, otherwise.1))
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.more_than(other, self, other)
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.more_than(other, other, self)
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_f64s(self.1))
    }
}
