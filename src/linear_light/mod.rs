//! Linear lights (Heidrich, Brabec and Seidel 2000): visibility channels from warped skins.
//!
//! ```text
//!   ●───────────●  two samples of the line                     each sample  occluders, receivers   what it sees
//!    \  . skin /   a skin: the second one's ray past an edge   each segment start, edges           where occluders end
//!     \  ─■── /    the first one sees it from the edge                      skins                  drawn as its neighbour sees them
//!      \   . \/    to where it meets the receiver                           keep                   both channels of the segment
//!    ───●──●───    what lies behind it sees a part             each pixel   visibility             their sum over the samples it sees
//! ```
//! A point in penumbra is seen by one end of a segment of the light and not by the other. What hides it from that one
//! ends at an edge that the other sees past; the ray from the hidden end past the edge is a skin, and what of it the
//! other end sees covers the penumbra (section 3.2). All samples of a line see a point in one row of their maps, so a
//! skin is a strip of one row.
//!
//! **Where we depart.** Of skins that overlap the one stays that hides most, instead of the nearest. With
//! `transition=rational`, the default, a skin goes on to the furthest receiver, and what is behind it is told by
//! eq. 1 from its own distance: the place where its ray past the edge meets the light. It is exact on receivers of
//! any slope, and where an occluder hides the middle of a segment of which both ends are seen. `linear` is as
//! published: even from the occluder's edge to the receiver beside it.
//!
//! **Edges.** No continuous surface falls by more than twice as much from one texel to the next as before and behind:
//! what does is an edge. Of its inverse distances a plane makes a straight line, so that no threshold has to be tuned.
//!
//! **Rectangles** are a few lines side by side (`lines`), along their longer side.
//!
//! **Measured** (lavapipe, 256² maps, a line of 1 m, mean error in percent over shadow and penumbra against the exact
//! visible fraction; 2, 4, 8 and 16 samples): card 0.3, 0.2, 0.3, 0.2; tall box 0.4, 0.7, 0.3, 0.2; stacked cards 2.2,
//! 0.6, 0.4, 0.3; spheres 5.0, 1.6, 1.0, 0.9; bunny 3.4, 1.0, 0.5, 0.3; leaves 23, 14, 5.7, 2.1; the bunny as its own
//! occluder 4.3, 2.5, 2.0, 1.9. Many lights with as many points: bunny 15, 7.1, 4.2, 2.2; with 24, 48 and 96 of them 1.5,
//! 0.9 and 0.6. The linear transition is off by 0.1 points more on grounds, and by 0.2 to 1.4 on the bunny's own surface.
//!
//! **Limits.** What the middle of a segment sees and neither of its ends does is in umbra (section 3.3): more samples.
//! A receiver that does not block hides others from the channels. An edge between two surfaces that both fall steeply
//! is taken for a slope, and light leaks there in lines a texel wide.

mod passes;
pub mod push;
mod samples;
mod segments;
mod settings;
pub mod twin;
mod view;

pub use passes::{Inputs, declare};
pub use settings::{Across, Settings, Transition};
pub use view::{Line, Seen, lines, turned};
