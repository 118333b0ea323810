//! Compiles a graph into the plan of one frame.

use super::{Access, Barrier, Graph, Owner, ResourceId, Scope, State, Why};
use crate::Error;
use ash::vk;
use smallvec::SmallVec;

/// The host's uses of a shared resource before and after the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// The resource.
    pub resource: ResourceId,
    /// The host's last use before the node.
    pub before: Scope,
    /// The host's first use after the node.
    pub after: Scope,
}

/// How the node uses a resource that it shares with the host, for hosts that record barriers themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryUse {
    /// The resource.
    pub resource: ResourceId,
    /// The resource's name in the graph.
    pub name: &'static str,
    /// The scope of the node's first use, or of all its uses where it only reads, with the layout that the resource
    /// must be in then.
    pub entry: Scope,
    /// The scope of the node's last uses, with the layout that the resource is left in; where the node records the
    /// host's barriers, the scope of the host's next use.
    pub exit: Scope,
    /// Whether the node writes the resource.
    pub writes: bool,
}

/// A barrier for one resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResourceBarrier {
    /// The resource.
    pub resource: ResourceId,
    /// The dependency.
    pub barrier: Barrier,
}

/// The barriers before a pass, stored in the step itself for as many as passes usually have.
pub type Barriers = SmallVec<[ResourceBarrier; 10]>;

/// A pass that runs, and the barriers before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The pass's index in [`Graph::passes`].
    pub pass: usize,
    /// Whether no earlier step is of the pass's kind: this step writes the descriptors of all of them.
    pub first: bool,
    /// The barriers that are recorded first.
    pub barriers: Barriers,
}

/// A pass that does not run; [`Plan::why_skipped`] says why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The pass's index in [`Graph::passes`].
    pub pass: usize,
    /// Whether the pass is needed, but no pass that runs reads its output.
    pub unread: bool,
}

/// The passes that one frame runs, in order, with their barriers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The graph with this frame's push constants and grids.
    pub graph: Graph,
    /// The passes that run, in order.
    pub steps: Vec<Step>,
    /// The barriers after the last pass, which make shared resources ready for the host.
    pub handover: Vec<ResourceBarrier>,
    /// The passes that do not run.
    pub skipped: Vec<Skipped>,
    /// How the node uses the resources that it shares with the host.
    pub boundary: Vec<BoundaryUse>,
    /// The borders that the plan was compiled for.
    borders: Vec<Border>,
    places_borders: bool,
}

impl Plan {
    /// Why a pass does not run.
    pub fn why_skipped(&self, skipped: &Skipped) -> Why {
        let pass = &self.graph.passes()[skipped.pass];
        if !skipped.unread {
            return self.graph.why(pass);
        }
        let outputs = pass.writes().map(|r| self.graph.resource(r).name).enumerate();
        outputs
            .fold(Why::from("nothing reads "), |why, (nth, name)| match nth {
                0 => why.and(name),
                _ => why.and(" or ").and(name),
            })
            .and(" in this frame")
    }
}

/// Drops passes that are not needed or whose output nobody reads, and derives the barriers.
///
/// `borders` has the host's uses of shared resources before and after the node. With `place_borders` the plan contains
/// the barriers against these uses too; without, the host records them from [`Plan::boundary`].
///
/// # Errors
/// [`Error::Frame`] where a pass reads a resource that no pass has written, uses a resource that it writes twice, or does
/// other work than earlier passes of its name; or where a shared resource has no border.
pub fn compile(mut graph: Graph, borders: &[Border], place_borders: bool) -> Result<Plan, Error> {
    let mut plan = Plan::default();
    Compiler::default().compile(&mut graph, borders, place_borders, false, &mut plan)?;
    Ok(plan)
}

/// Compiles plans in memory that it keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compiler {
    /// The state of each resource.
    states: Vec<State>,
    /// Whether each resource has content.
    there: Vec<bool>,
    /// Whether a later pass or the host reads each resource.
    wanted: Vec<bool>,
    /// The indices of the passes that run.
    kept: Vec<usize>,
    /// Whether a step of each kind of pass has been placed.
    recorded: Vec<bool>,
}

impl Compiler {
    /// Compiles a graph into a plan of an earlier frame, and exchanges the two graphs; see [`compile`]. Where the
    /// caller knows that both differ in numbers alone (`same`), the steps stay as they are. After an error the plan is
    /// of no frame.
    ///
    /// # Errors
    /// See [`compile`].
    pub fn compile(
        &mut self,
        graph: &mut Graph,
        borders: &[Border],
        place_borders: bool,
        same: bool,
        plan: &mut Plan,
    ) -> Result<(), Error> {
        #[cfg(test)]
        assert!(!same || plan.graph.differs_in_numbers_alone(graph));
        let same = same && plan.places_borders == place_borders && plan.borders == borders;
        std::mem::swap(&mut plan.graph, graph);
        if same {
            return Ok(());
        }
        plan.places_borders = place_borders;
        plan.borders.clear();
        if let Some(pass) = plan.graph.mismatched_pass() {
            return Err(Error::Frame(format!(
                "{}: passes of one name must touch the same resources in the same way with one shader; \
                 give this one another name",
                pass.name
            )));
        }
        self.select(&plan.graph, &mut plan.skipped)?;
        self.start(&plan.graph, borders)?;
        self.place_steps(plan, borders);
        self.hand_over(plan, borders);
        plan.borders.extend_from_slice(borders);
        Ok(())
    }

    /// Sets the state of each resource before the first pass.
    fn start(&mut self, graph: &Graph, borders: &[Border]) -> Result<(), Error> {
        self.states.clear();
        for (index, resource) in graph.resources().iter().enumerate() {
            let id = ResourceId(index as u16);
            let uses = || self.kept.iter().flat_map(|&p| &graph.passes()[p].uses);
            let touched = uses().any(|u| u.resource == id);
            let written = uses().any(|u| u.resource == id && u.access.writes());
            self.states.push(match resource.owner {
                Owner::Kept if !written => State::left_in(readers(graph, id)),
                owner if !owner.is_shared() => State::forgotten(everything(graph, id)),
                _ => {
                    let border = borders.iter().find(|b| b.resource == id);
                    match border {
                        Some(border) => State::left_in(border.before),
                        None if !touched => State::forgotten(everything(graph, id)),
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
        Ok(())
    }

    /// Fills in the steps with their barriers, and how they use shared resources.
    fn place_steps(&mut self, plan: &mut Plan, borders: &[Border]) {
        let Plan { graph, steps, boundary, places_borders, .. } = plan;
        let (kept, states) = (&self.kept, &mut self.states);
        steps.clear();
        boundary.clear();
        self.recorded.clear();
        self.recorded.resize(graph.kinds().len(), false);
        for &index in kept {
            let mut barriers = Barriers::new();
            for u in &graph.passes()[index].uses {
                let resource = graph.resource(u.resource);
                let border = borders.iter().find(|b| b.resource == u.resource);
                let scope =
                    scope_at(u.access, border.filter(|_| resource.owner == Owner::Imported));
                let seen = |b: &BoundaryUse| b.resource == u.resource;
                let first = resource.owner.is_shared() && !boundary.iter().any(seen);
                if first {
                    let entry = if resource.owner == Owner::Imported {
                        // No pass writes it, so that one barrier serves all of its readers.
                        let passes = kept.iter().map(|&p| &graph.passes()[p]);
                        let uses =
                            passes.flat_map(|p| &p.uses).filter(|o| o.resource == u.resource);
                        uses.map(|o| o.access.scope()).fold(scope, |all, one| Scope {
                            stage: all.stage | one.stage,
                            access: all.access | one.access,
                            ..all
                        })
                    } else {
                        scope
                    };
                    let (resource, name) = (u.resource, resource.name);
                    boundary.push(BoundaryUse {
                        resource,
                        name,
                        entry,
                        exit: entry,
                        writes: false,
                    });
                    if !*places_borders {
                        // The host's own barrier has made it ready for this use.
                        states[u.resource.index()] = State::left_in(entry);
                    } else if graph.resource(resource).owner.is_result() {
                        // The node overwrites it: its content may be discarded, whatever its layout.
                        let before = border.map_or(scope, |b| b.before);
                        states[u.resource.index()] = State::forgotten(before);
                    }
                }
                let state = &mut states[u.resource.index()];
                if (!first || *places_borders)
                    && let Some(barrier) = state.touch(scope, u.access.writes())
                {
                    barriers.push(ResourceBarrier { resource: u.resource, barrier });
                }
                if let Some(b) = boundary.iter_mut().find(|b| b.resource == u.resource) {
                    b.writes |= u.access.writes();
                }
            }
            let first = !std::mem::replace(&mut self.recorded[graph.kind_of(index)], true);
            steps.push(Step { pass: index, first, barriers });
        }
    }

    /// Fills in the barriers after the last pass, for later frames and the host.
    fn hand_over(&mut self, plan: &mut Plan, borders: &[Border]) {
        let Plan { graph, boundary, handover, places_borders, .. } = plan;
        let states = &mut self.states;
        for b in boundary.iter_mut() {
            b.exit = states[b.resource.index()].scope();
        }
        handover.clear();
        // A kept resource is left ready for its readers in later frames, and figures for the host.
        for (index, resource) in graph.resources().iter().enumerate() {
            let (id, state) = (ResourceId(index as u16), &mut states[index]);
            let mut written = self.kept.iter().flat_map(|&p| graph.passes()[p].writes());
            if resource.owner.is_read_later() && written.any(|r| r == id) {
                let barrier = state.touch(readers(graph, id), false);
                handover.extend(barrier.map(|barrier| ResourceBarrier { resource: id, barrier }));
            }
        }
        if *places_borders {
            // A resource that no pass of this frame uses is handed over too: the host expects its layout.
            for &Border { resource, after, .. } in borders {
                let state = &mut states[resource.index()];
                let barrier = state.touch(after, after.writes());
                handover.extend(barrier.map(|barrier| ResourceBarrier { resource, barrier }));
                if let Some(b) = boundary.iter_mut().find(|b| b.resource == resource) {
                    b.exit = after.in_layout(state.layout());
                }
            }
        }
    }

    /// Sorts the passes into those that run and those that do not.
    fn select(&mut self, graph: &Graph, skipped: &mut Vec<Skipped>) -> Result<(), Error> {
        let Self { there, wanted, kept, .. } = self;
        there.clear();
        let lasts = |owner| matches!(owner, Owner::Imported | Owner::Kept);
        there.extend(graph.resources().iter().map(|r| lasts(r.owner)));
        wanted.clear();
        wanted.extend(graph.resources().iter().map(|r| r.owner.is_result()));
        skipped.clear();
        kept.clear();
        for (index, pass) in graph.passes().iter().enumerate() {
            if !pass.need.is_yes() {
                skipped.push(Skipped { pass: index, unread: false });
                continue;
            }
            kept.push(index);
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
                if u.access.reads() && !there[u.resource.index()] {
                    return Err(Error::Frame(format!(
                        "{}: reads {name}, which no earlier pass of this frame writes",
                        pass.name
                    )));
                }
            }
            pass.writes().for_each(|r| there[r.index()] = true);
        }
        // From the last pass back: a pass that runs makes the resources that it reads wanted.
        let mut place = kept.len();
        for n in (0..kept.len()).rev() {
            let index = kept[n];
            let pass = &graph.passes()[index];
            if pass.writes().any(|r| wanted[r.index()]) {
                pass.reads().for_each(|r| wanted[r.index()] = true);
                place -= 1;
                kept[place] = index;
            } else {
                skipped.push(Skipped { pass: index, unread: true });
            }
        }
        kept.drain(..place);
        skipped.sort_unstable_by_key(|s| s.pass);
        Ok(())
    }
}

/// The scope of all uses of a resource: an earlier frame may have ended with any of them.
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

/// The scope of all reads of a resource, in the layout of the last of them.
fn readers(graph: &Graph, id: ResourceId) -> Scope {
    let reads = graph.uses_of(id).filter(|access| !access.writes()).map(Access::scope);
    let host = (graph.resource(id).owner == Owner::HostRead).then_some(Scope::HOST_READ);
    reads.chain(host).fold(Scope::UNUSED, |all, one| Scope {
        stage: if all == Scope::UNUSED { one.stage } else { all.stage | one.stage },
        access: all.access | one.access,
        layout: one.layout,
    })
}

/// The scope of an access. An imported image stays in the host's layout where shaders can fetch from it.
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
