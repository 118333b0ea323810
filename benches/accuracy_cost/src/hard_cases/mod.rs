//! Hard cases: lights, occluders, receivers and numbers at their limits, each with what is expected of every
//! technique, a bound that has a reason, and what was measured.
//!
//! ```text
//!   cases ──► set ──► scene ──► device ──► image ─┐
//!              │                                  ▼
//!              └────► pixels: the exact truth ──► judge ──► rows ──► table
//!                     with outlines moved by             ▲
//!                     what a technique may miss ─────────┘ techniques
//! ```
//! A technique knows an occluder's outline to half a texel or so. So a pixel's visible fraction must lie between the
//! exact ones of the same scene with all outlines moved out, and moved in, by as much; what sampling the light and
//! adding up may make of it comes on top. That is derived for each technique ([`techniques`]), not fitted to what was
//! measured, and it is what a pixel is held to, not a mean alone. Where a technique's model is at its end the case says
//! so, and the row must then be beyond its bound: a fault that was mended shows, too.

pub mod cases;
pub mod judge;
pub mod pixels;
pub mod run;
pub mod set;
pub mod store;
pub mod table;
pub mod techniques;
