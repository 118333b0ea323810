//! The techniques, one room each: from a frame's views to the visible fraction.

pub mod back_projection;
pub mod common;
pub mod hard;
pub mod linear_light;
pub mod many_lights;
pub mod occlusion_textures;
pub mod pcss;
pub mod ray_march;
pub mod room;
pub mod soft_shadow_map;
pub mod traced;
