//! Cameras as matrices.

use antumbra::scene::Camera;
use glam::{DMat4, DVec4};

/// The camera of an image. Depth is reversed: 0 is the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World space to clip space.
    pub clip_from_world: DMat4,
}

impl View {
    /// A camera's view on an image of this many pixels.
    pub fn of(camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let clip_from_view = camera.clip_from_view(f64::from(width) / f64::from(height));
        Self { clip_from_world: clip_from_view * camera.world_from_view.inverse() }
    }

    /// Straight down on the ground: pixels are a regular grid over |x|, |z| ≤ `half`, seen from
    /// height `top` and down to `-top`.
    pub fn map_of_ground(half: f64, top: f64) -> Self {
        // x to the right, z down the image, height to reversed depth.
        Self {
            clip_from_world: DMat4::from_cols(
                DVec4::new(1.0 / half, 0.0, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 0.5 / top, 0.0),
                DVec4::new(0.0, 1.0 / half, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 0.5, 1.0),
            ),
        }
    }
}
