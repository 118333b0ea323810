//! From a graph to what one frame records.

use super::{Access, Barrier, Graph, Owner, Pass, ResourceId, Scope, State, Why};
use crate::Error;
use ash::vk;
use smallvec::SmallVec;

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

/// The barriers before a row: as many as rows have lie in the step itself.
pub type Barriers = SmallVec<[ResourceBarrier; 6]>;

/// A row that runs, behind the barriers it needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The row's place in [`Graph::passes`].
    pub pass: usize,
    /// No earlier step is of its kind: later ones find their descriptors written.
    pub first: bool,
    /// What must happen first.
    pub barriers: Barriers,
}

/// A row that does not run; [`Plan::why_skipped`] says why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The row's place in [`Graph::passes`].
    pub pass: usize,
    /// It is needed, but nothing reads what it writes.
    pub unread: bool,
}

/// What one frame does: the rows that run, in order, with their barriers.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// What it was compiled for, beyond the graph.
    borders: Vec<Border>,
    places_borders: bool,
}

impl Plan {
    /// Why a row does not run.
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

    /// Every row that does not run, and why.
    pub fn reasons(&self) -> impl Iterator<Item = (&Pass, Why)> {
        self.skipped.iter().map(|s| (&self.graph.passes()[s.pass], self.why_skipped(s)))
    }
}

/// Drops rows that are not needed or whose output nobody reads, and derives the barriers.
///
/// `borders` says how the host leaves and takes back its resources; with `place_borders` the plan
/// holds the barriers at the border too, without it the host places them from [`Plan::boundary`].
///
/// # Errors
/// [`Error::Frame`] where a row reads what none has written, touches one resource twice, or does other
/// work than the rows of its name before it; or where a resource of the host's has no border.
pub fn compile(mut graph: Graph, borders: &[Border], place_borders: bool) -> Result<Plan, Error> {
    let mut plan = Plan::default();
    Compiler::default().compile(&mut graph, borders, place_borders, false, &mut plan)?;
    Ok(plan)
}

/// Compiles frame after frame in the same memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compiler {
    /// Of each resource.
    states: Vec<State>,
    there: Vec<bool>,
    wanted: Vec<bool>,
    /// The rows that run.
    kept: Vec<usize>,
    /// Of each kind of row.
    recorded: Vec<bool>,
}

impl Compiler {
    /// As [`compile`], into a plan of an earlier frame, whose graph is exchanged for this one. Where the caller knows the
    /// two to differ by numbers alone (`same`), the steps stay as they are. After an error the plan is of no frame.
    ///
    /// # Errors
    /// As [`compile`].
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
        if let Some(pass) = plan.graph.mismatched_row() {
            return Err(Error::Frame(format!(
                "{}: rows of one name must touch the same resources in the same way with one shader; \
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

    /// The state of each resource before the first row.
    fn start(&mut self, graph: &Graph, borders: &[Border]) -> Result<(), Error> {
        self.states.clear();
        for (index, resource) in graph.resources().iter().enumerate() {
            let id = ResourceId(index as u16);
            let uses = || self.kept.iter().flat_map(|&p| &graph.passes()[p].uses);
            let touched = uses().any(|u| u.resource == id);
            let written = uses().any(|u| u.resource == id && u.access.writes());
            self.states.push(match resource.owner {
                Owner::Kept if !written => State::left_in(readers(graph, id)),
                Owner::Kept => State::forgotten(everything(graph, id)),
                Owner::Transient => State::forgotten(everything(graph, id)),
                Owner::Imported | Owner::Exported | Owner::Lent => {
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

    /// The rows that run, with their barriers, and how they touch the host's resources.
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
                    let (resource, name) = (u.resource, resource.name);
                    boundary.push(BoundaryUse {
                        resource,
                        name,
                        entry,
                        exit: entry,
                        writes: false,
                    });
                    if !*places_borders {
                        // The host's own barrier has made it ready for exactly this.
                        states[u.resource.index()] = State::left_in(entry);
                    } else if graph.resource(resource).owner.is_result() {
                        // Written whole: what it held may be forgotten, in whatever layout.
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

    /// What is left to whoever comes behind.
    fn hand_over(&mut self, plan: &mut Plan, borders: &[Border]) {
        let Plan { graph, boundary, handover, places_borders, .. } = plan;
        let states = &mut self.states;
        for b in boundary.iter_mut() {
            b.exit = states[b.resource.index()].scope();
        }
        handover.clear();
        // What is kept is left as its readers find it.
        for (index, resource) in graph.resources().iter().enumerate() {
            let (id, state) = (ResourceId(index as u16), &mut states[index]);
            let mut rows = self.kept.iter().map(|&p| &graph.passes()[p]);
            if resource.owner == Owner::Kept && rows.any(|p| p.writes().any(|r| r == id)) {
                let barrier = state.touch(readers(graph, id), false);
                handover.extend(barrier.map(|barrier| ResourceBarrier { resource: id, barrier }));
            }
        }
        if *places_borders {
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
    }

    /// The rows that run, and those that do not.
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
        // From the last back: what is read is wanted of those before.
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
