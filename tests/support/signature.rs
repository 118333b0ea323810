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

/// A function's name, parameters and results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    pub name: String,
    /// In order; `true` for an `out` parameter, which is a result.
    pub parameters: Vec<(Type, bool)>,
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
        let parameters = parameters
            .map(|text| match text.split_whitespace().collect::<Vec<_>>()[..] {
                [kind, _] | ["in", kind, _] => Ok((Type::parse(kind)?, false)),
                ["out", kind, _] => Ok((Type::parse(kind)?, true)),
                _ => Err(shape()),
            })
            .collect::<Result<_, _>>()?;
        let returns = if returns == "void" { None } else { Some(Type::parse(returns)?) };
        Ok(Self { name: name.to_owned(), parameters, returns })
    }

    /// What goes in, in order.
    pub fn inputs(&self) -> impl Iterator<Item = Type> + '_ {
        self.parameters.iter().filter(|(_, out)| !out).map(|(kind, _)| *kind)
    }

    /// What comes out: the returned value, then the `out` parameters in order.
    pub fn outputs(&self) -> impl Iterator<Item = Type> + '_ {
        let out = self.parameters.iter().filter(|(_, out)| *out).map(|(kind, _)| *kind);
        self.returns.into_iter().chain(out)
    }

    /// The scalar of each word of one case.
    pub fn scalars(types: impl Iterator<Item = Type>) -> Vec<Scalar> {
        types.flat_map(|t| std::iter::repeat_n(t.scalar, t.count)).collect()
    }
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
