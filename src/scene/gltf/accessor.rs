//! Accessors whose every claim is checked against the bytes before one is read.

use super::Problem;
use super::buffers::Buffers;
use super::json::{self, Root, at};

/// The most elements of an accessor that has no bytes of its own and is zero wherever its sparse
/// part says nothing: nothing else bounds the count.
const MAX_ZEROS: u64 = 1 << 16;

const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Equally long elements, one every `stride` bytes.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    /// `count` elements of `size` bytes from `offset` on, all of them inside `bytes`.
    fn new(
        bytes: &'a [u8],
        stride: Option<u64>,
        size: usize,
        offset: u64,
        count: u64,
        owner: impl Fn() -> String,
    ) -> Result<Self, Problem> {
        let stride = stride.unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(format!(
                "{} has elements of {size} bytes in a bufferView with a byteStride of {stride}",
                owner()
            ));
        }
        let end = match count.checked_sub(1) {
            Some(last) => last
                .checked_mul(stride)
                .and_then(|n| n.checked_add(offset))
                .and_then(|n| n.checked_add(size as u64)),
            None => Some(offset),
        };
        let held = bytes.len();
        let bytes = end
            .filter(|end| *end <= held as u64)
            .and_then(|_| bytes.get(usize::try_from(offset).ok()?..))
            .ok_or_else(|| {
                format!(
                    "{} needs {count} elements of {size} bytes, {stride} apart, from byte {offset} \
                     of its bufferView, which holds {held} bytes",
                    owner()
                )
            })?;
        // A stride too long for usize belongs to a single element, which needs none.
        Ok(Self { bytes, stride: usize::try_from(stride).unwrap_or(size), size })
    }

    fn get(&self, i: usize) -> Option<&'a [u8]> {
        let start = i.checked_mul(self.stride)?;
        self.bytes.get(start..start.checked_add(self.size)?)
    }
}

/// Unsigned integers of one, two or four bytes.
#[derive(Clone, Copy)]
struct Integers<'a>(Elements<'a>);

impl Integers<'_> {
    fn get(&self, i: usize) -> Option<u32> {
        integer(self.0.get(i)?)
    }
}

fn integer(bytes: &[u8]) -> Option<u32> {
    match *bytes {
        [a] => Some(u32::from(a)),
        [a, b] => Some(u32::from(u16::from_le_bytes([a, b]))),
        [a, b, c, d] => Some(u32::from_le_bytes([a, b, c, d])),
        _ => None,
    }
}

/// What an accessor's numbers are: `decoded` where they were compressed.
fn component_of(accessor: &json::Accessor, decoded: u32) -> u32 {
    if accessor.compressed.is_some() { decoded } else { accessor.component_type }
}

fn integer_size(component: u32) -> Option<usize> {
    match component {
        U8 => Some(1),
        U16 => Some(2),
        U32 => Some(4),
        _ => None,
    }
}

/// Elements that replace others.
struct Overlay<'a> {
    /// The indices of the replaced elements, in rising order.
    indices: Integers<'a>,
    values: Elements<'a>,
    count: usize,
}

impl<'a> Overlay<'a> {
    fn get(&self, i: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low.midpoint(high);
            if (self.indices.get(middle)? as usize) < i {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        let found = low < self.count && self.indices.get(low)? as usize == i;
        found.then(|| self.values.get(low)).flatten()
    }
}

/// A checked accessor: `count` elements, read one at a time where they lie.
struct View<'a> {
    /// `None` where all elements are zero but for the overlay's.
    base: Option<Elements<'a>>,
    overlay: Option<Overlay<'a>>,
    count: usize,
}

impl<'a> View<'a> {
    fn open(
        accessor: &json::Accessor,
        size: usize,
        buffers: &'a Buffers<'_>,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let base = match accessor.buffer_view {
            #[cfg(feature = "draco")]
            _ if let Some(place) = accessor.compressed => {
                let bytes = buffers.decoded(place, owner)?;
                let (offset, count) = (accessor.byte_offset, accessor.count);
                Some(Elements::new(bytes, None, size, offset, count, owner)?)
            }
            Some(index) => {
                let (bytes, stride) = buffers.view(index, owner)?;
                let (offset, count) = (accessor.byte_offset, accessor.count);
                Some(Elements::new(bytes, stride, size, offset, count, owner)?)
            }
            None if accessor.sparse.is_none() => {
                return Err(format!(
                    "{} has no bufferView, and no compression that is read",
                    owner()
                ));
            }
            None if accessor.count > MAX_ZEROS => {
                return Err(format!(
                    "{} claims {} elements without a bufferView; at most {MAX_ZEROS} are taken",
                    owner(),
                    accessor.count
                ));
            }
            None => None,
        };
        let overlay = match &accessor.sparse {
            Some(sparse) => {
                let owner = || format!("the sparse part of {}", owner());
                Some(overlay(sparse, accessor.count, size, buffers, &owner)?)
            }
            None => None,
        };
        let count = usize::try_from(accessor.count)
            .ok()
            .filter(|count| u32::try_from(*count).is_ok())
            .ok_or_else(|| format!("{} claims {} elements", owner(), accessor.count))?;
        Ok(Self { base, overlay, count })
    }

    /// The bytes of element `i`; `Some(&[])` stands for zero, `None` for an element past the end.
    fn get(&self, i: usize) -> Option<&'a [u8]> {
        if i >= self.count {
            return None;
        }
        if let Some(replaced) = self.overlay.as_ref().and_then(|o| o.get(i)) {
            return Some(replaced);
        }
        self.base.map_or(Some(&[][..]), |base| base.get(i))
    }
}

fn overlay<'a>(
    sparse: &json::Sparse,
    count: u64,
    size: usize,
    buffers: &'a Buffers<'_>,
    owner: &dyn Fn() -> String,
) -> Result<Overlay<'a>, Problem> {
    if sparse.count > count {
        return Err(format!("{} replaces {} elements of {count}", owner(), sparse.count));
    }
    let component = sparse.indices.component_type;
    let index_size = integer_size(component).ok_or_else(|| {
        format!("{} has indices of componentType {component}; write 5121, 5123 or 5125", owner())
    })?;
    // Sparse indices and values are packed: their bufferViews must not have a stride.
    let (bytes, _) = buffers.view(sparse.indices.buffer_view, owner)?;
    let offset = sparse.indices.byte_offset;
    let indices = Integers(Elements::new(bytes, None, index_size, offset, sparse.count, owner)?);
    let (bytes, _) = buffers.view(sparse.values.buffer_view, owner)?;
    let values = Elements::new(bytes, None, size, sparse.values.byte_offset, sparse.count, owner)?;
    let overlay = Overlay { indices, values, count: sparse.count as usize };
    // The search for an element relies on their order. That is the accessor's, and looked at once: many
    // primitives may share it.
    if sparse.in_order.get() {
        return Ok(overlay);
    }
    let mut past = None;
    for i in 0..overlay.count {
        let index = indices.get(i);
        if index <= past || index.is_none_or(|index| u64::from(index) >= count) {
            return Err(format!(
                "{} must list its indices in rising order and below {count}",
                owner()
            ));
        }
        past = index;
    }
    sparse.in_order.set(true);
    Ok(overlay)
}

/// What a number of a vector is written as.
#[derive(Clone, Copy)]
struct Component {
    kind: u32,
    size: usize,
    /// Whether the largest integer stands for 1.
    normalized: bool,
}

impl Component {
    /// The number in the first of these bytes; 0 where there are none.
    fn number(self, bytes: &[u8]) -> f32 {
        let (number, most) = match (self.kind, bytes) {
            (F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
            (I8, &[a, ..]) => (f32::from(a.cast_signed()), f32::from(i8::MAX)),
            (U8, &[a, ..]) => (f32::from(a), f32::from(u8::MAX)),
            (I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), f32::from(i16::MAX)),
            (U16, &[a, b, ..]) => (f32::from(u16::from_le_bytes([a, b])), f32::from(u16::MAX)),
            _ => return 0.0,
        };
        // The least integer is one further from 0 than the largest, and means the same as its neighbour.
        if self.normalized { (number / most).max(-1.0) } else { number }
    }
}

/// `N` numbers an element: positions, normals, how instances stand, or with 16 numbers, matrices. They are 32-bit floats, or as an extension allows,
/// integers of one or two bytes.
pub(super) struct Vectors<'a, const N: usize> {
    view: View<'a>,
    component: Component,
}

impl<'a, const N: usize> Vectors<'a, N> {
    /// Opens `accessors[index]`, whose numbers may be `integers` too; `owner` names the user in errors, as in
    /// `the POSITION of mesh "bunny"`.
    pub fn open(
        root: &Root,
        buffers: &'a Buffers<'_>,
        index: usize,
        integers: bool,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let accessor = at(&root.accessors, index, "accessors", owner)?;
        let kind = component_of(accessor, F32);
        let size = match kind {
            F32 => Some(4),
            I8 | U8 if integers => Some(1),
            I16 | U16 if integers => Some(2),
            _ => None,
        };
        let form = match N {
            1 => "SCALAR".to_string(),
            16 => "MAT4".to_string(),
            _ => format!("VEC{N}"),
        };
        let Some(size) = size.filter(|_| accessor.kind == form) else {
            return Err(format!(
                "{} is in accessors[{index}], which holds {} of componentType {kind}; it must hold \
                 {form} of 5126 (32-bit floats){}",
                owner(),
                crate::error::quoted(&accessor.kind),
                if integers { ", or of 5120 to 5123 (integers)" } else { "" }
            ));
        };
        let component = Component { kind, size, normalized: accessor.normalized };
        let view = View::open(accessor, N * size, buffers, &named(index, owner))?;
        Ok(Self { view, component })
    }

    pub fn len(&self) -> usize {
        self.view.count
    }

    pub fn get(&self, i: usize) -> Option<[f32; N]> {
        let bytes = self.view.get(i)?;
        let at = |k: usize| bytes.get(self.component.size * k..).unwrap_or_default();
        Some(std::array::from_fn(|k| self.component.number(at(k))))
    }
}

/// One unsigned integer an element: a primitive's indices.
pub(super) struct Indices<'a>(View<'a>);

impl<'a> Indices<'a> {
    /// Opens `accessors[index]`; `owner` names the user in errors.
    pub fn open(
        root: &Root,
        buffers: &'a Buffers<'_>,
        index: usize,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let accessor = at(&root.accessors, index, "accessors", owner)?;
        let size = integer_size(component_of(accessor, U32)).filter(|_| accessor.kind == "SCALAR");
        let size = size.ok_or_else(|| {
            format!(
                "{} are in accessors[{index}], which holds {} of componentType {}; it must hold \
                 SCALAR of 5121, 5123 or 5125 (unsigned integers)",
                owner(),
                crate::error::quoted(&accessor.kind),
                accessor.component_type
            )
        })?;
        View::open(accessor, size, buffers, &named(index, owner)).map(Self)
    }

    pub fn len(&self) -> usize {
        self.0.count
    }

    pub fn get(&self, i: usize) -> Option<u32> {
        self.0.get(i).map(|bytes| integer(bytes).unwrap_or(0))
    }
}

fn named(index: usize, owner: &dyn Fn() -> String) -> impl Fn() -> String {
    move || format!("accessors[{index}], {},", owner())
}
