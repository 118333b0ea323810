//! Runs one GLSL function on the device, alone, beside its twins on the CPU.
//!
//! ```ignore
//! Function::new("common/light_space.glsl", "float overlap(float a, float b)")
//!     .case((0.2, 0.7))
//!     .random(10_000, (-2.0..3.0, -2.0..3.0))
//!     .f32(Tolerance::ulps(1), |x| vec![overlap(x[0], x[1])])
//!     .f64(Tolerance::absolute(1e-7), |x| vec![overlap(x[0], x[1])])
//!     .check(&device());
//! ```
//! The prototype says what goes in and out: float, int, uint and their vectors, bool, mat3, mat4;
//! `out` parameters are results after the returned value. Inputs and results are flat lists of
//! numbers in that order, a matrix column by column.

use crate::compare::{Report, Tolerance, Worst};
use crate::compile::try_compile;
use crate::signature::{Parameter, Scalar, Signature};
use antumbra_harness::{HeadlessDevice, HostBuffer, run_compute};
use ash::vk;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use std::cell::RefCell;

/// Invocations a workgroup; each runs one case.
const GROUP: usize = 64;

thread_local! {
    /// What a test has checked so far; each test has a thread of its own.
    static PASSED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Options of the harness that show what passes; else what passed stands behind what fails.
const SHOWN: [&str; 3] = ["--nocapture", "--no-capture", "--show-output"];

/// What a test of one function consists of.
pub struct Function {
    prototype: String,
    file: String,
    signature: Signature,
    /// GLSL behind the include.
    glue: String,
    /// The cases' words, one after the other.
    words: Vec<u32>,
    cases: usize,
    twins: Vec<Twin>,
}

/// A twin, and what it is called in a report.
struct Twin {
    name: &'static str,
    tolerance: Tolerance,
    run: TwinFunction,
}

/// From a case's words and numbers to the expected numbers.
type TwinFunction = Box<dyn Fn(&[u32], &[f64]) -> Vec<f64>>;

/// One case's inputs and results, as flat lists of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What went in, after rounding to 32 bits.
    pub input: Vec<f64>,
    /// What came out.
    pub output: Vec<f64>,
}

impl Function {
    /// A function by its prototype and the file under `glsl/` that defines it.
    ///
    /// # Panics
    /// If the prototype is not one, or has types that cannot be passed.
    pub fn new(file: &str, prototype: &str) -> Self {
        let signature = Signature::parse(prototype).unwrap_or_else(|problem| panic!("{problem}"));
        assert!(signature.outputs().count() > 0, "\"{prototype}\" has no result");
        Self {
            prototype: prototype.into(),
            file: file.into(),
            signature,
            glue: String::new(),
            words: Vec::new(),
            cases: 0,
            twins: Vec::new(),
        }
    }

    /// Adds GLSL behind the include, for functions whose types cannot be passed: the prototype is then
    /// that of a function which takes their parts and calls them.
    #[must_use]
    pub fn glue(mut self, glsl: &str) -> Self {
        self.glue = glsl.into();
        self
    }

    /// Adds one case by hand: a number, a tuple or array of numbers, or nested ones.
    ///
    /// # Panics
    /// If it has not as many numbers as the function takes.
    #[must_use]
    pub fn case(mut self, input: impl Flat) -> Self {
        let mut numbers = Vec::new();
        input.flatten(&mut numbers);
        let scalars = Signature::scalars(self.signature.inputs());
        let (given, taken) = (numbers.len(), scalars.len());
        assert_eq!(given, taken, "{given} numbers for \"{}\"", self.prototype);
        self.words.extend(scalars.iter().zip(&numbers).map(|(scalar, x)| scalar.encode(*x)));
        self.cases += 1;
        self
    }

    /// Adds `count` cases from a proptest strategy: a range, a tuple of them, or any other. The same
    /// ones each time.
    ///
    /// # Panics
    /// As [`Self::case`], or if the strategy rejects too much.
    #[must_use]
    pub fn random<S: Strategy<Value: Flat>>(mut self, count: usize, inputs: S) -> Self {
        let mut runner = TestRunner::deterministic();
        for _ in 0..count {
            let tree = inputs.new_tree(&mut runner).expect("a strategy that yields cases");
            self = self.case(tree.current());
        }
        self
    }

    /// Compares with a twin in 32-bit floats.
    #[must_use]
    pub fn f32(
        mut self,
        tolerance: Tolerance,
        twin: impl Fn(&[f32]) -> Vec<f32> + 'static,
    ) -> Self {
        let run: TwinFunction = Box::new(move |_, input| {
            let input: Vec<f32> = input.iter().map(|x| *x as f32).collect();
            twin(&input).into_iter().map(f64::from).collect()
        });
        self.twins.push(Twin { name: "the twin in f32", tolerance, run });
        self
    }

    /// Compares with a twin in 64-bit floats, on the inputs as rounded to 32 bits: the difference is
    /// the shader's own rounding error.
    #[must_use]
    pub fn f64(
        mut self,
        tolerance: Tolerance,
        twin: impl Fn(&[f64]) -> Vec<f64> + 'static,
    ) -> Self {
        let run: TwinFunction = Box::new(move |_, input| twin(input));
        self.twins.push(Twin { name: "the twin in f64", tolerance, run });
        self
    }

    /// Compares with a twin on the words themselves, bit by bit: for functions of integers, such as
    /// a hash. All results must be integers.
    ///
    /// # Panics
    /// If a result is a float.
    #[must_use]
    pub fn bits(mut self, twin: impl Fn(&[u32]) -> Vec<u32> + 'static) -> Self {
        let scalars = Signature::scalars(self.signature.outputs());
        assert!(!scalars.contains(&Scalar::Float), "\"{}\" has float results", self.prototype);
        let run: TwinFunction = Box::new(move |words, _| {
            let words = twin(words);
            words.iter().zip(&scalars).map(|(word, scalar)| scalar.decode(*word)).collect()
        });
        self.twins.push(Twin { name: "the twin in bits", tolerance: Tolerance::exact(), run });
        self
    }

    /// Runs every case in one dispatch.
    ///
    /// # Panics
    /// If the shader does not compile or the device fails.
    pub fn outputs(&self, device: &HeadlessDevice) -> Vec<Case> {
        assert!(self.cases > 0, "\"{}\" has no cases", self.prototype);
        let name = format!("{}: {}.comp", self.file, self.signature.name);
        let spirv = try_compile(&name, &self.source()).unwrap_or_else(|log| panic!("{log}"));
        let results = Signature::scalars(self.signature.outputs());
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        // A buffer has at least one byte, also where a function takes nothing.
        let inputs = if self.words.is_empty() { &[0][..] } else { &self.words };
        let inputs = HostBuffer::with_data(device, "inputs", inputs, usage).unwrap();
        // Words that no shader writes by chance: a case that was not run shows.
        let unwritten = vec![0x7fc0_dead_u32; self.cases * results.len()];
        let outputs = HostBuffer::with_data(device, "outputs", &unwritten, usage).unwrap();
        let count = u32::try_from(self.cases).unwrap();
        let groups = [count.div_ceil(GROUP as u32), 1, 1];
        run_compute(device, &spirv, &count.to_le_bytes(), &[&inputs, &outputs], groups).unwrap();

        let words: Vec<u32> = outputs.read();
        let numbers = |words: &[u32], scalars: &[Scalar]| {
            words.iter().zip(scalars).map(|(word, scalar)| scalar.decode(*word)).collect()
        };
        let parameters = Signature::scalars(self.signature.inputs());
        (0..self.cases)
            .map(|i| Case {
                input: numbers(self.words_of(i), &parameters),
                output: numbers(&words[i * results.len()..][..results.len()], &results),
            })
            .collect()
    }

    /// Runs every case and compares with each twin: one report a twin.
    ///
    /// # Errors
    /// A sentence with the worst case, for each twin that differs by more than is allowed.
    ///
    /// # Panics
    /// As [`Self::outputs`], or without a twin.
    pub fn try_check(&self, device: &HeadlessDevice) -> Result<Vec<Report>, String> {
        assert!(!self.twins.is_empty(), "\"{}\" is compared with nothing", self.prototype);
        let cases = self.outputs(device);
        let mut reports = Vec::new();
        let mut problems = Vec::new();
        for twin in &self.twins {
            let mut report = Report::default();
            for (i, case) in cases.iter().enumerate() {
                let expected = (twin.run)(self.words_of(i), &case.input);
                report.add(&case.input, &case.output, &expected, twin.tolerance);
            }
            if report.failures > 0 {
                problems.push(self.problem(device, twin, &report));
            }
            reports.push(report);
        }
        if problems.is_empty() { Ok(reports) } else { Err(problems.join("\n")) }
    }

    /// What a twin finds wrong, and the worst case by the parameters' names.
    fn problem(&self, device: &HeadlessDevice, twin: &Twin, report: &Report) -> String {
        let Report { failures, cases, worst } = report;
        let mut text = format!(
            "{} on {} against {}: {failures} of {cases} cases differ by more than is allowed",
            self.prototype,
            device.name(),
            twin.name
        );
        if let Some(Worst { input, found, expected, excess, difference, ulps }) = worst {
            let (input, of) = (self.signature.named_inputs(input), &self.signature);
            text += &format!(
                "\n  worst:    {input}\n  found:    {}\n  expected: {}\n  \
                 apart by {difference:e}, {ulps} ulps, {excess:.3} times what is allowed",
                of.named_outputs(found),
                of.named_outputs(expected)
            );
        }
        text
    }

    /// As [`Self::try_check`]; a line for each twin says how near it was.
    ///
    /// # Panics
    /// If a twin differs by more than is allowed: with the worst case, and behind it the lines of what this test has
    /// checked before.
    #[track_caller]
    pub fn check(&self, device: &HeadlessDevice) {
        let reports = self.try_check(device).unwrap_or_else(|problem| {
            let passed = PASSED.take();
            let before = if passed.is_empty() { "" } else { "\npassed before:\n  " };
            panic!("{problem}{before}{}", passed.join("\n  "))
        });
        for (twin, Report { cases, worst, .. }) in self.twins.iter().zip(&reports) {
            let near = worst.as_ref().map_or("the same in all".into(), |worst| {
                format!("the worst {:.3} times what is allowed", worst.excess)
            });
            let line = format!("{} against {}: {cases} cases, {near}", self.prototype, twin.name);
            if std::env::args().any(|option| SHOWN.contains(&option.as_str())) {
                println!("{line}");
            }
            PASSED.with_borrow_mut(|passed| passed.push(line));
        }
    }

    fn words_of(&self, case: usize) -> &[u32] {
        let stride = self.words.len() / self.cases;
        &self.words[case * stride..][..stride]
    }

    /// A compute shader that runs case i in invocation i.
    fn source(&self) -> String {
        let Signature { name, parameters, returns } = &self.signature;
        let stride_in = Signature::scalars(self.signature.inputs()).len();
        let stride_out = Signature::scalars(self.signature.outputs()).len();
        let mut before = String::new();
        let mut arguments = Vec::new();
        let mut after = String::new();
        let (mut read, mut written) = (0, 0);
        let result = returns.map_or(String::new(), |kind| {
            after += &kind.write("words_out", "at_out", written, "result");
            written += kind.count;
            format!("{} result = ", kind.name)
        });
        for (i, Parameter { kind, out, .. }) in parameters.iter().enumerate() {
            if *out {
                before += &format!("    {} out_{i};\n", kind.name);
                after += &kind.write("words_out", "at_out", written, &format!("out_{i}"));
                written += kind.count;
                arguments.push(format!("out_{i}"));
            } else {
                arguments.push(kind.read("words_in", "at_in", read));
                read += kind.count;
            }
        }
        format!(
            "#version 450\n\
             #extension GL_GOOGLE_include_directive : require\n\
             #include \"{}\"\n\
             {}\n\
             layout(local_size_x = {GROUP}) in;\n\
             layout(set = 0, binding = 0, std430) readonly buffer Inputs {{ uint words_in[]; }};\n\
             layout(set = 0, binding = 1, std430) buffer Outputs {{ uint words_out[]; }};\n\
             layout(push_constant) uniform Push {{ uint cases; }};\n\
             void main() {{\n\
             \x20   uint i = gl_GlobalInvocationID.x;\n\
             \x20   if (i >= cases) return;\n\
             \x20   uint at_in = i * {stride_in}u;\n\
             \x20   uint at_out = i * {stride_out}u;\n\
             {before}    {result}{name}({});\n{after}}}\n",
            self.file,
            self.glue,
            arguments.join(", "),
        )
    }
}

/// Numbers, and tuples and arrays of them, as one flat list.
pub trait Flat {
    /// Appends the numbers in order.
    fn flatten(self, to: &mut Vec<f64>);
}

macro_rules! flat_number {
    ($($number:ty),*) => {$(
        impl Flat for $number {
            fn flatten(self, to: &mut Vec<f64>) {
                to.push(f64::from(self));
            }
        }
    )*};
}
flat_number!(f32, f64, i32, u32, bool);

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flatten(self, to: &mut Vec<f64>) {
        self.into_iter().for_each(|x| x.flatten(to));
    }
}

impl<T: Flat> Flat for Vec<T> {
    fn flatten(self, to: &mut Vec<f64>) {
        self.into_iter().for_each(|x| x.flatten(to));
    }
}

macro_rules! flat_tuple {
    ($($name:ident)*) => {
        impl<$($name: Flat),*> Flat for ($($name,)*) {
            #[allow(non_snake_case, unused_variables)]
            fn flatten(self, to: &mut Vec<f64>) {
                let ($($name,)*) = self;
                $($name.flatten(to);)*
            }
        }
    };
}
flat_tuple!();
flat_tuple!(A);
flat_tuple!(A B);
flat_tuple!(A B C);
flat_tuple!(A B C D);
flat_tuple!(A B C D E);
flat_tuple!(A B C D E F);
flat_tuple!(A B C D E F G);
flat_tuple!(A B C D E F G H);
