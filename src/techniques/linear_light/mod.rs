//! Linear lights (Heidrich, Brabec and Seidel 2000): visibility channels from warped skins.
//!
//! ```text
//!   ●─────●─────●  samples of a line                      a line       middle…, mask, place   where its samples are
//!    \  . skin /   a skin: the second one's ray past      each sample  occluders, receivers   what it sees
//!     \  ─■── /    an edge the first one sees it from                  start, copy            …and which passes run
//!      \   . \/    the edge to where it meets the         each segment edges                  where occluders end
//!    ───●──●───    receiver; what lies behind it                       skins                  drawn as the neighbour sees
//!                  sees a part                            each sample  keep                   both its channels
//!                                                         each pixel   visibility             segments, summed
//! ```
//! A point in penumbra is seen by one end of a segment of the light and not by the other. The occluder that hides it
//! from the hidden end has an edge that the other end sees past. The ray from the hidden end past that edge is a skin,
//! and the part of it that the other end sees covers the penumbra (section 3.2). All samples of a line see a point in
//! the same row of texels of their maps, so a skin is a strip of one row.
//!
//! **Where the samples are** (the paper's open problem, section 5). A sample represents the line around it, up to the
//! first occluder on either side; no map holds the light that shines through beyond. So the scene is first drawn from
//! the middle of the line. For each of 4096 receivers in that map the occluders in its row of texels are projected
//! back onto the line, as 32 bits of it, and samples are placed, one after the other, where most bits are lost, until
//! the rest is within the requested `error`, in the mean over receivers that do not see all of the line, or there are
//! `samples`. All of it happens on the GPU, in the frame: passes of samples that are not needed draw nothing and
//! dispatch no workgroup. The middle misses occluders behind others, and skins have errors of their own: measured
//! errors are at most 1.3 points above the requested one. An occluder nearer to the line than a tenth of its length is
//! beyond what the middle can resolve; then all samples are used, evenly spaced.
//!
//! **Where we depart.** Where skins overlap, the one that hides most is kept, instead of the nearest. With
//! `transition=rational`, the default, a skin goes on to the furthest receiver, and eq. 1 gives the visibility of a
//! surface behind it from that surface's own distance: the place where its ray past the edge meets the light. It is
//! exact on receivers of any slope, and where an occluder hides the middle of a segment of which both ends are seen.
//! `linear` is as published: even from the occluder's edge to the receiver beside it. Where no skin was drawn each
//! sample adds half of a segment (section 3.2), and all of it where its neighbour is hidden: a sample's map and its
//! neighbour's do not agree to a texel on where that begins, which left dark lines.
//!
//! **Edges.** A plane's inverse distance falls by the same step from each texel to the next. A step that is a fifth
//! larger than those before and behind it is an edge, at any scale: nothing has to be tuned.
//!
//! **Lights with an area** are a few lines. With `across=stack` they lie side by side, along a rectangle's longer side
//! or across a polygon at equal distances; with `across=edges` they are the light's edges, as published for polygons
//! (section 4). A rectangle of height b is one line where its penumbrae across are so narrow that n = 1 keeps P / 2n
//! (D + P) within the `error`, P being b (w_o − w_r) and D the occluder's height in tangents; else as many as that
//! takes, at most `lines`.
//!
//! **Kept maps.** While the host gives one `Frame::revision`, the maps stay, and a frame is one pass: 0.6 to 0.9 of the
//! time of hard shadows from as many points.
//!
//! **Measured** (lavapipe, 256² maps, a line of 1 m, mean error in percent over shadow and penumbra against the exact
//! visible fraction; evenly spaced 2, 4, 8 and 16 samples): card 0.3, 0.2, 0.2, 0.2; tall box 0.4, 0.3, 0.3, 0.2;
//! stacked cards 2.2, 0.6, 0.3, 0.3; spheres 4.9, 1.5, 1.0, 0.9; bunny 3.4, 0.9, 0.5, 0.4; leaves 23, 14, 5.4, 1.9; the
//! bunny as its own occluder 4.0, 2.4, 2.1, 2.0. Many lights with as many points: bunny 15, 7.1, 4.2, 2.2. On receivers
//! that lean by 0, 20 and 40° the linear transition errs by 0.2, 1.1 and 2.1, the rational one by 0.2. A triangle light
//! of a metre as 4 and 16 lines: 1.1 and 0.1; as its edges 7.5, with 2 samples or with 8, as the paper warns.
//!
//! **Limits.** The host cannot draw meshes itself: only the device knows where samples are. Occluders nearer to the
//! line than a tenth of a segment end further aside than any map shows (84°): a card that the line goes through leaves
//! 15 % with 2 samples and 1.2 with 8, one right under it 78 and 11. A receiver that does not block hides others from
//! the channels. Leaves want many samples. Where the light is hidden from all samples, a penumbra ends in a step.

mod line;
mod passes;
mod samples;
mod segments;
pub mod settings;
pub mod twin;
mod view;

pub use passes::Visibility;
pub use samples::{CopyDepth, Mask, Place, Sample, Spread};
pub use segments::{Edges, Keep, Skins, Start};
pub use settings::{Across, Settings, Transition};
pub use view::lines;

use self::view::is_taller;

use self::passes::declare;
use super::room::{HostDraws, Maps, PassInputs, Room, Seen, Shapes, Shows, Takes};
use crate::Error;
use crate::graph::{Graph, ResourceId};
use crate::light::Light;
use crate::stages::depth_layers::MapView;
use crate::stages::views::{Line, Views};

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes {
            shapes: Shapes::LINES.and(Shapes::POLYGONS),
            // Only the device knows a sample's place on the line.
            host_draws: HostDraws::None("does not know where linear-light puts its samples"),
            lent_maps: Err(
                "sees the occluders from points all along the light, and occluder maps from its centre alone",
            ),
            ..Takes::RECTANGLES
        }
    }

    fn shows(&self) -> Shows {
        Shows { back_side: true, fusion: true, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        Maps { receivers_in_views: true, ..Maps::own_views(self.map) }
    }

    fn turned(&self, light: &Light) -> Light {
        if is_taller(light.rectangle()) { light.quarter_turned() } else { *light }
    }

    fn views(&self, seen: &Seen) -> Result<Views, Error> {
        Ok(Views::Lines(lines(self, seen)?))
    }

    fn most_views(&self, _view: MapView) -> Views {
        Views::Lines(vec![Line::NONE; self.lines as usize])
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        declare(graph, self, inputs);
        None
    }

    fn check_agreement(&self) -> Result<(), Error> {
        self.check_together()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lent::MeshBounds;
    use crate::stages::depth_layers::{Eye, MapView};
    use crate::techniques::room::Seen;
    use crate::{RectangleLight, Shape};
    use glam::{DMat4, DVec3};

    /// The sizes that the shaders declare agree with those of the passes.
    #[test]
    fn the_shaders_sizes_are_these() {
        let line = include_str!("../../../glsl/linear_light/line.glsl");
        assert!(line.contains(&format!("SAMPLES_AT = {};", passes::SAMPLES_AT)));
        let [x, y] = samples::RECEIVERS;
        let mask = include_str!("../../../glsl/linear_light/mask.glsl");
        assert!(mask.contains(&format!("RECEIVERS = ivec2({x}, {y});")));
        assert!(line.contains(&format!("MOST_SAMPLES = {};", settings::MOST_SAMPLES)));
    }

    /// An outline in a corner of its rectangle has lines all the same, within it, and they weigh 1 together.
    #[test]
    fn lines_lie_within_the_outline() {
        let light = RectangleLight::new(DVec3::Y * 4.0, DVec3::X, DVec3::NEG_Z * 0.8).unwrap();
        let outline = [[0.1, 0.2], [0.9, 0.2], [0.5, 0.7]];
        let card: MeshBounds = [[-0.5, 0.0, -0.5], [0.5, 0.0, 0.5]];
        let ground: MeshBounds = [[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]];
        for lines_of in [1, 3, 8] {
            let settings = Settings { map: 64, lines: lines_of, error: 0.0, ..Settings::default() };
            let seen = Seen {
                light: &light,
                shape: Shape::Polygon(&outline),
                occluders: &[(card, DMat4::from_translation(DVec3::Y * 2.0))],
                receivers: &[(ground, DMat4::IDENTITY)],
                centre: &MapView {
                    eye: Eye::Behind(0.0),
                    min: [-1.0; 2],
                    max: [1.0; 2],
                    near: 1.0,
                    far: 4.0,
                    side: 64,
                },
                parallel: &[],
                w_far: 0.25,
            };
            let lines = lines(&settings, &seen).unwrap();
            assert_eq!(lines.len(), lines_of as usize);
            assert!((lines.iter().map(|l| l.weight).sum::<f64>() - 1.0).abs() < 1e-12);
            for line in lines {
                let [x, y] = line.middle;
                assert!((0.2..0.7).contains(&y) && x - line.half >= 0.1 && x + line.half <= 0.9);
                assert!(line.half > 0.0 && line.u[0][0] < line.u[0][1] && line.v[0] < line.v[1]);
            }
        }
    }
}
