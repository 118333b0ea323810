//! The headless device: what it says when something is missing, that the validation layer watches
//! it, and that data comes back as it went in.

// One planted hazard has to be recorded through the unsafe door; its block says why it may.
#![allow(unsafe_code)]

use antumbra_harness::{
    ComputeProgram, HeadlessDevice, HeadlessOptions, HostBuffer, OwnedImage, run_compute,
};
use antumbra_tests::compile::try_compile;
use antumbra_tests::{TestDevice, device};
use ash::vk;
use std::process::Command;

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// Adds 1 to each element of one buffer.
fn increment() -> Vec<u32> {
    let source = "#version 450\nlayout(local_size_x = 64) in;\n\
        layout(set = 0, binding = 0, std430) buffer Values { uint values[]; };\n\
        void main() { values[gl_GlobalInvocationID.x] += 1u; }\n";
    try_compile("increment.comp", source).unwrap()
}

#[test]
fn a_dispatch_is_clean_under_the_validation_layer() {
    let device = TestDevice::new(true);
    let values: Vec<u32> = (0..256).collect();
    let buffer = HostBuffer::with_data(&device, "values", &values, STORAGE).unwrap();
    run_compute(&device, &increment(), &[], &[&buffer], [4, 1, 1]).unwrap();
    assert_eq!(buffer.read::<u32>(), (1..257).collect::<Vec<_>>());
    drop(buffer);
    device.finish();
}

/// One dispatch writes a buffer that the next one reads, with no barrier between them: the layer
/// must say so, or the clean runs elsewhere mean nothing.
///
/// The reader declares the buffer `readonly`. The layer passes over a write after a write through
/// the same kind of binding, and takes every binding that can be written for a write; so had both
/// dispatches the same shader, it would say nothing (1.3.239).
#[test]
fn a_planted_hazard_is_reported() {
    let source = "#version 450\nlayout(local_size_x = 64) in;\n\
        layout(set = 0, binding = 0, std430) readonly buffer From { uint from[]; };\n\
        layout(set = 0, binding = 1, std430) buffer To { uint to[]; };\n\
        void main() { to[gl_GlobalInvocationID.x] = from[gl_GlobalInvocationID.x]; }\n";
    let copy = try_compile("copy.comp", source).unwrap();
    let options = HeadlessOptions { validation: true, ..Default::default() };
    let device = HeadlessDevice::new(&options).unwrap();
    let values = HostBuffer::with_data(&device, "values", &[0_u32; 64], STORAGE).unwrap();
    let copies = HostBuffer::with_data(&device, "copies", &[0_u32; 64], STORAGE).unwrap();
    let writer = ComputeProgram::new(&device, &increment(), 0, &[&values]).unwrap();
    let reader = ComputeProgram::new(&device, &copy, 0, &[&values, &copies]).unwrap();
    device
        .submit_and_wait(|cmd| {
            for program in [&writer, &reader] {
                // SAFETY: recording outside a render pass, and everything outlives the submit. The
                // missing barrier is the point: the values may be wrong, and are not looked at.
                unsafe { program.record(cmd, &[], [1, 1, 1]) }?;
            }
            Ok(())
        })
        .unwrap();
    let messages = device.take_messages();
    assert!(messages.iter().any(|m| m.contains("SYNC-HAZARD-READ-AFTER-WRITE")), "{messages:?}");
    assert!(device.messages().is_empty());
}

/// What is never freed is said while the device is destroyed, and the log keeps it.
#[test]
fn a_leak_is_reported_after_the_device_is_gone() {
    let options = HeadlessOptions { validation: true, ..Default::default() };
    let device = HeadlessDevice::new(&options).unwrap();
    let buffer = HostBuffer::new(&device, "kept", 16, STORAGE).unwrap();
    let fence = vk::FenceCreateInfo::default();
    // SAFETY: the device lives. It is leaked on purpose; the driver's own leak is a few bytes.
    unsafe { device.device().create_fence(&fence, None) }.unwrap();
    let log = device.message_log();
    drop(device);
    assert!(log.messages().is_empty(), "the buffer still holds the device");
    drop(buffer);
    let messages = log.messages();
    assert!(messages.iter().any(|m| m.contains("VkFence")), "{messages:?}");
}

#[test]
fn an_unknown_driver_is_an_error_that_lists_the_devices() {
    let known = device().name().to_owned();
    let options = HeadlessOptions { driver: Some("no such device".into()), ..Default::default() };
    let message = HeadlessDevice::new(&options).unwrap_err().to_string();
    assert!(message.contains("no such device") && message.contains(&known), "{message}");
}

/// The same through the environment, which only another process can have.
#[test]
fn the_environment_picks_the_driver() {
    let this_test = "device::an_environment_with_an_unknown_driver";
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", this_test, "--ignored", "--nocapture"])
        .env("ANTUMBRA_DRIVER", "Voodoo Banshee")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}");
    assert!(text.contains("voodoo banshee") && text.contains("there are \""), "{text}");
}

#[test]
#[ignore = "only makes sense when the_environment_picks_the_driver runs it"]
fn an_environment_with_an_unknown_driver() {
    println!("{}", HeadlessDevice::new(&HeadlessOptions::default()).unwrap_err());
}

#[test]
fn an_image_gives_back_what_was_written() {
    let device = device();
    let layout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
    for (format, channels) in [
        (vk::Format::R32_SFLOAT, 1),
        (vk::Format::R32G32B32A32_SFLOAT, 4),
        (vk::Format::D32_SFLOAT, 1),
    ] {
        let image =
            OwnedImage::new(&device, "floats", format, [7, 5], vk::ImageUsageFlags::SAMPLED)
                .unwrap();
        let texels: Vec<f32> = (0..7 * 5 * channels).map(|i| i as f32 / 256.0).collect();
        image.write(&texels, layout).unwrap();
        assert_eq!(image.read::<f32>(layout).unwrap(), texels, "{format:?}");
    }
    let format = vk::Format::R8_UNORM;
    let image =
        OwnedImage::new(&device, "bytes", format, [3, 3], vk::ImageUsageFlags::SAMPLED).unwrap();
    image.write(&[1_u8, 2, 3, 4, 5, 6, 7, 8, 9], layout).unwrap();
    assert_eq!(image.read::<u8>(layout).unwrap(), [1, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert!(image.write(&[0_u8; 8], layout).unwrap_err().to_string().contains("9 bytes"));
    assert!(image.read::<f32>(layout).unwrap_err().to_string().contains("R8_UNORM"));
}

#[test]
fn what_does_not_fit_is_an_error() {
    let device = device();
    let mut buffer = HostBuffer::new(&device, "small", 8, STORAGE).unwrap();
    let message = buffer.write(&[0_u32; 3]).unwrap_err().to_string();
    assert!(message.contains("small") && message.contains("8 bytes"), "{message}");
    assert!(HostBuffer::new(&device, "empty", 0, STORAGE).is_err());
    assert!(run_compute(&device, &increment(), &[], &[&buffer], [0, 1, 1]).is_err());
    assert!(run_compute(&device, &increment(), &[0; 3], &[&buffer], [1, 1, 1]).is_err());
    let side = device.limits().max_image_dimension2_d + 1;
    let usage = vk::ImageUsageFlags::SAMPLED;
    let image = OwnedImage::new(&device, "huge", vk::Format::R32_SFLOAT, [side, 1], usage);
    assert!(image.unwrap_err().to_string().contains("huge"));
}

/// A host may hand the device and what comes from it to other threads.
#[test]
fn a_device_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<HeadlessDevice>();
    shared::<HostBuffer>();
    shared::<OwnedImage>();
    let device = device();
    std::thread::scope(|scope| {
        for start in [0_u32, 1000] {
            let device: &HeadlessDevice = &device;
            scope.spawn(move || {
                let values = vec![start; 64];
                let buffer = HostBuffer::with_data(device, "values", &values, STORAGE).unwrap();
                for _ in 0..10 {
                    run_compute(device, &increment(), &[], &[&buffer], [1, 1, 1]).unwrap();
                }
                assert_eq!(buffer.read::<u32>(), vec![start + 10; 64]);
            });
        }
    });
}
