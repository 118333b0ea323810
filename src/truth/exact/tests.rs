//! What the hierarchy leaves out cannot block; what is visible is tested in `tests/scenes/truth`.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use super::*;
use crate::RectangleLight;
use crate::truth::random::{Random, scattered};

#[test]
fn the_tree_loses_no_triangle() {
    let mut random = Random(53);
    let exact = Exact::new(&scattered(&mut random)).unwrap();
    let (mut culled, mut blocking) = (0, 0);
    for _ in 0..200 {
        let [x, y, _] = random.frame();
        let light = RectangleLight::new(random.vector(1.5), x * random.within(0.05, 1.0), y * 0.2);
        let light = PolygonLight::from(&light.unwrap());
        let frame = light.frame().relative_to(exact.blockers.origin);
        let point = random.vector(1.5);
        let apex = Apex::new(&frame, point);
        let mut found = Vec::new();
        let region = pyramid(&frame, &apex, point);
        exact.blockers.for_each_in(&region, |triangle| found.push(*triangle));
        for triangle in &exact.blockers.triangles {
            let inside = clip(triangle.map(|corner| apex.ray_through(corner)).to_vec(), 1.0);
            let blocks = apex.local.z > 0.0 && inside.iter().any(|ray| ray.w > 1e-9);
            let is_found = found.contains(triangle);
            assert!(is_found || !blocks, "{triangle:?} from {point}");
            culled += usize::from(!is_found);
            blocking += usize::from(blocks);
        }
    }
    // 80,000 in all.
    assert!(culled > 40_000 && blocking > 500, "{culled} culled, {blocking} in the way");
}
