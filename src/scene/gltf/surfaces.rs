//! How much of the light the surfaces of a material stop, and where, as their alpha and their transmission say.
//!
//! What is wrong with a material or a texture stops no scene, and ends as a note.

use super::Problem;
use super::buffers::Buffers;
use super::document::{Document, item};
use super::emissive::Emission;
use super::extensions::RestOfMaterial;
use super::images::{self, Channel, Plane, Room};
use super::json::at;
use super::notes::Notes;
use super::placing::Placing;
use crate::scene::{OpacityMap, Wrap};
use gltf::json::material::AlphaMode;
use gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Image, Material, Texture};
use serde_json::Value;
use std::collections::BTreeMap;
use std::rc::Rc;

/// What `alphaMode` `MASK` cuts at where the material does not say.
const CUTOFF: f32 = 0.5;

/// How much light a surface stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Cover {
    /// All of it.
    #[default]
    Whole,
    /// Less in places that are not known.
    Unknown,
    /// As much as the scene's opacity map of this index says.
    Map(usize),
}

/// What a material makes of the triangles that have it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Surface {
    pub cover: Cover,
    /// Where its opacity map lies; `None` where that is the same everywhere.
    pub placing: Option<Placing>,
}

impl Surface {
    pub const WHOLE: Self = Self { cover: Cover::Whole, placing: None };
    pub const UNKNOWN: Self = Self { cover: Cover::Unknown, placing: None };
}

/// How the triangles look that have a material, or none.
#[derive(Clone, Copy, Default)]
pub(super) struct Look {
    pub double_sided: bool,
    /// Whether its alpha counts.
    pub fades: bool,
    pub surface: Surface,
    /// What it shines with, where that is to be read.
    pub emission: Option<Emission>,
}

/// How much light a material stops: of one part of it, or of all.
enum Opacity {
    /// One everywhere, 0 to 1.
    Even(f64),
    Drawn(Drawn),
}

/// A texture that says how much light is stopped.
struct Drawn {
    image: usize,
    channel: Channel,
    plane: Rc<Plane>,
    wrap: [Wrap; 2],
    linear: bool,
    placing: Placing,
    /// What is stopped where the channel is 0, and where it is 1.
    ends: [f64; 2],
    cutoff: Option<f32>,
}

/// What tells opacity maps apart.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Even(u8),
    Drawn(usize, Channel, [u8; 2], bool, [u64; 2], Option<u32>),
}

/// The surfaces of a file's materials, and the opacity maps that they have.
pub(super) struct Surfaces<'a> {
    document: &'a Document<'a>,
    buffers: &'a Buffers<'a>,
    /// Whether what shines is read.
    emissive: bool,
    known: BTreeMap<usize, Look>,
    planes: BTreeMap<(usize, Channel), Result<Rc<Plane>, Problem>>,
    places: BTreeMap<Key, usize>,
    room: Room,
    pub maps: Vec<OpacityMap>,
    pub notes: Notes,
}

impl<'a> Surfaces<'a> {
    pub fn new(document: &'a Document<'a>, buffers: &'a Buffers<'a>, emissive: bool) -> Self {
        Self {
            document,
            buffers,
            emissive,
            known: BTreeMap::new(),
            planes: BTreeMap::new(),
            places: BTreeMap::new(),
            room: Room::default(),
            maps: Vec::new(),
            notes: Notes::default(),
        }
    }

    /// The look of `materials[index]`, which `owner` refers to.
    pub fn of(&mut self, index: usize, owner: impl FnOnce() -> String) -> Result<Look, Problem> {
        if let Some(known) = self.known.get(&index) {
            return Ok(*known);
        }
        let materials = &self.document.materials;
        at(materials, index, "materials", owner)?;
        let material = item::<Material>(materials, index, "materials", String::new);
        let look = match material {
            Ok(of) => {
                let read = self.read(&of, &format!("materials[{index}]"));
                Look {
                    double_sided: of.double_sided,
                    fades: !matches!(of.alpha_mode, Checked::Valid(AlphaMode::Opaque)),
                    surface: read.unwrap_or_else(|problem| self.unknown(index, &problem)),
                    emission: self.emission(&of, index),
                }
            }
            Err(problem) => {
                let rest = item::<RestOfMaterial>(materials, index, "materials", String::new);
                Look {
                    double_sided: rest.as_ref().is_ok_and(|rest| rest.double_sided),
                    surface: match rest {
                        Ok(rest) if rest.is_whole() => Surface::WHOLE,
                        _ => self.unknown(index, &problem),
                    },
                    ..Look::default()
                }
            }
        };
        self.known.insert(index, look);
        Ok(look)
    }

    /// The surface of a material of which not enough can be read.
    fn unknown(&mut self, index: usize, problem: &str) -> Surface {
        self.notes.tell(format!("{problem}; what has materials[{index}] counts whole"));
        Surface::UNKNOWN
    }

    /// What a material shines with.
    fn emission(&mut self, material: &Material, index: usize) -> Option<Emission> {
        let of = material.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = of.map_or(1.0, |of| of.emissive_strength.0);
        let emission = Emission::new(material.emissive_factor.0, strength);
        let emission = emission.filter(|_| self.emissive)?;
        if material.emissive_texture.is_some() {
            self.notes.tell(format!(
                "materials[{index}] has an emissiveTexture, which is passed over: it shines as its factor says"
            ));
        }
        if material.double_sided {
            self.notes.tell(format!(
                "materials[{index}] is double-sided, and what shines with it shines to its front alone"
            ));
        }
        Some(emission)
    }

    fn read(&mut self, material: &Material, name: &str) -> Result<Surface, Problem> {
        let alpha = self.alpha(material, name)?;
        let transmission = self.transmission(material, name)?;
        let both = match (alpha, transmission) {
            (Opacity::Even(a), Opacity::Even(b)) => Opacity::Even(a * b),
            (one, Opacity::Even(1.0)) | (Opacity::Even(1.0), one) => one,
            (Opacity::Even(0.0), _) => Opacity::Even(0.0),
            (Opacity::Drawn(mut drawn), Opacity::Even(by))
            | (Opacity::Even(by), Opacity::Drawn(mut drawn))
                if drawn.cutoff.is_none() =>
            {
                drawn.ends = drawn.ends.map(|end| end * by);
                Opacity::Drawn(drawn)
            }
            (alpha, _) => {
                self.notes.tell(format!(
                    "{name} has an alpha and a transmission that differ from place to place; the alpha alone counts"
                ));
                alpha
            }
        };
        self.surface(both)
    }

    /// How much of the light is stopped as a material's alpha says.
    fn alpha(&mut self, material: &Material, name: &str) -> Result<Opacity, Problem> {
        let is_mask = match material.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => return Ok(Opacity::Even(1.0)),
            Checked::Valid(AlphaMode::Mask) => true,
            Checked::Valid(AlphaMode::Blend) => false,
            Checked::Invalid => {
                return Err(format!("the alphaMode of {name} is not OPAQUE, MASK or BLEND"));
            }
        };
        let of_base = &material.pbr_metallic_roughness;
        let extensions = material.extensions.as_ref();
        let (color, texture) = match extensions.and_then(|e| e.pbr_specular_glossiness.as_ref()) {
            Some(of) => (of.diffuse_factor.0, of.diffuse_texture.as_ref()),
            None => (of_base.base_color_factor.0, of_base.base_color_texture.as_ref()),
        };
        let [.., factor] = color.map(|of| of.clamp(0.0, 1.0));
        let cutoff = material.alpha_cutoff.map_or(CUTOFF, |cutoff| cutoff.0);
        // The factor takes a mask's cutoff up, so that the texture stays as it is.
        let (most, cutoff) = match is_mask {
            true => (1.0, Some(cutoff / factor)),
            false => (f64::from(factor), None),
        };
        // No texture comes to more than 0, or is less than a cutoff of 0.
        let is_even = factor == 0.0 || cutoff.is_some_and(|cutoff| cutoff <= 0.0);
        let drawn = match texture.filter(|_| !is_even) {
            Some(texture) => self.drawn(texture, Channel::Alpha, [0.0, most], name)?,
            None => Opacity::Even(most),
        };
        let stops = |alpha: f64| cutoff.is_none_or(|cutoff| alpha >= f64::from(cutoff));
        Ok(match (drawn, cutoff) {
            (Opacity::Drawn(drawn), Some(cutoff)) => {
                match drawn.plane.range().map(|of| stops(f64::from(of) / 255.0)) {
                    [true, _] => Opacity::Even(1.0),
                    [_, false] => Opacity::Even(0.0),
                    _ => Opacity::Drawn(Drawn { cutoff: Some(cutoff), ..drawn }),
                }
            }
            (Opacity::Even(_), Some(cutoff)) if cutoff.is_nan() => Opacity::Even(1.0),
            (Opacity::Even(alpha), Some(_)) => Opacity::Even(f64::from(u8::from(stops(alpha)))),
            (drawn, None) => drawn,
        })
    }

    /// How much of the light is stopped as a material's transmission says.
    fn transmission(&mut self, material: &Material, name: &str) -> Result<Opacity, Problem> {
        let of = material.extensions.as_ref().and_then(|e| e.transmission.as_ref());
        let Some(of) = of else { return Ok(Opacity::Even(1.0)) };
        let passes = f64::from(of.transmission_factor.0.clamp(0.0, 1.0));
        match of.transmission_texture.as_ref().filter(|_| passes > 0.0) {
            Some(texture) => self.drawn(texture, Channel::Red, [1.0, 1.0 - passes], name),
            None => Ok(Opacity::Even(1.0 - passes)),
        }
    }

    /// What a channel of a texture says.
    fn drawn(
        &mut self,
        info: &Info,
        channel: Channel,
        ends: [f64; 2],
        name: &str,
    ) -> Result<Opacity, Problem> {
        let document = self.document;
        let index = info.index.value();
        let texture: Texture = item(&document.textures, index, "textures", || name.into())?;
        let name = format!("textures[{index}]");
        let sampler = match texture.sampler {
            Some(of) => item(&document.samplers, of.value(), "samplers", || name.clone())?,
            None => Sampler::default(),
        };
        let image = source(&texture)
            .ok_or_else(|| format!("{name} has no image that is read; PNG, JPEG and WebP are"))?;
        let known = match self.planes.get(&(image, channel)) {
            Some(known) => known.clone(),
            None => {
                let read = item::<Image>(&document.images, image, "images", || name);
                let read = read
                    .and_then(|of| images::plane(&of, image, channel, self.buffers, &self.room))
                    .map(Rc::new);
                self.planes.insert((image, channel), read.clone());
                read
            }
        };
        let plane = known?;
        if let [only] = plane.texels[..] {
            let [none, all] = ends;
            return Ok(Opacity::Even(none + (all - none) * f64::from(only) / 255.0));
        }
        Ok(Opacity::Drawn(Drawn {
            image,
            channel,
            plane,
            wrap: [sampler.wrap_s, sampler.wrap_t].map(wrap),
            linear: !matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))),
            placing: Placing::of(info),
            ends,
            cutoff: None,
        }))
    }

    /// The surface that stops so much, with its opacity map among the scene's.
    fn surface(&mut self, opacity: Opacity) -> Result<Surface, Problem> {
        let byte = |opacity: f64| (255.0 * opacity).round() as u8;
        let drawn = match opacity {
            Opacity::Even(opacity) => return Ok(self.even(byte(opacity))),
            Opacity::Drawn(drawn) => drawn,
        };
        let [none, all] = drawn.ends;
        let of = |value: u8| byte(none + (all - none) * f64::from(value) / 255.0);
        let [least, most] = drawn.plane.range().map(of);
        if least == most {
            return Ok(self.even(least));
        }
        let key = Key::Drawn(
            drawn.image,
            drawn.channel,
            drawn.wrap.map(|wrap| wrap as u8),
            drawn.linear,
            drawn.ends.map(f64::to_bits),
            drawn.cutoff.map(f32::to_bits),
        );
        let place = match self.places.get(&key) {
            Some(known) => *known,
            None => {
                let texels = &drawn.plane.texels;
                self.room
                    .take(texels.len() as u64, self.buffers.held())
                    .map_err(|problem| format!("images[{}]: {problem}", drawn.image))?;
                let map = OpacityMap {
                    size: drawn.plane.size,
                    texels: texels.iter().map(|value| of(*value)).collect(),
                    wrap: drawn.wrap,
                    linear: drawn.linear,
                    cutoff: drawn.cutoff,
                };
                self.add(key, map)
            }
        };
        Ok(Surface { cover: Cover::Map(place), placing: Some(drawn.placing) })
    }

    /// The surface that stops the same everywhere, 0 to 255.
    fn even(&mut self, opacity: u8) -> Surface {
        if opacity == u8::MAX {
            return Surface::WHOLE;
        }
        let key = Key::Even(opacity);
        let place = self.places.get(&key).copied().unwrap_or_else(|| {
            let map = OpacityMap { size: [1, 1], texels: vec![opacity], ..OpacityMap::default() };
            self.add(key, map)
        });
        Surface { cover: Cover::Map(place), placing: None }
    }

    fn add(&mut self, key: Key, map: OpacityMap) -> usize {
        self.maps.push(map);
        self.places.insert(key, self.maps.len() - 1);
        self.maps.len() - 1
    }
}

/// The image of a texture: its own, or that of EXT_texture_webp where it has none of its own.
fn source(texture: &Texture) -> Option<usize> {
    let own = texture.source.value();
    if own != u32::MAX as usize {
        return Some(own);
    }
    let webp = texture.extensions.as_ref()?.others.get("EXT_texture_webp")?;
    webp.get("source").and_then(Value::as_u64).and_then(|index| usize::try_from(index).ok())
}

/// How a texture goes on beyond its edges; as it does by default where the file does not say it rightly.
fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
