//! JSON broken with its structure known: values of other types, keys of other members, entries gone or
//! there again, lists in lists, numbers at the edges; and broken as text.

use super::seed::{ODD_INTEGERS, Random};
use std::ops::Range;

/// A JSON text without white space, and where its values are.
pub struct Json {
    pub text: Vec<u8>,
    values: Vec<Value>,
}

struct Value {
    /// Where it stands.
    range: Range<usize>,
    /// Where its entry of a list or an object stands, with its key if it has one.
    entry: Range<usize>,
    in_object: bool,
}

impl Json {
    pub fn new(text: String) -> Self {
        let text = text.into_bytes();
        let mut values = Vec::new();
        let end = scan(&text, 0, 0, false, &mut values);
        assert_eq!(end, text.len());
        Self { text, values }
    }

    /// The text with so many changes, fewer where two would change the same.
    pub fn changed(&self, changes: usize, random: &mut Random) -> Vec<u8> {
        let mut edits: Vec<_> = (0..changes).map(|_| self.edit(random)).collect();
        edits.sort_by_key(|(range, _)| range.start);
        let mut text = Vec::with_capacity(2 * self.text.len());
        let mut done = 0;
        for (range, new) in edits {
            if let Some(before) = self.text.get(done..range.start) {
                text.extend(before);
                text.extend(new);
                done = range.end;
            }
        }
        text.extend(&self.text[done..]);
        text
    }

    /// What to put in the place of what.
    fn edit(&self, random: &mut Random) -> (Range<usize>, Vec<u8>) {
        let value = random.pick(&self.values);
        let Value { range, entry, in_object } = value;
        let bytes = |range: &Range<usize>| &self.text[range.clone()];
        // Indices, nodes, whole lists.
        let elsewhere = bytes(&random.pick(&self.values).range);
        match random.below(10) {
            0 => (range.clone(), random.pick(&OTHERS).as_bytes().to_vec()),
            1 => (range.clone(), elsewhere.to_vec()),
            // Numbers are where lengths, counts and indices live.
            2..=5 => {
                let scalars =
                    || self.values.iter().filter(|v| is_number(&self.text[v.range.start]));
                let nth = random.below(scalars().count().max(1));
                let range = scalars().nth(nth).map_or(0..0, |v| v.range.clone());
                (range, number(random).into_bytes())
            }
            6 => {
                let comma = usize::from(self.text.get(entry.end) == Some(&b','));
                (entry.start..entry.end + comma, Vec::new())
            }
            7 => {
                let key =
                    if *in_object { format!("\"{}\":", random.pick(&KEYS)) } else { String::new() };
                match random.below(2) {
                    0 => (entry.start..range.start, key.into_bytes()),
                    _ => {
                        let more = [key.as_bytes(), elsewhere, b","].concat();
                        (entry.start..entry.start, more)
                    }
                }
            }
            8 => {
                let times = random.below(REPEATS);
                (entry.end..entry.end, [b",", bytes(entry)].concat().repeat(times))
            }
            _ => {
                let depth = *random.pick(&[1, 2, 120, 127, 128, 129]);
                let [open, close] = *random.pick(&[["[", "]"], [r#"{"extras":"#, "}"]]);
                let (open, close) = (open.repeat(depth), close.repeat(depth));
                (range.clone(), [open.as_bytes(), bytes(range), close.as_bytes()].concat())
            }
        }
    }
}

/// How often an entry is repeated at most.
const REPEATS: usize = 50;

/// What is of another type than most.
const OTHERS: [&str; 14] = [
    "null",
    "true",
    "-1",
    "0.5",
    r#""""#,
    r#""VEC3""#,
    r#""SCALAR""#,
    r#""a.bin""#,
    r#""data:;base64,AAAA""#,
    "[]",
    "[[0]]",
    "[0,0,0]",
    "{}",
    r#"{"0":0}"#,
];

/// Keys that mean something somewhere, and so may stand where they mean something else.
const KEYS: [&str; 24] = [
    "POSITION",
    "NORMAL",
    "accessors",
    "area_light",
    "bufferView",
    "buffer",
    "byteOffset",
    "byteStride",
    "camera",
    "children",
    "corners",
    "count",
    "extras",
    "indices",
    "length",
    "matrix",
    "mesh",
    "mode",
    "nodes",
    "radius",
    "scale",
    "scene",
    "sparse",
    "uri",
];

/// A small number, which is often an index that leads somewhere, or an odd one.
fn number(random: &mut Random) -> String {
    const ODD: [&str; 14] = [
        "-1",
        "-0",
        "0.5",
        "1e-300",
        "1e9",
        "1e39",
        "1e300",
        "1e999",
        "5121",
        "5123",
        "5125",
        "24",
        "18446744073709551616",
        "NaN",
    ];
    match random.below(4) {
        0 | 1 => random.below(8).to_string(),
        2 => random.pick(&ODD_INTEGERS).to_string(),
        _ => (*random.pick(&ODD)).into(),
    }
}

fn is_number(first: &u8) -> bool {
    first.is_ascii_digit() || *first == b'-'
}

/// Notes the value that begins here and those in it; says where it ends. `entry` is where its key begins,
/// if it has one, and else where it does.
fn scan(
    text: &[u8],
    entry: usize,
    start: usize,
    in_object: bool,
    values: &mut Vec<Value>,
) -> usize {
    let nth = values.len();
    values.push(Value { range: start..start, entry: entry..start, in_object });
    let mut at = start + 1;
    match text[start] {
        open @ (b'{' | b'[') => {
            while !matches!(text[at], b'}' | b']') {
                let entry = at;
                if open == b'{' {
                    at = string_end(text, at) + 1;
                }
                at = scan(text, entry, at, open == b'{', values);
                at += usize::from(text[at] == b',');
            }
            at += 1;
        }
        b'"' => at = string_end(text, start),
        _ => at += text[at..].iter().take_while(|b| !b",]}".contains(b)).count(),
    }
    values[nth].range.end = at;
    values[nth].entry.end = at;
    at
}

/// Behind the closing quote of the string that begins here.
fn string_end(text: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while text[at] != b'"' {
        at += 1 + usize::from(text[at] == b'\\');
    }
    at + 1
}

/// Breaks a text as such: it may be no JSON any more.
pub fn break_text(text: &mut Vec<u8>, random: &mut Random) {
    match random.below(3) {
        0 => {
            for _ in 0..=random.below(4) {
                let (to, from) = (random.below(text.len().max(1)), random.below(text.len().max(1)));
                // A byte from elsewhere keeps more of it readable.
                let new = [random.next() as u8, *text.get(from).unwrap_or(&0)];
                if let Some(byte) = text.get_mut(to) {
                    *byte = *random.pick(&new);
                }
            }
        }
        1 => {
            let end = random.below(text.len() + 1);
            text.drain(end.saturating_sub(random.below(40))..end);
        }
        // Deep, and most often never closed.
        _ => {
            let at = random.below(text.len() + 1);
            let open = *random.pick(&["[", "{\"a\":", "\"", "{\"children\":["]);
            text.splice(at..at, open.repeat(*random.pick(&[1, 127, 128, 3000])).into_bytes());
        }
    }
}
