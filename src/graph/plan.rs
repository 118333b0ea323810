//! From a graph to what one frame records.

use super::{Access, Barrier, Graph, Need, Owner, ResourceId, Scope, State};
use crate::Error;
use ash::vk;

/// How the host left an imported or exported resource, and how it wants it back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// The resource.
    pub resource: ResourceId,
    /// The host's last use before the node.
    pub before: Scope,
    /// The host's first use after the node.
    pub after: Scope,
}

/// How the node touches one of the host's resources, for hosts that place barriers themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryUse {
    /// The resource.
    pub resource: ResourceId,
    /// Its name in the graph.
    pub name: &'static str,
    /// Stages and accesses of the node's first use (of all its uses, where it only reads), and the
    /// layout it must be in by then.
    pub entry: Scope,
    /// Who touched it last behind the node's commands, and the layout it is left in: the node's own
    /// last uses, or, where the node places the barriers at the border, what it was handed over to.
    pub exit: Scope,
    /// Whether the node writes it.
    pub writes: bool,
}

/// A barrier and the resource it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResourceBarrier {
    /// The resource.
    pub resource: ResourceId,
    /// The dependency.
    pub barrier: Barrier,
}

/// A row that runs, behind the barriers it needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The row's place in [`Graph::passes`].
    pub pass: usize,
    /// No earlier step is of its kind: later ones find their descriptors written.
    pub first: bool,
    /// What must happen first.
    pub barriers: Vec<ResourceBarrier>,
}

/// A row that does not run, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The row's place in [`Graph::passes`].
    pub pass: usize,
    /// Why it was left out.
    pub why: String,
}

/// What one frame does: the rows that run, in order, with their barriers.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The graph with this frame's push constants and grids.
    pub graph: Graph,
    /// The rows that run.
    pub steps: Vec<Step>,
    /// Barriers behind the last row, which hand the host's resources back.
    pub handover: Vec<ResourceBarrier>,
    /// The rows that do not run.
    pub skipped: Vec<Skipped>,
    /// How the host's resources are touched.
    pub boundary: Vec<BoundaryUse>,
}

/// Drops rows that are not needed or whose output nobody reads, and derives the barriers.
///
/// `borders` says how the host leaves and takes back its resources; with `place_borders` the plan
/// holds the barriers at the border too, without it the host places them from [`Plan::boundary`].
///
/// # Errors
/// [`Error::Frame`] where a row reads what none has written, touches one resource twice, or does other
/// work than an earlier one of its name, or where a resource of the host's has no border.
pub fn compile(graph: Graph, borders: &[Border], place_borders: bool) -> Result<Plan, Error> {
    if let Some(pass) = graph.mismatched_row() {
        return Err(Error::Frame(format!(
            "{}: rows of one name must touch the same resources in the same way with one shader; \
             give this one another name",
            pass.name
        )));
    }
    let (kept, skipped) = select(&graph)?;
    let mut states = Vec::with_capacity(graph.resources().len());
    for (index, resource) in graph.resources().iter().enumerate() {
        let id = ResourceId(index as u16);
        let touched = kept.iter().any(|&p| graph.passes()[p].uses.iter().any(|u| u.resource == id));
        let written = kept.iter().any(|&p| graph.passes()[p].writes().any(|r| r == id));
        states.push(match resource.owner {
            Owner::Kept if !written => State::left_in(readers(&graph, id)),
            Owner::Kept => State::forgotten(everything(&graph, id)),
            Owner::Transient => State::forgotten(everything(&graph, id)),
            Owner::Imported | Owner::Exported | Owner::Lent => {
                let border = borders.iter().find(|b| b.resource == id);
                match border {
                    Some(border) => State::left_in(border.before),
                    None if !touched => State::forgotten(everything(&graph, id)),
                    None => {
                        return Err(Error::Frame(format!(
                            "{}: the host must say how it leaves and takes back this resource",
                            resource.name
                        )));
                    }
                }
            }
        });
    }

    let mut boundary: Vec<BoundaryUse> = Vec::new();
    let mut steps: Vec<Step> = Vec::with_capacity(kept.len());
    let mut recorded = vec![false; graph.kinds().len()];
    for &index in &kept {
        let mut barriers = Vec::new();
        for u in &graph.passes()[index].uses {
            let resource = graph.resource(u.resource);
            let border = borders.iter().find(|b| b.resource == u.resource);
            let scope = scope_at(u.access, border.filter(|_| resource.owner == Owner::Imported));
            let host_owned = !matches!(resource.owner, Owner::Transient | Owner::Kept);
            let first = host_owned && !boundary.iter().any(|b| b.resource == u.resource);
            if first {
                let entry = if resource.owner == Owner::Imported {
                    // Never written here, so one barrier can reach all of its readers.
                    let rows = kept.iter().map(|&p| &graph.passes()[p]);
                    let uses = rows.flat_map(|p| &p.uses).filter(|o| o.resource == u.resource);
                    uses.map(|o| o.access.scope()).fold(scope, |all, one| Scope {
                        stage: all.stage | one.stage,
                        access: all.access | one.access,
                        ..all
                    })
                } else {
                    scope
                };
                let name = resource.name;
                boundary.push(BoundaryUse {
                    resource: u.resource,
                    name,
                    entry,
                    exit: entry,
                    writes: false,
                });
                if !place_borders {
                    // The host's own barrier has made it ready for exactly this.
                    states[u.resource.index()] = State::left_in(entry);
                } else if resource.owner.is_result() {
                    // Written whole: what it held may be forgotten, in whatever layout.
                    let before = border.map_or(scope, |b| b.before);
                    states[u.resource.index()] = State::forgotten(before);
                }
            }
            let state = &mut states[u.resource.index()];
            if (!first || place_borders)
                && let Some(barrier) = state.touch(scope, u.access.writes())
            {
                barriers.push(ResourceBarrier { resource: u.resource, barrier });
            }
            if let Some(b) = boundary.iter_mut().find(|b| b.resource == u.resource) {
                b.writes |= u.access.writes();
            }
        }
        let first = !std::mem::replace(&mut recorded[graph.kind_of(index)], true);
        steps.push(Step { pass: index, first, barriers });
    }

    for b in &mut boundary {
        b.exit = states[b.resource.index()].scope();
    }
    let mut handover = Vec::new();
    // What is kept is left as its readers find it.
    for (index, resource) in graph.resources().iter().enumerate() {
        let (id, state) = (ResourceId(index as u16), &mut states[index]);
        let written = kept.iter().any(|&p| graph.passes()[p].writes().any(|r| r == id));
        if resource.owner == Owner::Kept && written {
            let barrier = state.touch(readers(&graph, id), false);
            handover.extend(barrier.map(|barrier| ResourceBarrier { resource: id, barrier }));
        }
    }
    if place_borders {
        // What no row of this frame touches is handed over too: its next user counts on it.
        for &Border { resource, after, .. } in borders {
            let state = &mut states[resource.index()];
            let barrier = state.touch(after, after.writes());
            handover.extend(barrier.map(|barrier| ResourceBarrier { resource, barrier }));
            if let Some(b) = boundary.iter_mut().find(|b| b.resource == resource) {
                b.exit = after.in_layout(state.layout());
            }
        }
    }
    Ok(Plan { graph, steps, handover, skipped, boundary })
}

/// The rows that run, and those that do not; checks that nothing is read before it is written.
fn select(graph: &Graph) -> Result<(Vec<usize>, Vec<Skipped>), Error> {
    let mut written: Vec<bool> = graph
        .resources()
        .iter()
        .map(|r| matches!(r.owner, Owner::Imported | Owner::Kept))
        .collect();
    let mut wanted: Vec<bool> = graph.resources().iter().map(|r| r.owner.is_result()).collect();
    let mut skipped = Vec::new();
    let mut candidates = Vec::new();
    for (index, pass) in graph.passes().iter().enumerate() {
        match &pass.need {
            Need::No(why) => skipped.push(Skipped { pass: index, why: why.to_string() }),
            Need::Yes(_) => candidates.push(index),
        }
    }
    for &index in &candidates {
        let pass = &graph.passes()[index];
        for (n, u) in pass.uses.iter().enumerate() {
            let name = graph.resource(u.resource).name;
            let again = pass.uses[..n]
                .iter()
                .any(|o| o.resource == u.resource && (o.access.writes() || u.access.writes()));
            if again {
                return Err(Error::Frame(format!(
                    "{}: touches {name} twice, once to write it; a pass may not read what it writes",
                    pass.name
                )));
            }
            if u.access.reads() && !written[u.resource.index()] {
                return Err(Error::Frame(format!(
                    "{}: reads {name}, which no earlier pass of this frame writes",
                    pass.name
                )));
            }
        }
        pass.writes().for_each(|r| written[r.index()] = true);
    }
    let mut kept = Vec::new();
    for &index in candidates.iter().rev() {
        let pass = &graph.passes()[index];
        if pass.writes().any(|r| wanted[r.index()]) {
            pass.reads().for_each(|r| wanted[r.index()] = true);
            kept.push(index);
        } else {
            let outputs: Vec<_> = pass.writes().map(|r| graph.resource(r).name).collect();
            skipped.push(Skipped {
                pass: index,
                why: format!("nothing reads {} in this frame", outputs.join(" or ")),
            });
        }
    }
    kept.reverse();
    skipped.sort_by_key(|s| s.pass);
    Ok((kept, skipped))
}

/// Every stage and access that any frame may have left a transient with.
fn everything(graph: &Graph, id: ResourceId) -> Scope {
    let none = Scope {
        stage: vk::PipelineStageFlags::empty(),
        access: vk::AccessFlags::empty(),
        layout: vk::ImageLayout::UNDEFINED,
    };
    graph.uses_of(id).map(Access::scope).fold(none, |all, one| Scope {
        stage: all.stage | one.stage,
        access: all.access | one.access,
        ..none
    })
}

/// Every stage and access that reads a resource, in the layout of the last of them.
fn readers(graph: &Graph, id: ResourceId) -> Scope {
    let reads = graph.uses_of(id).filter(|access| !access.writes()).map(Access::scope);
    reads.fold(Scope::UNUSED, |all, one| Scope {
        stage: if all == Scope::UNUSED { one.stage } else { all.stage | one.stage },
        access: all.access | one.access,
        layout: one.layout,
    })
}

/// The scope of a use; an imported image is fetched in the layout the host keeps it in, where that
/// is one that can be fetched from.
fn scope_at(access: Access, border: Option<&Border>) -> Scope {
    let scope = access.scope();
    match border {
        Some(b) if is_fetchable(b.before.layout) => Scope { layout: b.before.layout, ..scope },
        _ => scope,
    }
}

fn is_fetchable(layout: vk::ImageLayout) -> bool {
    matches!(
        layout,
        vk::ImageLayout::GENERAL
            | vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL
            | vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL
            | vk::ImageLayout::DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL
            | vk::ImageLayout::DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL
    )
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
