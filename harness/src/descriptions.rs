//! Descriptions of nodes that together have every pass.

use crate::words::technique_of;
use antumbra::frame::CutOuts;
use antumbra::{Description, LightTexture};
use ash::vk;

/// One description for every set of passes that a node may have, with its settings in words: all of them together have
/// every shader of the crate.
///
/// # Panics
/// If a technique refuses the settings, which the tests would show.
#[allow(clippy::expect_used, reason = "the words are fixed")]
pub fn with_every_pass() -> Vec<(String, Description)> {
    let mut all = Vec::new();
    for words in [
        "receivers=pixels sides=one",
        "receivers=pixels sides=bottom",
        "receivers=pixels sides=two",
        "receivers=pixels sides=mean",
        "receivers=pixels classify=off",
        "receivers=map accumulate=gather sides=two map=100 receiver_map=77",
        "receivers=map accumulate=blend sides=two map=17 receiver_map=16",
        "receivers=map accumulate=blend-fp16 sides=one",
        "technique=hard",
        "technique=pcss taps=8",
        "technique=pcss map=1000 classify=off",
        "technique=back-projection map=100",
        "technique=many-lights samples=3 map=65",
        "technique=ray-march",
        "technique=ray-march map=100 rays=7 layers=3 levels=thirds filter=off",
        "technique=ray-march map=17 layers=2 levels=mip search=linear projection=orthographic",
        "technique=occlusion-textures",
        "technique=occlusion-textures map=65 slices=32 prefilter=n-buffer placement=uniform",
        "technique=occlusion-textures map=1024 slices=17 combine=product prefilter=mip fill=on",
        "technique=occlusion-textures map=100 slices=4 combine=sum",
        "technique=occlusion-textures classify=off",
        "technique=occlusion-textures map=100 combine=max classify=off",
        "technique=occlusion-textures map=33 slices=8 prefilter=mip classify=off",
        "technique=occlusion-textures map=50 slices=8 prefilter=mip combine=sum classify=off",
        "technique=linear-light",
        "technique=linear-light map=65 samples=2 lines=1 transition=linear",
        "technique=linear-light map=100 samples=5 lines=2 error=0",
        "technique=traced",
        "technique=traced samples=256",
        "technique=traced samples=1024",
    ] {
        let textures: &[Option<bool>] =
            match words.contains("ray-march") || words.contains("traced") {
                true => &[None, Some(false), Some(true)],
                false => &[None],
            };
        for ((mask_format, occluder_maps), texture) in
            [(None, None), (Some(vk::Format::R8_UNORM), None), (None, Some(vk::Format::D32_SFLOAT))]
                .into_iter()
                .flat_map(|formats| textures.iter().map(move |t| (formats, *t)))
        {
            let format = vk::Format::R8G8B8A8_UNORM;
            let draws_all = ["many-lights", "occlusion-textures", "linear-light", "traced"];
            if occluder_maps.is_some() && draws_all.iter().any(|t| words.contains(t)) {
                continue;
            }
            let description = Description {
                technique: technique_of(words).expect("settings that are in order"),
                mask_format,
                occluder_maps,
                light_texture: texture.map(|color| LightTexture { format, color }),
                lent_visibility: occluder_maps.is_some(),
                ..Description::new([641, 479])
            };
            let name = format!(
                "{words}, mask {mask_format:?}, maps {occluder_maps:?}, texture {texture:?}"
            );
            if occluder_maps.is_none() && mask_format.is_none() {
                let cut_outs = CutOuts { meshes: 3, texels: 1000 };
                all.push((
                    format!("{name}, cut-outs"),
                    Description { cut_outs, ..description.clone() },
                ));
            }
            all.push((name, description));
        }
    }
    for words in ["technique=hard", "technique=pcss taps=8"] {
        let plain = Description::new([641, 479]);
        let mask_format = Some(vk::Format::R8_UNORM);
        let description = Description {
            technique: technique_of(words).expect("settings that are in order"),
            mask_format,
            audit: 1000,
            ..plain
        };
        let cut_outs = CutOuts { meshes: 3, texels: 1000 };
        all.push((
            format!("{words}, audited, cut-outs"),
            Description { cut_outs, ..description.clone() },
        ));
        all.push((format!("{words}, audited"), description));
    }
    all
}
