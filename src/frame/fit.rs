//! Fits a light's maps to the meshes that matter to it. The result stays valid while light and meshes do.

use super::boxes::{Boxes, MeshBoxes, has_triangles};
use super::hull::Hull;
use super::odd::Odd;
use super::passes::PLACEHOLDER;
use super::placed::Placed;
use super::request::{FitRequest, Inputs};
use super::reuse::CameraBits;
use super::seen::visible;
use super::{Description, Frame};
use crate::Error;
use crate::effects::{Seen, Situation};
use crate::graph::{Need, Why};
use crate::light::RectangleLight;
use crate::stages::depth_layers::{self, HostMapView, LightBox, MapView, Projection};
use crate::stages::views::{Extent, Lamp, Served, Views, fit_served};
use crate::techniques::room::{Room, Seen as ViewsSeen};
use glam::DMat4;

/// A view for passes that do not run, which serves all pixels.
const ALONE: Served = Served::all(PLACEHOLDER);

/// The meshes that matter to a light, and the views of its maps.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    of: Option<Inputs>,
    pub light_from_world: DMat4,
    /// The space of the technique's maps: light space, or under a sun that of parallel light.
    pub space_from_world: DMat4,
    /// The light in that space, by its half-extents: tangents for parallel light.
    pub light: RectangleLight,
    /// Whether the space is that of parallel light.
    pub parallel: bool,
    /// The view of the receivers in that space.
    pub receiver_view: MapView,
    /// The boxes of occluders and receivers in a sun's space; kept for their memory.
    pub(super) under_sun: [Vec<LightBox>; 2],
    /// The parts of the receivers that are seen, under a sun; kept for their memory.
    pub(super) parts: Vec<Extent>,
    /// The meshes that may block the light; empty where the host lends occluder maps.
    pub occluders: Placed,
    pub receivers: Placed,
    pub host_maps: Option<HostMapView>,
    /// The view of the occluders from the light's centre.
    pub centre: Option<MapView>,
    /// The view from the light's centre of the receivers that the occluders may shadow.
    pub shadowed: Option<MapView>,
    /// The views of the occluders that share the pixels, the finest first: from behind the light where the technique's
    /// projection point lies there. Empty where nothing lies before the light.
    pub served: Vec<Served>,
    /// Why there are so many of them.
    pub why_served: Why,
    /// The view from the light's centre, which serves all pixels where a hard shadow stands in for the technique.
    pub alone: Served,
    /// Whether anything can be shadowed, and why or why not.
    pub need: Need<Why>,
    /// The situation as far as the meshes' boxes show it; `None` where nothing can be shadowed.
    pub situation: Option<Situation>,
    /// Signs of mistakes in the meshes.
    pub odd: Odd,
    /// Whether the host draws some of the occluders.
    pub host_draws: bool,
    /// Whether the views follow the camera.
    pub(super) follows_camera: bool,
    /// Counts the fits that were made: it changes with each.
    number: u64,
    /// The technique's own views, once [`Self::views`] has made them.
    views: Option<Views>,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            of: None,
            light_from_world: DMat4::IDENTITY,
            space_from_world: DMat4::IDENTITY,
            light: RectangleLight::unit(),
            parallel: false,
            receiver_view: PLACEHOLDER,
            under_sun: [Vec::new(), Vec::new()],
            parts: Vec::new(),
            occluders: Placed::default(),
            receivers: Placed::default(),
            host_maps: None,
            centre: None,
            shadowed: None,
            served: Vec::new(),
            why_served: Why::default(),
            alone: ALONE,
            need: Need::No(Why::default()),
            situation: None,
            odd: Odd::default(),
            host_draws: false,
            follows_camera: false,
            number: 0,
            views: None,
        }
    }
}

impl Fit {
    /// Fits the maps to a frame, unless the fit is that frame's already.
    ///
    /// # Errors
    /// [`Error::Frame`] for meshes that do not suit the technique, or a matrix of lent maps that is no camera at the
    /// light's centre.
    pub fn update(
        &mut self,
        description: &Description,
        request: &FitRequest,
        frame: &Frame,
        mesh_boxes: &mut MeshBoxes,
    ) -> Result<(), Error> {
        let of = Inputs::of(request, frame);
        let follows = self.follows_camera;
        let same = |old: &Inputs| of.as_ref().is_some_and(|new| old.are(new, follows));
        if self.of.as_ref().is_some_and(same) {
            return Ok(());
        }
        self.of = None;
        self.views = None;
        self.number += 1;
        let (boxes, near) = mesh_boxes.of(frame.meshes);
        frame.check_meshes(boxes, &request.takes)?;
        self.make(description, request, frame, boxes, near)?;
        self.of = of;
        Ok(())
    }

    fn make(
        &mut self,
        description: &Description,
        request: &FitRequest,
        frame: &Frame,
        boxes: &Boxes,
        near: &mut Vec<u32>,
    ) -> Result<(), Error> {
        let (maps, most) = (&request.maps, if request.nests { request.most_served } else { 1 });
        let light = frame.light.rectangle();
        let half = light.half_extents();
        self.light_from_world = light.light_from_world();
        (self.space_from_world, self.light, self.parallel) = (self.light_from_world, *light, false);
        self.receiver_view = PLACEHOLDER;
        self.host_maps = match (&frame.occluder_maps, description.occluder_maps) {
            (Some(lent), Some(format)) => {
                Some(HostMapView::new(light, &lent.clip_from_world, maps.side, format)?)
            }
            _ => None,
        };
        if frame.light.is_round() {
            self.place_around(frame);
            return Ok(());
        }
        boxes.near(light, frame.reach, near);
        let gone = self.place(frame, near);
        let Placed { places, boxes: placed, .. } = &self.occluders;
        places.iter().zip(placed).try_for_each(|(&place, of)| Frame::check_reach(place, of))?;
        self.centre = match &self.host_maps {
            Some(lent) => Some(lent.view),
            None => depth_layers::fit_boxes(&self.occluders.boxes, frame.window, maps.side),
        };
        let receivers = &self.receivers.boxes;
        self.shadowed = self.centre.as_ref().and_then(|view| {
            let side = maps.layers.receiver_map.unwrap_or(maps.side);
            depth_layers::fit_receiver_boxes(half, receivers, view, side)
        });
        let no_occluder = self.occluders.boxes.is_empty() && gone == [0, 0];
        self.odd = Odd::of(frame, boxes, [no_occluder, receivers.is_empty()]);
        self.host_draws = boxes.host_drawn_blocker.is_some();
        self.need = self.need_of(boxes.blockers, gone);
        // Lent maps look from the light's centre.
        let eye = if self.host_maps.is_some() { Projection::Centre } else { maps.eye };
        let map = self.centre.unwrap_or(PLACEHOLDER);
        self.alone = Served::all(map);
        self.served.clear();
        self.follows_camera = false;
        let tangent =
            frame.light.tangent().filter(|_| request.parallel && self.host_maps.is_none());
        match eye {
            // A sun's views follow from the camera, below.
            _ if tangent.is_some() => {}
            Projection::Centre
                if most == 1 || self.host_maps.is_some() || frame.window.is_some() =>
            {
                self.served.extend(self.centre.map(|_| self.alone));
                self.why_served = match most {
                    1 => "no more are allowed",
                    _ => "the host gives its window",
                }
                .into();
            }
            _ => {
                let lamp = Lamp {
                    half,
                    occluders: &self.occluders.boxes,
                    receivers: &self.receivers.boxes,
                    visible: visible(
                        &(self.light_from_world * frame.world_from_ndc),
                        &self.receivers.boxes,
                    ),
                    projection: eye,
                    sides: maps.sides(),
                    most,
                };
                (self.why_served, self.follows_camera) = fit_served(&lamp, &mut self.served);
            }
        }
        self.receiver_view = self.shadowed.unwrap_or(PLACEHOLDER);
        self.situation = match (self.need, &self.centre, &self.shadowed) {
            (Need::Yes(_), Some(centre), Some(shadowed)) => {
                let occluders = &self.occluders;
                let seen = Seen {
                    light: half.map(|h| 2.0 * h),
                    given: boxes.blockers,
                    receivers: &self.receivers.boxes,
                    shadowed,
                    map: self.served.last().map_or(centre, |served| &served.map),
                };
                let placed = occluders.meshes(frame.meshes).zip(&occluders.boxes);
                Some(Situation::of(&seen, placed))
            }
            _ => None,
        };
        if let Some(tangent) = tangent.filter(|_| self.need.is_yes()) {
            self.fit_parallel(description, request, frame, tangent);
        }
        Ok(())
    }

    /// Sorts all meshes into receivers and occluders of a light that shines to all sides, which no map is fitted to.
    fn place_around(&mut self, frame: &Frame) {
        let Self { occluders, receivers, light_from_world, .. } = self;
        occluders.clear();
        receivers.clear();
        for (place, mesh) in frame.meshes.iter().enumerate().filter(|(_, m)| has_triangles(m)) {
            let placed = LightBox::of(mesh, light_from_world);
            if mesh.role.receives() {
                receivers.push(place as u32, placed);
            }
            if mesh.role.blocks() {
                occluders.push(place as u32, placed);
            }
        }
        (self.centre, self.shadowed, self.situation) = (None, None, None);
        (self.served, self.alone) = (Vec::new(), ALONE);
        self.odd = Odd::default();
        self.need = match (occluders.boxes.len(), receivers.boxes.len()) {
            (0, _) => Need::No("there are no occluders".into()),
            (_, 0) => Need::No("there are no receivers".into()),
            (blocking, showing) => Need::Yes(
                Why::default()
                    .and(blocking)
                    .and(" occluder meshes are around the light, and ")
                    .and(showing)
                    .and(" receiver meshes"),
            ),
        };
    }

    /// Sorts the meshes near the light into receivers and the occluders that can lie between a receiver and the light.
    /// Returns how many occluders were removed because they are flat with light and receivers on one side, and how many
    /// because they lie elsewhere.
    fn place(&mut self, frame: &Frame, near: &[u32]) -> [usize; 2] {
        let half = frame.light.rectangle().half_extents();
        let lent = self.host_maps.is_some();
        let Self { occluders, receivers, light_from_world, .. } = self;
        occluders.clear();
        receivers.clear();
        for &place in near {
            let mesh = &frame.meshes[place as usize];
            let placed = LightBox::of(mesh, light_from_world);
            if placed.max.z <= 0.0 {
                continue;
            }
            if mesh.role.receives() {
                receivers.push(place, placed);
            }
            if mesh.role.blocks() && !lent {
                occluders.push(place, placed);
            }
        }
        let hull = Hull::new(half, &receivers.boxes, frame.reach);
        let elsewhere = occluders.retain(|b| hull.is_some_and(|hull| hull.meets(b)));
        let seen = || receivers.boxes.iter().copied();
        let aside = occluders.retain(|b| !b.is_aside(half, seen));
        [aside, elsewhere]
    }

    /// Whether anything can be shadowed, and why or why not.
    fn need_of(&self, given: usize, [aside, elsewhere]: [usize; 2]) -> Need<Why> {
        let receivers = self.receivers.boxes.len();
        match (&self.centre, &self.shadowed) {
            (None, _) if given == 0 => Need::No("there are no occluders".into()),
            (None, _) if self.occluders.boxes.is_empty() && aside > 0 && elsewhere == 0 => {
                Need::No(
                    "every occluder is flat, with light and receivers on one side of it".into(),
                )
            }
            (None, _) if aside + elsewhere == 0 => {
                Need::No("every occluder lies behind the light, or out of its reach".into())
            }
            (None, _) | (_, None) => {
                Need::No("no receiver lies where an occluder could shadow it".into())
            }
            _ if self.host_maps.is_some() => Need::Yes(
                Why::from("the host's maps may shadow some of ")
                    .and(receivers)
                    .and(" receiver meshes"),
            ),
            _ => Need::Yes(
                Why::default()
                    .and(self.occluders.boxes.len())
                    .and(" of ")
                    .and(given)
                    .and(" occluder meshes can shadow some of ")
                    .and(receivers)
                    .and(" receiver meshes"),
            ),
        }
    }

    /// Whether the light is a point, which every view sees from its centre.
    pub fn is_point(&self) -> bool {
        self.light.is_point()
    }

    /// The camera of a frame, where the views follow it.
    pub fn camera(&self, frame: &Frame) -> Option<CameraBits> {
        let bits = || frame.world_from_ndc.to_cols_array().map(f64::to_bits);
        self.follows_camera.then(bits)
    }

    /// The number of this fit: the meshes and views are the same while it is.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Makes the technique's own views, on the first call after an update.
    ///
    /// # Errors
    /// [`Error::Setting`] where the light takes more views than the technique allows.
    pub fn find_views(&mut self, room: &dyn Room, frame: &Frame) -> Result<(), Error> {
        if self.views.is_none() {
            self.occluders.fill_bounds(frame.meshes);
            self.receivers.fill_bounds(frame.meshes);
            self.views = Some(self.make_views(room, frame)?);
        }
        Ok(())
    }

    /// The technique's own views, once they are made.
    pub fn views(&self) -> &Views {
        self.views.as_ref().unwrap_or(&Views::Centre)
    }

    fn make_views(&self, room: &dyn Room, frame: &Frame) -> Result<Views, Error> {
        room.views(&ViewsSeen {
            light: frame.light.rectangle(),
            shape: frame.light.shape(),
            occluders: &self.occluders.bounds,
            receivers: &self.receivers.bounds,
            centre: self.centre.as_ref().unwrap_or(&PLACEHOLDER),
            parallel: if self.parallel { &self.served } else { &[] },
            w_far: self.shadowed.as_ref().map_or(0.0, |receivers| 1.0 / receivers.far),
        })
    }
}
