//! What the hierarchy leaves out cannot block; what is visible is tested in `tests/scenes/truth`.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use super::*;
use crate::truth::random::{Random, scattered};

#[test]
fn the_tree_loses_no_triangle() {
    let mut random = Random(73);
    let exact = ExactLine::new(&scattered(&mut random)).unwrap();
    let (mut culled, mut blocking) = (0, 0);
    for _ in 0..800 {
        let [x, y, _] = random.frame();
        let half = x * random.within(0.05, 1.0);
        let light = RectangleLight::line(random.vector(1.5), half, y).unwrap();
        let point = random.vector(1.5);
        let frame = exact.frame(&light).unwrap();
        let eye = Eye::new(&frame, point - exact.blockers.origin);
        let mut found = Vec::new();
        exact.blockers.for_each_in(&eye.region(), |triangle| found.push(*triangle));
        for triangle in &exact.blockers.triangles {
            let marks = triangle.map(|corner| eye.mark(corner));
            let blocks = section(&marks).and_then(clip).and_then(shadow).is_some();
            let blocks = blocks && eye.local.z > 0.0;
            let is_found = found.contains(triangle);
            assert!(is_found || !blocks, "{triangle:?} from {point}");
            culled += usize::from(!is_found);
            blocking += usize::from(blocks);
        }
    }
    // 320,000 in all.
    assert!(culled > 240_000 && blocking > 500, "{culled} culled, {blocking} in the way");
}
