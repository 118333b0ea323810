//! How far is each technique from the truth, and what are its own laws?

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod accuracy;
mod audit;
mod audit_shapes;
mod baseline;
mod cut_outs;
mod disc_light;
mod forward;
mod hierarchy;
mod hits;
mod light_texture;
mod line_light;
mod linear_light;
mod linear_samples;
mod normals;
mod occlusion_textures;
mod occlusion_textures_slices;
mod pairs;
mod planner;
mod point_light;
mod polygon_light;
mod ray_march;
mod ray_march_limits;
mod sides;
mod situations;
mod sun;
mod tiles;
mod traced;
mod views;
