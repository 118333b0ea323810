//! `--host-barriers`: the engine places the barriers at the node's border itself.
//!
//! With `BorderBarriers::Node` the node does all of this: it was told how each image was last used
//! and how it is used next. An engine whose own render graph owns every barrier asks for
//! `BorderBarriers::Host` instead. The node then records only the barriers between its own passes,
//! and `FramePlan::accesses` says what the engine's graph must know:
//!
//! ```text
//!   the engine's last use ─► barrier ─► entry … the node … exit ─► barrier ─► the engine's next use
//! ```

use crate::device::Gpu;
use crate::resources::{barrier, forget};
use antumbra::graph::Scope;
use antumbra::{Frame, FramePlan, VisibilityImage};
use ash::vk;

/// One image that crosses the border, and its uses on both sides.
struct Crossing {
    image: vk::Image,
    aspect: vk::ImageAspectFlags,
    /// The engine's uses around the node.
    before: Scope,
    after: Scope,
    /// The node's first and last use; none where this frame's plan leaves the image alone.
    node: Option<(Scope, Scope)>,
}

fn crossings(frame: &Frame, plan: &FramePlan, visibility: &VisibilityImage) -> Vec<Crossing> {
    let lent = plan.imports.iter().map(|(id, i)| (*id, i.image, i.before, i.after));
    // The node writes all of its own image: what that held may be forgotten.
    let before = forget(frame.visibility_before);
    let result = (plan.visibility, visibility.image, before, frame.visibility_after);
    lent.chain([result])
        .map(|(id, image, before, after)| {
            let access = plan.accesses().iter().find(|a| a.resource == id);
            let is_depth = plan.plan.graph.resource(id).is_depth();
            Crossing {
                image,
                aspect: if is_depth {
                    vk::ImageAspectFlags::DEPTH
                } else {
                    vk::ImageAspectFlags::COLOR
                },
                before,
                after,
                node: access.map(|a| (a.entry, a.exit)),
            }
        })
        .collect()
}

/// Records `node` between barriers of the engine's own.
pub fn around(
    gpu: &Gpu,
    cmd: vk::CommandBuffer,
    frame: &Frame,
    plan: &FramePlan,
    visibility: &VisibilityImage,
    node: impl FnOnce() -> Result<(), antumbra::Error>,
) -> Result<(), antumbra::Error> {
    let crossings = crossings(frame, plan, visibility);
    for c in &crossings {
        // What the node leaves alone goes straight to its next use.
        let entry = c.node.map_or(c.after, |(entry, _)| entry);
        barrier(gpu, cmd, c.image, c.aspect, c.before, entry);
    }
    node()?;
    for c in &crossings {
        let Some((_, exit)) = c.node else { continue };
        // A read behind a read in one layout and stage has nothing to wait for.
        if exit != c.after {
            barrier(gpu, cmd, c.image, c.aspect, exit, c.after);
        }
    }
    Ok(())
}
