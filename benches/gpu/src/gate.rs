//! What no shader and no pass may be: the rules, and the exceptions that `benches/gpu/exceptions.txt` gives reasons for.

use crate::compiled::Compiled;
use crate::families::Family;
use crate::frame::FramePass;
use crate::table::by_module;
use std::collections::BTreeMap;

/// The fewest waves that a SIMD of RDNA2 must hold of a shader, of 16.
pub const WAVES: u64 = 8;

/// The most bytes of code, RDNA's instruction cache.
pub const CODE: u64 = 32 << 10;

/// The most words that an invocation of a pass of one workgroup may have to read: a quarter of a thousand items of one word,
/// some 80,000 cycles where each waits for memory by itself.
pub const WORDS: u64 = 250;

/// An exception to a rule, with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Exception {
    /// The number that is allowed instead.
    pub number: u64,
    /// Why.
    pub why: String,
}

/// The exceptions by rule (`waves`, `code` or `words`) and by the shader or pass.
pub type Exceptions = BTreeMap<(String, String), Exception>;

/// Reads exceptions: a line each of rule, shader or pass, number and reason; `#` begins a comment.
///
/// # Errors
/// A sentence with the first line that is none.
pub fn exceptions(text: &str) -> Result<Exceptions, String> {
    let lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    lines
        .map(|line| {
            let mut words = line.split_whitespace();
            let (rule, name, number) = (words.next(), words.next(), words.next());
            let why = words.collect::<Vec<_>>().join(" ");
            let number = number.and_then(|number| number.parse().ok());
            match (rule, name, number) {
                (Some(rule @ ("waves" | "code" | "words")), Some(name), Some(number))
                    if !why.is_empty() =>
                {
                    Ok(((rule.into(), name.into()), Exception { number, why }))
                }
                _ => Err(format!("\"{line}\" is not a rule, a name, a number and a reason")),
            }
        })
        .collect()
}

/// What a family's shaders break: no vector register may be spilled and no scratch memory be used; on RDNA2 a SIMD must hold
/// [`WAVES`] of each, and its code must fit into [`CODE`]. An exception that is no longer needed breaks its rule as well.
pub fn broken(family: &Family, compiled: &Compiled, exceptions: &Exceptions) -> Vec<String> {
    let mut broken = Vec::new();
    for (module, shader) in by_module(compiled) {
        let tell = |what: String| format!("{module} on {}: {what}", family.architecture);
        let (spilled, scratch) = (shader.spilled(), shader.figure("Scratch size"));
        if spilled + scratch > 0 {
            broken.push(tell(format!("{spilled} registers spilled, {scratch} bytes of scratch")));
        }
        let allowed =
            |rule: &str| exceptions.get(&(rule.to_owned(), module.to_owned())).map(|e| e.number);
        if family.architecture != "RDNA2" {
            continue;
        }
        let waves = shader.waves();
        let least = allowed("waves").unwrap_or(WAVES);
        if waves < least {
            broken.push(tell(format!("{waves} waves, where {least} must fit")));
        }
        let most = allowed("code").unwrap_or(CODE);
        if shader.code() > most {
            broken.push(tell(format!("{} bytes of code, more than {most}", shader.code())));
        }
        let needless = |rule: &str, is: bool| {
            is.then(|| tell(format!("its exception to the rule of {rule} is not needed")))
        };
        broken.extend(needless("waves", allowed("waves").is_some_and(|n| waves > n)));
        broken.extend(needless("code", allowed("code").is_some() && shader.code() <= CODE));
    }
    broken
}

/// The passes of a frame that one workgroup works at for long: each of its invocations has more than [`WORDS`] words of what
/// the pass reads. An exception that a pass does not need breaks the rule as well.
pub fn serial(passes: &[FramePass], exceptions: &Exceptions) -> Vec<String> {
    let of = |pass: &FramePass| {
        let words = pass.serial_words?;
        let allowed = exceptions.get(&("words".to_owned(), pass.name.to_owned()));
        let most = allowed.map_or(WORDS, |e| e.number);
        if words <= WORDS && allowed.is_some() {
            return Some(format!(
                "{}: its exception to the rule of words is not needed",
                pass.name
            ));
        }
        (words > most).then(|| {
            format!("{}: an invocation of its one workgroup reads up to {words} words, more than {most}", pass.name)
        })
    };
    passes.iter().filter_map(of).collect()
}
