//! Square nodes of a map's texels, few enough that every tile of pixels can test those around it.

/// The number of nodes along a side of the map (`nearest.glsl`).
pub(crate) fn nodes_a_row(map: u32) -> u32 {
    map.div_ceil(map.div_ceil(32).max(8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_few_nodes_that_cover_it() {
        for map in 1..=4096 {
            let row = nodes_a_row(map);
            let side = map.div_ceil(32).max(8);
            assert!(row <= 32 && row * side >= map && (row - 1) * side < map, "{map}");
        }
    }
}
