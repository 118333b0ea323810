//! Accessors whose every claim is checked against the bytes before one is read.

use super::Problem;
use super::buffers::Buffers;
use super::json::{self, Root, at};

/// The most elements of an accessor that has no bytes of its own and is zero wherever its sparse
/// part says nothing: nothing else bounds the count.
const MAX_ZEROS: u64 = 1 << 16;

const U8: u32 = 5121;
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
            Some(index) => {
                let (bytes, stride) = buffers.view(index, owner)?;
                let (offset, count) = (accessor.byte_offset, accessor.count);
                Some(Elements::new(bytes, stride, size, offset, count, owner)?)
            }
            None if accessor.sparse.is_none() => {
                return Err(format!(
                    "{} has no bufferView (compressed meshes are not supported)",
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

/// Three 32-bit floats an element: positions or normals.
pub(super) struct Vectors<'a>(View<'a>);

impl<'a> Vectors<'a> {
    /// Opens `accessors[index]`; `owner` names the user in errors, as in `the POSITION of mesh "bunny"`.
    pub fn open(
        root: &Root,
        buffers: &'a Buffers<'_>,
        index: usize,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let accessor = at(&root.accessors, index, "accessors", owner)?;
        if (accessor.component_type, accessor.kind.as_str()) != (F32, "VEC3") {
            return Err(format!(
                "{} is in accessors[{index}], which holds {} of componentType {}; it must hold \
                 VEC3 of 5126 (32-bit floats)",
                owner(),
                crate::error::quoted(&accessor.kind),
                accessor.component_type
            ));
        }
        View::open(accessor, 12, buffers, &named(index, owner)).map(Self)
    }

    pub fn len(&self) -> usize {
        self.0.count
    }

    pub fn get(&self, i: u32) -> Option<[f32; 3]> {
        let bytes = self.0.get(i as usize)?;
        let component =
            |k: usize| bytes.get(4 * k..)?.first_chunk().map(|b: &[u8; 4]| f32::from_le_bytes(*b));
        Some([0, 1, 2].map(|k| component(k).unwrap_or(0.0)))
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
        let size = integer_size(accessor.component_type).filter(|_| accessor.kind == "SCALAR");
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
