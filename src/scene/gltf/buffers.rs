//! Bytes: the .glb container, data URIs, and files beside the scene's own.

use super::Problem;
use super::json::{Root, at};
use crate::error::quoted;
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

/// The most that the files which hold a scene's buffers may hold together, so that a small file which
/// names large ones cannot fill the memory.
const MAX_BYTES: u64 = 4 << 30;

/// Padded or not: exporters differ.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Splits a file into its JSON and, for a .glb, its binary chunk. The content decides which of the two it is, not the
/// name.
pub(super) fn split(file: &[u8]) -> Result<(&[u8], Option<&[u8]>), Problem> {
    let Some(rest) = file.strip_prefix(b"glTF") else { return Ok((file, None)) };
    let (version, rest) = word(rest).ok_or("its .glb header is cut off")?;
    if version != 2 {
        return Err(format!("it is a .glb of version {version}; only version 2 is read"));
    }
    let (length, _) = word(rest).ok_or("its .glb header is cut off")?;
    let whole = file.get(..length as usize).ok_or_else(|| {
        format!("its .glb header claims {length} bytes, and the file has {}", file.len())
    })?;
    let mut rest = whole.get(12..).ok_or("its .glb header claims less than a header's 12 bytes")?;
    let mut json = None;
    while !rest.is_empty() {
        let (kind, chunk, after) = chunk(rest)?;
        match (json, &kind) {
            (None, b"JSON") => json = Some(chunk),
            (None, _) => return Err("its first .glb chunk is not JSON".into()),
            (Some(json), b"BIN\0") => return Ok((json, Some(chunk))),
            // Other chunks belong to extensions; glTF 2.0 §4.4.3.1 has clients ignore them.
            (Some(_), _) => {}
        }
        rest = after;
    }
    Ok((json.ok_or("its .glb container is empty")?, None))
}

fn word(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (word, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*word), rest))
}

type Chunk<'a> = ([u8; 4], &'a [u8], &'a [u8]);

fn chunk(bytes: &[u8]) -> Result<Chunk<'_>, Problem> {
    let (length, rest) = word(bytes).ok_or("a .glb chunk's header is cut off")?;
    let (kind, rest) = rest.split_first_chunk().ok_or("a .glb chunk's header is cut off")?;
    let length = length as usize;
    if length > rest.len() {
        return Err(format!(
            "a .glb chunk claims {length} bytes, and {} are left in the file",
            rest.len()
        ));
    }
    let (chunk, after) = rest.split_at(length);
    Ok((*kind, chunk, after))
}

/// The file's buffers, each read when it is first used: a buffer that only an animation needs is not opened.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    /// The .glb's binary chunk.
    chunk: Option<&'a [u8]>,
    folder: &'a Path,
    read: Vec<OnceCell<Rc<Vec<u8>>>>,
    /// The files by their canonical path: a file is read once, however many buffers name it, and in whatever way.
    files: RefCell<BTreeMap<PathBuf, Rc<Vec<u8>>>>,
    /// The bytes of all `files` together.
    total: Cell<u64>,
    /// What was decompressed.
    #[cfg(feature = "draco")]
    streams: super::draco::Streams,
    /// The buffer views that were decompressed.
    #[cfg(feature = "meshopt")]
    views: Vec<OnceCell<Vec<u8>>>,
    #[cfg(any(feature = "draco", feature = "meshopt"))]
    room: super::room::Room,
    /// The scene's own file, data URIs and all.
    own: usize,
}

impl<'a> Buffers<'a> {
    /// The buffers of a file of `own` bytes.
    pub fn new(root: &'a Root, own: usize, chunk: Option<&'a [u8]>, folder: &'a Path) -> Self {
        let read = root.buffers.iter().map(|_| OnceCell::new()).collect();
        Self {
            root,
            chunk,
            folder,
            read,
            files: RefCell::default(),
            total: Cell::new(0),
            #[cfg(feature = "draco")]
            streams: super::draco::Streams::new(root),
            #[cfg(feature = "meshopt")]
            views: root.buffer_views.iter().map(|_| OnceCell::new()).collect(),
            #[cfg(any(feature = "draco", feature = "meshopt"))]
            room: super::room::Room::default(),
            own,
        }
    }

    /// The number of bytes in memory: the scene file's, those of the buffer files read so far, and what their compressed
    /// parts decoded to.
    pub fn held(&self) -> u64 {
        #[cfg(any(feature = "draco", feature = "meshopt"))]
        return self.files_hold().saturating_add(self.room.taken());
        #[cfg(not(any(feature = "draco", feature = "meshopt")))]
        self.files_hold()
    }

    fn files_hold(&self) -> u64 {
        (self.own as u64).saturating_add(self.total.get())
    }

    /// The bytes of `bufferViews[index]`, and its stride; `owner` names the user in errors.
    pub fn view(
        &self,
        index: usize,
        owner: impl Fn() -> String,
    ) -> Result<(&[u8], Option<u64>), Problem> {
        let view = at(&self.root.buffer_views, index, "bufferViews", &owner)?;
        #[cfg(feature = "meshopt")]
        if let Some(of) = view.extensions.as_ref().and_then(|e| e.meshopt()) {
            return Ok((self.decompressed(index, of, view.byte_length)?, view.byte_stride));
        }
        let name = format!("bufferViews[{index}]");
        let bytes = self.range(&name, view.buffer, [view.byte_offset, view.byte_length])?;
        Ok((bytes, view.byte_stride))
    }

    /// What meshoptimizer compressed to `bufferViews[index]` of `length` bytes.
    #[cfg(feature = "meshopt")]
    fn decompressed(
        &self,
        index: usize,
        of: &super::extensions::Meshopt,
        length: u64,
    ) -> Result<&[u8], Problem> {
        let name = format!("the compression of bufferViews[{index}]");
        let cell = at(&self.views, index, "bufferViews", || name.clone())?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let stream = self.range(&name, of.buffer, [of.byte_offset, of.byte_length])?;
        let bytes = of.count.saturating_mul(of.byte_stride);
        let decoded = || {
            if bytes != length {
                return Err(format!("it decodes to {bytes} bytes, and the view has {length}"));
            }
            self.room.take(bytes, self.files_hold())?;
            super::meshopt::decoded(of, stream)
        };
        let decoded = decoded().map_err(|problem| format!("{name} is wrong: {problem}"))?;
        Ok(cell.get_or_init(|| decoded))
    }

    /// The bytes of `buffers[buffer]` from an offset on, as many as a length says; `name` is whose they are.
    fn range(
        &self,
        name: &str,
        buffer: usize,
        [offset, length]: [u64; 2],
    ) -> Result<&[u8], Problem> {
        let bytes = self.buffer(buffer, name)?;
        let end = offset.checked_add(length).and_then(|end| usize::try_from(end).ok());
        let range = usize::try_from(offset).ok().zip(end);
        range.and_then(|(start, end)| bytes.get(start..end)).ok_or_else(|| {
            format!(
                "{name} spans {length} bytes from byte {offset} of buffers[{buffer}], which holds {}",
                bytes.len()
            )
        })
    }

    /// The elements of an accessor that has none of its own, by its place among those of the root.
    #[cfg(feature = "draco")]
    pub fn decoded(&self, place: usize, owner: &dyn Fn() -> String) -> Result<&[u8], Problem> {
        let of = at(&self.root.compressed, place, "compressed parts", owner)?;
        let stream = || self.view(of.view, owner).map(|(bytes, _)| bytes);
        let room = (&self.room, self.files_hold());
        let elements = self.streams.elements(place, of, room, stream);
        elements.map_err(|problem| format!("{} cannot be decompressed: {problem}", owner()))
    }

    fn buffer(&self, index: usize, owner: &str) -> Result<&[u8], Problem> {
        let buffer = at(&self.root.buffers, index, "buffers", || owner.into())?;
        let cell = at(&self.read, index, "buffers", || owner.into())?;
        let bytes = match (&buffer.uri, cell.get()) {
            (_, Some(bytes)) => bytes.as_slice(),
            (Some(uri), None) => {
                let bytes = self.resource(uri);
                let bytes = bytes.map_err(|problem| format!("buffers[{index}]: {problem}"))?;
                cell.get_or_init(|| bytes).as_slice()
            }
            (None, None) => self.chunk.filter(|_| index == 0).ok_or_else(|| {
                format!("buffers[{index}] has no uri, and the file no binary chunk for it")
            })?,
        };
        // What follows the stated length is padding.
        usize::try_from(buffer.byte_length).ok().and_then(|n| bytes.get(..n)).ok_or_else(|| {
            format!(
                "buffers[{index}] states {} bytes and holds {}",
                buffer.byte_length,
                bytes.len()
            )
        })
    }

    /// The bytes of a data URI, or of a file beside the scene's.
    pub fn resource(&self, uri: &str) -> Result<Rc<Vec<u8>>, Problem> {
        match uri.strip_prefix("data:") {
            Some(data) => decode(data).map(Rc::new),
            None => self.file(uri),
        }
    }

    /// The bytes of a file beside the scene's.
    fn file(&self, uri: &str) -> Result<Rc<Vec<u8>>, Problem> {
        let path = beside(uri, self.folder)?;
        if let Some(bytes) = self.files.borrow().get(&path) {
            return Ok(Rc::clone(bytes));
        }
        let unreadable =
            |e: std::io::Error| format!("its file {} cannot be read: {e}", quoted(uri));
        let metadata = std::fs::metadata(&path).map_err(unreadable)?;
        // A pipe or a device could keep a reader forever, and a pipe already on opening.
        if !metadata.is_file() {
            return Err(format!("its uri {} is not a regular file", quoted(uri)));
        }
        let total = self.total.get().saturating_add(metadata.len());
        if total > MAX_BYTES {
            return Err(format!(
                "with its file {} the scene's buffers hold more than {} GiB together",
                quoted(uri),
                MAX_BYTES >> 30
            ));
        }
        self.total.set(total);
        let file = std::fs::File::open(&path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        let length = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
        bytes.try_reserve_exact(length).map_err(|e| unreadable(e.into()))?;
        file.take(metadata.len()).read_to_end(&mut bytes).map_err(unreadable)?;
        let bytes = Rc::new(bytes);
        self.files.borrow_mut().insert(path, Rc::clone(&bytes));
        Ok(bytes)
    }
}

/// The bytes of a data URI after its `data:`.
fn decode(data: &str) -> Result<Vec<u8>, Problem> {
    let encoded = data
        .split_once(',')
        .filter(|(header, _)| header.ends_with(";base64"))
        .map(|(_, encoded)| encoded)
        .ok_or("its data URI must read data:application/octet-stream;base64,…")?;
    let encoded: Cow<[u8]> = percent_decode_str(encoded).into();
    BASE64.decode(encoded).map_err(|e| format!("its data URI is not base64: {e}"))
}

/// The path of a relative URI, which must stay inside the scene's folder; without links, where there is
/// such a file.
fn beside(uri: &str, folder: &Path) -> Result<PathBuf, Problem> {
    let outside = || {
        format!(
            "its uri {} must be a relative path to a file in the scene's folder or below",
            quoted(uri)
        )
    };
    // A colon before the first slash ends a scheme (RFC 3986 §4.2); one in a file's name is escaped.
    if uri.split('/').next().is_some_and(|first| first.contains(':')) {
        return Err(outside());
    }
    let name = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("its uri {} is not UTF-8 once its % escapes are read", quoted(uri)))?;
    let relative = Path::new(name.as_ref());
    let inside = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
    if name.is_empty() || !relative.components().all(inside) {
        return Err(outside());
    }
    let path = folder.join(relative);
    // A link could still lead out. What does not exist is left to the reader's own sentence.
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(real), Ok(real_folder)) if !real.starts_with(&real_folder) => Err(outside()),
        (Ok(real), Ok(_)) => Ok(real),
        _ => Ok(path),
    }
}
