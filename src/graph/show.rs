//! A plan as text: a table for people, Graphviz for pictures.

use super::{Graph, Need, Owner, Plan, Shape, Work};
use std::fmt::Write as _;

impl Plan {
    /// One line a row: what runs and why, what does not and why not.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let width = self.graph.passes().iter().map(|p| p.name.len()).max().unwrap_or(0);
        for step in &self.steps {
            let pass = &self.graph.passes()[step.pass];
            let Need::Yes(why) = &pass.need else { continue };
            let work = work_of(&self.graph, &pass.work);
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "run   {:width$}  {work:<24}  {:>2} barriers  {why}",
                pass.name,
                step.barriers.len()
            );
        }
        for skipped in &self.skipped {
            let name = self.graph.passes()[skipped.pass].name;
            let _ = writeln!(text, "skip  {name:width$}  {}", skipped.why);
        }
        text
    }

    /// The rows that run and the resources between them, for `dot -Tsvg`.
    pub fn graphviz(&self) -> String {
        let mut text =
            String::from("digraph plan {\n  rankdir=LR; node [fontname=\"sans-serif\"];\n");
        let mut touched = vec![false; self.graph.resources().len()];
        for step in &self.steps {
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
                Shape::Image { format, width, height } => format!("{width}×{height} {format:?}"),
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
        Work::Raster { draw: super::Draw::Layer(layer), .. } => {
            format!("draw {:?}", layer.meshes()).to_lowercase()
        }
        Work::Raster { draw: super::Draw::Indirect { arguments }, .. } => {
            format!("draw by {}", graph.resource(*arguments).name)
        }
    }
}
