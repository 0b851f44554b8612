//! The elementary functions of the step: one `f32` in, the same bits out on every target.
//!
//! Addition, subtraction, multiplication, division and square root are correctly rounded by IEEE 754 on x86 and on the
//! Cortex-M4 alike, and Rust never contracts them. Everything here is made of these alone.

/// Square root, correctly rounded; NaN below zero.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        vsqrt(x)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        libm::sqrtf(x)
    }
}

/// The FPU's square root: `core` has none, and `libm` computes it in 61 integer instructions.
///
/// `asm!` does not take a float operand on this target in stable Rust; a naked function needs none.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code, reason = "the attribute; the body is one instruction on the argument's own register")]
#[unsafe(naked)]
extern "C" fn vsqrt(x: f32) -> f32 {
    core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
}

/// Sine and cosine of an angle in radians, within 1.1 ulp each for `|x| <= 1000`; NaN for a non-finite angle.
///
/// Argument reduction by multiples of pi/2 held in four parts (Cody and Waite), the first three short enough for their
/// products to be exact, and the rounding error of its last step carried on to the result; then the minimax polynomials of
/// Cephes (`sinf`, `cosf`) on +-pi/4.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    const FRAC_2_PI: f32 = core::f32::consts::FRAC_2_PI;
    // Adding 1.5 * 2^23 leaves no bits after the point: rounds to the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    const PI_2_PARTS: [f32; 4] = [1.570_312_5, 4.837_513e-4, 7.549_533_6e-8, 2.563_344e-12];

    let turns = (x * FRAC_2_PI + ROUND) - ROUND;
    let [a, b, c, d] = PI_2_PARTS;
    // Exact so far; the next difference is rounded, and `tail` is the rest of the argument.
    let coarse = (x - turns * a) - turns * b;
    let fine = turns * c;
    let r = coarse - fine;
    let tail = ((coarse - r) - fine) - turns * d;
    let r2 = r * r;
    let sin = r + (r * r2 * (-1.666_665_5e-1 + r2 * (8.332_161e-3 + r2 * -1.951_529_6e-4)) + tail);
    let cubic = 4.166_664_6e-2 + r2 * (-1.388_731_6e-3 + r2 * 2.443_315_7e-5);
    let cos = 1.0 - (0.5 * r2 - (r2 * r2 * cubic - r * tail));
    match (turns as i32) & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance from the exact value in units of the last place of the f32 result.
    fn ulps(found: f32, exact: f64) -> f64 {
        let spacing =
            f64::from((exact.abs() as f32).max(f32::MIN_POSITIVE)).log2().floor().exp2() * f64::from(f32::EPSILON);
        (f64::from(found) - exact).abs() / spacing
    }

    #[test]
    fn sine_and_cosine_are_accurate_up_to_a_thousand_radians() {
        // Every 997th float (a prime, so all low bits occur), both signs; std's f64 functions err by 1e-16. Over all
        // floats the worst are 1.013 ulp (sine, at 27.446451) and 1.017 ulp (cosine, at 90.33755).
        let mut worst = 0.0_f64;
        for bits in (0..=1000.0_f32.to_bits()).step_by(997) {
            let x = f32::from_bits(bits);
            for x in [x, -x] {
                let (sin, cos) = sin_cos(x);
                worst = worst.max(ulps(sin, f64::from(x).sin())).max(ulps(cos, f64::from(x).cos()));
            }
        }
        assert!(worst <= 1.1, "worst error {worst} ulp");
    }

    #[test]
    fn the_hardest_arguments_are_within_the_bound() {
        for x in [27.446_451_f32, 90.337_55, 581.210_27, 925.167_8] {
            let (sin, cos) = sin_cos(x);
            assert!(ulps(sin, f64::from(x).sin()) <= 1.1 && ulps(cos, f64::from(x).cos()) <= 1.1, "{x}");
        }
    }

    #[test]
    fn sine_is_accurate_next_to_its_zeros() {
        // The floats nearest to multiples of pi/2 lose the most digits in the reduction.
        for k in -636..=636_i32 {
            let x = (f64::from(k) * core::f64::consts::FRAC_PI_2) as f32;
            for x in [x, x.next_up(), x.next_down()] {
                let (sin, cos) = sin_cos(x);
                assert!(ulps(sin, f64::from(x).sin()) <= 1.1, "sin({x})");
                assert!(ulps(cos, f64::from(x).cos()) <= 1.1, "cos({x})");
            }
        }
    }

    #[test]
    fn numbers_that_are_not_finite_stay_so() {
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sin, cos) = sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan());
        }
        assert!(sqrt(-1.0).is_nan());
    }

    #[test]
    fn square_root_is_the_correctly_rounded_one() {
        for bits in (0..f32::INFINITY.to_bits()).step_by(99_991) {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "sqrt({x})");
        }
    }
}
