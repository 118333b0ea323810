//! A GLSL function's prototype, read so that a shader which calls it can be written.

/// The scalar that a type is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    Float,
    Int,
    Uint,
    Bool,
}

impl Scalar {
    /// Its bits as 32-bit words go through the buffers: `number` as the nearest of this type.
    pub fn encode(self, number: f64) -> u32 {
        match self {
            Self::Float => (number as f32).to_bits(),
            Self::Int => (number as i32).cast_unsigned(),
            Self::Uint => number as u32,
            Self::Bool => u32::from(number != 0.0),
        }
    }

    /// The number that a word stands for; exact.
    pub fn decode(self, word: u32) -> f64 {
        match self {
            Self::Float => f64::from(f32::from_bits(word)),
            Self::Int => f64::from(word.cast_signed()),
            Self::Uint | Self::Bool => f64::from(word),
        }
    }
}

/// A parameter or result: `scalar` × `count`, called `name` in GLSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Type {
    pub name: &'static str,
    pub scalar: Scalar,
    pub count: usize,
}

/// The types that can go in and out.
const TYPES: [Type; 15] = [
    Type { name: "float", scalar: Scalar::Float, count: 1 },
    Type { name: "vec2", scalar: Scalar::Float, count: 2 },
    Type { name: "vec3", scalar: Scalar::Float, count: 3 },
    Type { name: "vec4", scalar: Scalar::Float, count: 4 },
    Type { name: "mat3", scalar: Scalar::Float, count: 9 },
    Type { name: "mat4", scalar: Scalar::Float, count: 16 },
    Type { name: "int", scalar: Scalar::Int, count: 1 },
    Type { name: "ivec2", scalar: Scalar::Int, count: 2 },
    Type { name: "ivec3", scalar: Scalar::Int, count: 3 },
    Type { name: "ivec4", scalar: Scalar::Int, count: 4 },
    Type { name: "uint", scalar: Scalar::Uint, count: 1 },
    Type { name: "uvec2", scalar: Scalar::Uint, count: 2 },
    Type { name: "uvec3", scalar: Scalar::Uint, count: 3 },
    Type { name: "uvec4", scalar: Scalar::Uint, count: 4 },
    Type { name: "bool", scalar: Scalar::Bool, count: 1 },
];

impl Type {
    fn parse(name: &str) -> Result<Self, String> {
        TYPES.iter().find(|known| known.name == name).copied().ok_or_else(|| {
            let known: Vec<_> = TYPES.iter().map(|t| t.name).collect();
            format!("type {name} cannot be passed; {} can", known.join(", "))
        })
    }

    /// GLSL that builds a value of it from words `array[at]`, `array[at + 1]` ….
    pub fn read(self, array: &str, at: &str, offset: usize) -> String {
        let word = |i: usize| format!("{array}[{at} + {}u]", offset + i);
        let scalar = |i: usize| match self.scalar {
            Scalar::Float => format!("uintBitsToFloat({})", word(i)),
            Scalar::Int => format!("int({})", word(i)),
            Scalar::Uint => word(i),
            Scalar::Bool => format!("({} != 0u)", word(i)),
        };
        let scalars: Vec<_> = (0..self.count).map(scalar).collect();
        format!("{}({})", self.name, scalars.join(", "))
    }

    /// GLSL statements that store the variable `value` of it.
    pub fn write(self, array: &str, at: &str, offset: usize, value: &str) -> String {
        let mut text = String::new();
        for i in 0..self.count {
            let part = match (self.name, self.count) {
                (_, 1) => value.to_owned(),
                ("mat3", _) => format!("{value}[{}][{}]", i / 3, i % 3),
                ("mat4", _) => format!("{value}[{}][{}]", i / 4, i % 4),
                _ => format!("{value}[{i}]"),
            };
            let word = match self.scalar {
                Scalar::Float => format!("floatBitsToUint({part})"),
                _ => format!("uint({part})"),
            };
            text += &format!("    {array}[{at} + {}u] = {word};\n", offset + i);
        }
        text
    }
}

/// A parameter of a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    pub name: String,
    pub kind: Type,
    /// Whether it is an `out` parameter, which is a result.
    pub out: bool,
}

/// A function's name, parameters and results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    pub name: String,
    /// In order.
    pub parameters: Vec<Parameter>,
    /// `None` for `void`.
    pub returns: Option<Type>,
}

impl Signature {
    /// Reads a prototype such as `float f(vec3 a, uint n, out float slope)`.
    pub fn parse(prototype: &str) -> Result<Self, String> {
        let shape = || format!("\"{prototype}\" is not of the form `float f(vec3 a, out float b)`");
        let (head, rest) = prototype.split_once('(').ok_or_else(shape)?;
        let list = rest.trim_end().strip_suffix(')').ok_or_else(shape)?;
        let [returns, name] = head.split_whitespace().collect::<Vec<_>>()[..] else {
            return Err(shape());
        };
        let parameters = list.split(',').map(str::trim).filter(|text| !text.is_empty());
        let parameter = |kind: &str, name: &str, out| {
            Ok(Parameter { name: name.to_owned(), kind: Type::parse(kind)?, out })
        };
        let parameters = parameters
            .map(|text| match text.split_whitespace().collect::<Vec<_>>()[..] {
                [kind, name] | ["in", kind, name] => parameter(kind, name, false),
                ["out", kind, name] => parameter(kind, name, true),
                _ => Err(shape()),
            })
            .collect::<Result<_, _>>()?;
        let returns = if returns == "void" { None } else { Some(Type::parse(returns)?) };
        Ok(Self { name: name.to_owned(), parameters, returns })
    }

    /// What goes in, in order.
    pub fn inputs(&self) -> impl Iterator<Item = Type> + '_ {
        self.parameters.iter().filter(|p| !p.out).map(|p| p.kind)
    }

    /// What comes out: the returned value, then the `out` parameters in order.
    pub fn outputs(&self) -> impl Iterator<Item = Type> + '_ {
        let out = self.parameters.iter().filter(|p| p.out).map(|p| p.kind);
        self.returns.into_iter().chain(out)
    }

    /// A case's inputs, each by its parameter's name, as in `a = 0.5, b = [1.0, 0.0]`.
    pub fn named_inputs(&self, numbers: &[f64]) -> String {
        let names = self.parameters.iter().filter(|p| !p.out).map(|p| p.name.as_str());
        named(names.zip(self.inputs()), numbers)
    }

    /// A case's results: the returned value, and each `out` parameter by its name.
    pub fn named_outputs(&self, numbers: &[f64]) -> String {
        let names = self.parameters.iter().filter(|p| p.out).map(|p| p.name.as_str());
        let names = self.returns.map(|_| "returned").into_iter().chain(names);
        named(names.zip(self.outputs()), numbers)
    }

    /// The scalar of each word of one case.
    pub fn scalars(types: impl Iterator<Item = Type>) -> Vec<Scalar> {
        types.flat_map(|t| std::iter::repeat_n(t.scalar, t.count)).collect()
    }
}

fn named<'a>(values: impl Iterator<Item = (&'a str, Type)>, mut numbers: &[f64]) -> String {
    let mut texts = Vec::new();
    for (name, kind) in values {
        let (own, rest) = numbers.split_at(kind.count);
        numbers = rest;
        texts.push(match own {
            [number] => format!("{name} = {number:?}"),
            _ => format!("{name} = {own:?}"),
        });
    }
    texts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_prototypes() {
        let s = Signature::parse("void f(in vec2 a, out mat4 m, uint n)").unwrap();
        assert_eq!(s.name, "f");
        assert_eq!(s.inputs().map(|t| t.name).collect::<Vec<_>>(), ["vec2", "uint"]);
        assert_eq!(s.outputs().map(|t| t.name).collect::<Vec<_>>(), ["mat4"]);
        assert_eq!(Signature::parse("float g()").unwrap().inputs().count(), 0);
        assert!(Signature::parse("float g").unwrap_err().contains("form"));
        assert!(Signature::parse("sampler2D g()").unwrap_err().contains("sampler2D"));
    }

    #[test]
    fn numbers_are_named() {
        let s = Signature::parse("float f(vec2 a, uint n, out vec2 slope)").unwrap();
        assert_eq!(s.named_inputs(&[0.5, 1.0, 3.0]), "a = [0.5, 1.0], n = 3.0");
        assert_eq!(s.named_outputs(&[2.0, 0.25, -1.0]), "returned = 2.0, slope = [0.25, -1.0]");
        let s = Signature::parse("void f(float a, out float b)").unwrap();
        assert_eq!(s.named_outputs(&[2.0]), "b = 2.0");
    }

    #[test]
    fn words_keep_their_numbers() {
        for (scalar, number) in [
            (Scalar::Float, f64::from(-0.1_f32)),
            (Scalar::Int, -7.0),
            (Scalar::Uint, 4_294_967_295.0),
            (Scalar::Bool, 1.0),
        ] {
            assert_eq!(scalar.decode(scalar.encode(number)), number);
        }
    }
}
