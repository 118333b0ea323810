//! Eight f32 numbers at once: AVX2 where the processor has it, arrays elsewhere.

/// Eight numbers. Masks have bit i for the i-th.
pub(super) trait Lanes: Copy {
    fn splat(x: f32) -> Self;
    fn load(x: &[f32; 8]) -> Self;
    fn store(self) -> [f32; 8];
    fn add(self, b: Self) -> Self;
    fn sub(self, b: Self) -> Self;
    fn mul(self, b: Self) -> Self;
    fn div(self, b: Self) -> Self;
    /// `self` × b + c.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self` × b − c.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// The smaller of both; b where either is not a number.
    fn min(self, b: Self) -> Self;
    /// The larger of both; b where either is not a number.
    fn max(self, b: Self) -> Self;
    fn abs(self) -> Self;
    /// `self`, with its sign turned where b is negative.
    fn flip(self, b: Self) -> Self;
    /// Where `self` is at most b.
    fn le(self, b: Self) -> u32;
}

/// Eight numbers in a register of AVX2's, for processors that have AVX2 and FMA: no other may make one.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Avx2(std::arch::x86_64::__m256);

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Avx2, Lanes};
    use std::arch::x86_64::*;

    /// A method of one instruction.
    macro_rules! instruction {
        ($name:ident, ($self:ident $(, $b:ident)*) -> $out:ty, $e:expr) => {
            #[inline(always)]
            fn $name($self $(, $b: Self)*) -> $out {
                // SAFETY: there is a value, so that the processor has AVX2 and FMA.
                unsafe { $e }
            }
        };
    }

    impl Lanes for Avx2 {
        #[inline(always)]
        fn splat(x: f32) -> Self {
            // SAFETY: these lanes are chosen where the processor has AVX2.
            Self(unsafe { _mm256_set1_ps(x) })
        }

        #[inline(always)]
        fn load(x: &[f32; 8]) -> Self {
            // SAFETY: the eight numbers are there and need no alignment; these lanes are chosen where there is AVX2.
            Self(unsafe { _mm256_loadu_ps(x.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> [f32; 8] {
            let mut to = [0.0; 8];
            // SAFETY: there is room for eight numbers, without alignment; there is a value, so there is AVX2.
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) };
            to
        }

        instruction!(add, (self, b) -> Self, Self(_mm256_add_ps(self.0, b.0)));
        instruction!(sub, (self, b) -> Self, Self(_mm256_sub_ps(self.0, b.0)));
        instruction!(mul, (self, b) -> Self, Self(_mm256_mul_ps(self.0, b.0)));
        instruction!(div, (self, b) -> Self, Self(_mm256_div_ps(self.0, b.0)));
        instruction!(mul_add, (self, b, c) -> Self, Self(_mm256_fmadd_ps(self.0, b.0, c.0)));
        instruction!(mul_sub, (self, b, c) -> Self, Self(_mm256_fmsub_ps(self.0, b.0, c.0)));
        instruction!(min, (self, b) -> Self, Self(_mm256_min_ps(self.0, b.0)));
        instruction!(max, (self, b) -> Self, Self(_mm256_max_ps(self.0, b.0)));
        instruction!(abs, (self) -> Self, Self(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)));
        instruction!(flip, (self, b) -> Self, {
            Self(_mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), b.0)))
        });
        instruction!(le, (self, b) -> u32, {
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0)).cast_unsigned()
        });
    }
}

/// Eight numbers in an array, which compilers make registers of any processor's.
#[derive(Clone, Copy)]
pub(super) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = [0.0; 8];
        for (out, (a, b)) in out.iter_mut().zip(self.0.iter().zip(&b.0)) {
            *out = f(*a, *b);
        }
        Self(out)
    }
}

impl Lanes for Portable {
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }

    #[inline(always)]
    fn load(x: &[f32; 8]) -> Self {
        Self(*x)
    }

    #[inline(always)]
    fn store(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }

    /// Rounded twice: where the processor has no such instruction, a fused one is a call of the library's.
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul(b).sub(c)
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        self.zip(b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.zip(b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn flip(self, b: Self) -> Self {
        self.zip(b, |a, b| f32::from_bits(a.to_bits() ^ (b.to_bits() & (1 << 31))))
    }

    #[inline(always)]
    fn le(self, b: Self) -> u32 {
        let pairs = self.0.iter().zip(&b.0).enumerate();
        pairs.fold(0, |mask, (i, (a, b))| mask | (u32::from(a <= b) << i))
    }
}

/// Three coordinates of eight points.
pub(super) type Triple<V> = [V; 3];

#[inline(always)]
pub(super) fn splat<V: Lanes>(a: glam::Vec3) -> Triple<V> {
    [V::splat(a.x), V::splat(a.y), V::splat(a.z)]
}

#[inline(always)]
pub(super) fn load<V: Lanes>(a: &[[f32; 8]; 3]) -> Triple<V> {
    [V::load(&a[0]), V::load(&a[1]), V::load(&a[2])]
}

#[inline(always)]
pub(super) fn sub<V: Lanes>(a: Triple<V>, b: Triple<V>) -> Triple<V> {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

#[inline(always)]
pub(super) fn dot<V: Lanes>(a: Triple<V>, b: Triple<V>) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

#[inline(always)]
pub(super) fn flip<V: Lanes>(a: Triple<V>, b: V) -> Triple<V> {
    [a[0].flip(b), a[1].flip(b), a[2].flip(b)]
}

#[inline(always)]
pub(super) fn cross<V: Lanes>(a: Triple<V>, b: Triple<V>) -> Triple<V> {
    [
        a[1].mul_sub(b[2], a[2].mul(b[1])),
        a[2].mul_sub(b[0], a[0].mul(b[2])),
        a[0].mul_sub(b[1], a[1].mul(b[0])),
    ]
}
