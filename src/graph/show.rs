//! A plan as text: a table to read, and a graph in Graphviz's language.

use super::{Graph, Owner, Pass, Plan, Shape, Skipped, Why, Work};
use std::fmt::Write as _;

/// All steps of one kind of pass, as one line of a plan's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run<'a> {
    /// The pass of the first step.
    pub pass: &'a Pass,
    /// The number of steps.
    pub times: usize,
    /// The number of barriers before all of these steps.
    pub barriers: usize,
}

impl Plan {
    /// The kinds of pass that run, in the order of their first steps.
    pub fn runs(&self) -> Vec<Run<'_>> {
        let mut runs: Vec<Run> = Vec::new();
        let mut of_kind = vec![None; self.graph.kinds().len()];
        for step in &self.steps {
            let at = *of_kind[self.graph.kind_of(step.pass)].get_or_insert_with(|| {
                let pass = &self.graph.passes()[step.pass];
                runs.push(Run { pass, times: 0, barriers: 0 });
                runs.len() - 1
            });
            runs[at].times += 1;
            runs[at].barriers += step.barriers.len();
        }
        runs
    }

    /// Every kind of pass of which one does not run, and why; once for each of its reasons.
    pub fn reasons(&self) -> impl Iterator<Item = (&Pass, Why)> {
        let told = |s: &Skipped| (self.graph.kind_of(s.pass), self.why_skipped(s));
        let new = move |nth: &usize| {
            let one = told(&self.skipped[*nth]);
            self.skipped[..*nth].iter().all(|other| told(other) != one)
        };
        let skipped = (0..self.skipped.len()).filter(new).map(|nth| &self.skipped[nth]);
        skipped.map(|s| (&self.graph.passes()[s.pass], self.why_skipped(s)))
    }

    /// The plan as a table: a line for each kind of pass that runs, with how often and why, then one for each kind of
    /// which one does not, with why not.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let width = self.graph.kinds().map(|p| p.name.len()).max().unwrap_or(0);
        for Run { pass, times, barriers } in self.runs() {
            let why = self.graph.why(pass);
            let mut work = work_of(&self.graph, &pass.work);
            if times > 1 {
                work.push_str(&format!(" ×{times}"));
            }
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "run   {:width$}  {work:<24}  {barriers:>2} barriers  {why}",
                pass.name
            );
        }
        for (pass, why) in self.reasons() {
            let _ = writeln!(text, "skip  {:width$}  {why}", pass.name);
        }
        text
    }

    /// The plan as a graph for `dot -Tsvg`: each kind of pass that runs, and the resources between them.
    pub fn graphviz(&self) -> String {
        let mut text =
            String::from("digraph plan {\n  rankdir=LR; node [fontname=\"sans-serif\"];\n");
        let mut touched = vec![false; self.graph.resources().len()];
        for step in self.steps.iter().filter(|s| s.first) {
            let pass = &self.graph.passes()[step.pass];
            let _ = writeln!(text, "  p{} [shape=box label=\"{}\"];", step.pass, pass.name);
            for u in &pass.uses {
                let r = u.resource.index();
                touched[r] = true;
                let _ = if u.access.writes() {
                    writeln!(text, "  p{} -> r{r} [label=\"{:?}\"];", step.pass, u.access)
                } else {
                    writeln!(text, "  r{r} -> p{} [label=\"{:?}\"];", step.pass, u.access)
                };
            }
        }
        for (r, resource) in self.graph.resources().iter().enumerate().filter(|(r, _)| touched[*r])
        {
            let size = match resource.shape {
                Shape::Image { format, width, height, layers } => {
                    let layers = layers.map_or(String::new(), |n| format!("×{n}"));
                    format!("{width}×{height}{layers} {format:?}")
                }
                Shape::Buffer { bytes } => format!("{bytes} B"),
            };
            let style = if resource.owner == Owner::Transient { "solid" } else { "bold" };
            let _ = writeln!(
                text,
                "  r{r} [shape=ellipse style={style} label=\"{}\\n{size}\"];",
                resource.name
            );
        }
        text.push_str("}\n");
        text
    }
}

fn work_of(graph: &Graph, work: &Work) -> String {
    match work {
        Work::Dispatch { groups: [x, y, z], .. } => format!("dispatch {x}×{y}×{z}"),
        Work::Indirect { arguments, .. } => {
            format!("dispatch by {}", graph.resource(*arguments).name)
        }
        Work::EachMesh { .. } => "dispatch a mesh".into(),
        Work::EachCutOut { textures: true, .. } => "dispatch an opacity texture".into(),
        Work::EachCutOut { .. } => "dispatch a mesh that is cut out".into(),
        Work::CutOuts => "write the meshes that are cut out".into(),
        Work::Constants { .. } => "write constants".into(),
        Work::FrameNumber => "write the frame's number".into(),
        Work::Raster { draw: super::Draw::Layer { layer, .. }, .. } => {
            format!("draw {:?}", layer.meshes()).to_lowercase()
        }
        Work::Raster { draw: super::Draw::Indirect { arguments, .. }, .. } => {
            format!("draw by {}", graph.resource(*arguments).name)
        }
    }
}
