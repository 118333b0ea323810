//! Random test inputs: a generator of their own, so that no test shares numbers with the tracer.

use glam::DVec3;

/// Marsaglia's xorshift64* (2003), from a fixed seed.
pub struct Random(pub u64);

impl Random {
    /// Uniform in `low..high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        low + (high - low) * bits as f64 / (1_u64 << 53) as f64
    }

    /// A random point with each coordinate uniform in −size..size.
    pub fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.within(-size, size)))
    }

    /// A unit vector and two more that are perpendicular to it and to each other.
    pub fn frame(&mut self) -> [DVec3; 3] {
        let [z, x] = [(); 2].map(|()| self.vector(1.0));
        let z = z.normalize_or(DVec3::Z);
        let x = x.reject_from(z).normalize_or(z.any_orthonormal_vector());
        [x, z.cross(x), z]
    }
}
