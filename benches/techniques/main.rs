//! What single techniques cost, and what their parts are worth.
//!
//! `cargo bench --bench techniques -- [BENCH [TABLE...]] [--quick] [--out DIR]` (`-- --help` lists the benches, and
//! `-- BENCH --help` its tables). Everything is measured in one process, and what is compared takes turns.

// A bench says what went wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod forward;
mod linear_light;
mod occlusion_textures;
mod planner;
mod ray_march;
mod ready;
mod soft_shadow_map;
mod table;
mod tiles;
mod traced;

use antumbra_bench::options::Options;
use antumbra_harness::{HeadlessDevice, HeadlessOptions};
use clap::{Arg, ArgAction, ArgMatches, Command};
use std::path::Path;
use table::Table;

/// How much is measured.
pub struct Scale {
    /// How often each frame is run.
    pub rounds: usize,
    /// The sides of the maps in texels, where they are what varies.
    pub sides: &'static [u32],
    /// Whether what takes minutes on a CPU is left out.
    pub quick: bool,
}

/// A table by its name on the command line.
type Study = (&'static str, fn(&HeadlessDevice, &Scale, &mut Table));

/// The tables of one subcommand.
pub struct Bench {
    name: &'static str,
    about: &'static str,
    studies: &'static [Study],
    full: Scale,
    quick: Scale,
}

const BENCHES: [Bench; 7] = [
    soft_shadow_map::BENCH,
    ray_march::BENCH,
    occlusion_textures::BENCH,
    linear_light::BENCH,
    planner::BENCH,
    tiles::BENCH,
    traced::BENCH,
];

impl Bench {
    fn command(&self) -> Command {
        let tables = Arg::new("TABLE").num_args(0..).help("The tables to make; all without any");
        let names = self.studies.iter().map(|(name, _)| *name);
        let names: Vec<_> = names.collect();
        Command::new(self.name).about(self.about).arg(tables.value_parser(names))
    }

    /// Makes the tables that are named, or all, each a file of the folder.
    fn run(
        &self,
        device: &HeadlessDevice,
        arguments: Option<&ArgMatches>,
        quick: bool,
        out: &Path,
    ) {
        let named = arguments.and_then(|a| a.get_many::<String>("TABLE"));
        let named: Option<Vec<_>> = named.map(Iterator::collect);
        let scale = if quick { &self.quick } else { &self.full };
        for (name, make) in self.studies {
            if named.as_ref().is_none_or(|named| named.iter().any(|n| n == name)) {
                let mut table = Table::new(name);
                make(device, scale, &mut table);
                let path = table.write(&out.join(self.name), device.name());
                println!("{}", path.display());
            }
        }
    }
}

fn main() {
    let switch = |name| Arg::new(name).long(name).action(ArgAction::SetTrue).global(true);
    let out = Arg::new("out").long("out").value_name("DIR").global(true);
    let arguments = Command::new("techniques")
        .bin_name("cargo bench --bench techniques --")
        .about("What single techniques cost, and what their parts are worth; all benches without a name")
        .subcommands(BENCHES.iter().map(Bench::command))
        .arg(switch("quick").help("Fewer rounds, and without what takes minutes on a CPU"))
        .arg(out.default_value("out/bench").help("Where the tables go as CSV"))
        // cargo itself passes it.
        .arg(switch("bench").hide(true))
        .get_matches();
    let out = Options::root().join(arguments.get_one::<String>("out").unwrap());
    let device = HeadlessDevice::new(&HeadlessOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    println!("{}", device.name());
    for bench in &BENCHES {
        let own = arguments.subcommand_matches(bench.name);
        if own.is_some() || arguments.subcommand_name().is_none() {
            bench.run(&device, own, arguments.get_flag("quick"), &out);
        }
    }
}
