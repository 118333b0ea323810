//! The families of AMD GPUs that RADV compiles for without one.

/// A family, by one of its GPUs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// RADV's name of the GPU, as in `RADV_FORCE_FAMILY`.
    pub name: &'static str,
    /// The architecture.
    pub architecture: &'static str,
    /// The most waves that a SIMD holds at once.
    pub waves: u64,
    /// The number of SIMDs of the GPU.
    pub simds: u64,
}

/// The families of the table, the gate's own first.
pub const FAMILIES: [Family; 3] = [
    Family { name: "navi21", architecture: "RDNA2", waves: 16, simds: 160 },
    Family { name: "gfx1100", architecture: "RDNA3", waves: 16, simds: 192 },
    Family { name: "vega10", architecture: "GCN5", waves: 10, simds: 256 },
];
