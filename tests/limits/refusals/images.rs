//! What of the images of a frame is refused.

use super::*;

/// Every image in every way that it can be wrong, and each refusal by its name.
#[test]
fn images() {
    use Lends::{GBuffer, Maps, Texture, Visibility as Lent};
    type Find = for<'a> fn(&'a mut Frame<'_>) -> &'a mut HostImage;
    fn lent<'a>(f: &'a mut Frame<'_>) -> &'a mut HostImage {
        match &mut f.visibility {
            Visibility::Lent(image) => image,
            Visibility::Own { .. } => panic!("the node's own"),
        }
    }
    let all: [(&str, Lends, Find); 7] = [
        ("gbuffer.depth", GBuffer, |f| &mut f.depth),
        ("gbuffer.mask", GBuffer, |f| f.mask.as_mut().unwrap()),
        ("gbuffer.normal", GBuffer, |f| f.normals.as_mut().unwrap()),
        ("occluder_maps.front", Maps, |f| &mut f.occluder_maps.as_mut().unwrap().front),
        ("occluder_maps.back", Maps, |f| f.occluder_maps.as_mut().unwrap().back.as_mut().unwrap()),
        ("light.texture", Texture, |f| f.light_texture.as_mut().unwrap()),
        ("visibility", Lent, lent),
    ];
    type Change = fn(&mut HostImage);
    let wrong: [(&str, Change, &[&str]); 12] = [
        ("no image", |i| i.image = vk::Image::null(), &["null handle"]),
        ("no view", |i| i.view = vk::ImageView::null(), &["null handle"]),
        ("no width", |i| i.extent[0] = 0, &["0×", "no image"]),
        ("another size", |i| i.extent = [63, 47], &["63×47", "resize the node"]),
        ("another format", |i| i.format = vk::Format::R8G8_UNORM, &["R8G8_UNORM", "was described"]),
        ("no usage", |i| i.usage = Usage::TRANSFER_SRC, &["was created without", "TRANSFER_SRC"]),
        (
            "left in no layout",
            |i| i.before.layout = Layout::UNDEFINED,
            &["UNDEFINED", "which layout"],
        ),
        (
            "never brought into one",
            |i| i.before.layout = Layout::PREINITIALIZED,
            &["PREINITIALIZED"],
        ),
        ("wanted in none", |i| i.after.layout = Layout::PREINITIALIZED, &["PREINITIALIZED"]),
        (
            "left in a layout that it cannot be in",
            |i| {
                (i.usage, i.before.layout) =
                    (i.usage & !Usage::TRANSFER_DST, Layout::TRANSFER_DST_OPTIMAL);
            },
            &["TRANSFER_DST", "before the node"],
        ),
        (
            "wanted in a layout that it cannot be in",
            |i| i.after.layout = Layout::TRANSFER_SRC_OPTIMAL,
            &["TRANSFER_SRC", "after the node"],
        ),
        (
            "no stage",
            |i| i.after.stage = vk::PipelineStageFlags::empty(),
            &["after", "no pipeline stage"],
        ),
    ];
    let mut count = 0;
    for (name, lends, find) in all {
        let given = Given::new(lends, "");
        given.plan(lends, |_| {}).unwrap();
        for (what, change, says) in wrong {
            // A texture may be of any size, and what is written may have held anything.
            let of_any_size = name == "light.texture" && what == "another size";
            let forgotten = name == "visibility"
                && ["left in no layout", "never brought into one"].contains(&what);
            let refused = given.plan(lends, |f| change(find(f)));
            if of_any_size || forgotten {
                refused.unwrap_or_else(|e| panic!("{name}, {what}: {e}"));
                continue;
            }
            let sentence = refused.expect_err(what).to_string();
            println!("{name}, {what}: {sentence}");
            assert!(sentence.starts_with(name), "{what}: {sentence}");
            assert!(says.iter().all(|word| sentence.contains(word)), "{name}, {what}: {sentence}");
            count += 1;
        }
        // Depth in color's layouts, and color in depth's.
        let is_depth = name.contains("depth") || name.contains("maps");
        let foreign = if is_depth {
            Layout::COLOR_ATTACHMENT_OPTIMAL
        } else {
            Layout::DEPTH_STENCIL_READ_ONLY_OPTIMAL
        };
        let refused = given.plan(lends, |f| find(f).after.layout = foreign);
        let sentence = refused.unwrap_err().to_string();
        assert!(sentence.starts_with(name) && sentence.contains("is a layout of"), "{sentence}");
        count += 1;
    }
    println!("{count} refusals");
}

/// The node's own image is in the layouts that its usages allow, and what is written is not what is read.
#[test]
fn results() {
    use Lends::Visibility as Lent;
    fn own(f: &mut Frame<'_>, in_layout: Layout, then: Layout) {
        let scope = Scope::FRAGMENT_SAMPLED;
        let (before, after) = (scope.in_layout(in_layout), scope.in_layout(then));
        f.visibility = Visibility::Own { before, after };
    }
    let o = framed;
    const READ: Layout = Layout::SHADER_READ_ONLY_OPTIMAL;
    refuses(vec![
        o(
            "color is not drawn to it",
            |f| own(f, Layout::COLOR_ATTACHMENT_OPTIMAL, READ),
            &["visibility", "COLOR_ATTACHMENT"],
        ),
        o(
            "nor is it copied to",
            |f| own(f, READ, Layout::TRANSFER_DST_OPTIMAL),
            &["visibility", "TRANSFER_DST"],
        ),
        o(
            "nor is it depth",
            |f| own(f, READ, Layout::DEPTH_STENCIL_READ_ONLY_OPTIMAL),
            &["visibility", "depth images"],
        ),
        o(
            "nor preinitialized",
            |f| own(f, READ, Layout::PREINITIALIZED),
            &["visibility", "PREINITIALIZED"],
        ),
        (
            "what is written is the mask",
            Lent,
            "",
            Framed(|f| {
                let mask = f.mask.as_mut().unwrap().image;
                f.visibility = Visibility::Lent(HostImage { image: mask, ..target() });
            }),
            &["visibility", "gbuffer.mask", "one of its own"],
        ),
        ("nothing to write", Lent, "", Framed(|f| own(f, READ, READ)), &["lent_visibility"]),
    ]);
}
