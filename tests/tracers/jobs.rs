// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames in the background: they equal frames that were waited for, end in their order, and end however they are
//! left. On whatever adapter comes first (lavapipe counts), and on the CPU tracer.

use crate::frames::plain;
use bhr::error::ErrorKind;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::job::Job;
use bhr::renderer::{Backend, Renderer, RendererOptions};
use std::time::Duration;

const SIZE: [u32; 2] = [96, 54];

fn renderers() -> [Renderer; 2] {
    let cpu = RendererOptions { backend: Some(Backend::Cpu), ..Default::default() };
    [RendererOptions::default(), cpu].map(plain)
}

/// Memory that a job may write to whatever becomes of the test.
fn target(size: [u32; 2]) -> (&'static [u8], ImageMut<'static>) {
    let bytes = (size[0] * size[1] * 4) as usize;
    let block = Box::leak(vec![0xee_u8; bytes].into_boxed_slice());
    let (pixels, length) = (block.as_mut_ptr(), block.len());
    let layout = Layout::packed(PixelFormat::Rgba8Srgb, size[0], size[1]);
    // SAFETY: leaked; looked at only once the job has ended.
    unsafe { (std::slice::from_raw_parts(pixels, length), ImageMut::from_raw(layout, pixels, length as u64).unwrap()) }
}

fn request_frame(renderer: &mut Renderer, target: ImageMut<'static>) -> Job {
    renderer.render_in_background(target, false, None).unwrap()
}

fn wait(job: &Job) -> bhr::error::Result<bhr::renderer::FrameStats> {
    job.wait(Some(Duration::from_secs(120)), &mut |_| true).expect("an end")
}

/// A frame of several submissions.
fn slow(renderer: &mut Renderer) {
    renderer.scene.quality.samples_per_pixel = 64;
    renderer.scene.hole.spin = 0.5;
}

#[test]
fn jobs_are_frames_of_the_scene_at_their_order_and_end_in_it() {
    for mut renderer in renderers() {
        let jobs = (0..12)
            .map(|i| {
                renderer.scene.camera.forward.x = 0.02 * f64::from(i);
                renderer.scene.hole.spin = if i % 4 == 3 { 0.7 } else { 0.0 };
                renderer.scene.quality.mapped_pixels = Some(i % 3 == 0);
                let (pixels, image) = target(SIZE);
                (renderer.scene.clone(), pixels, request_frame(&mut renderer, image))
            })
            .collect::<Vec<_>>();
        let last = wait(&jobs[11].2).unwrap();
        for (i, (scene, pixels, job)) in jobs.iter().enumerate() {
            let stats = job.outcome().expect("frames end in their order").unwrap();
            assert_eq!(stats.frame_index + 11 - i as u64, last.frame_index);
            assert_eq!((stats.rays, job.fraction()), (u64::from(SIZE[0] * SIZE[1]), 1.0));
            renderer.scene = scene.clone();
            let mut waited = vec![0; pixels.len()];
            let layout = Layout::packed(PixelFormat::Rgba8Srgb, SIZE[0], SIZE[1]);
            renderer.render(&mut ImageMut::new(layout, &mut waited).unwrap(), false, None, &mut |_| true).unwrap();
            assert!(waited == *pixels, "job {i} on {}", renderer.adapter().name);
        }
    }
}

#[test]
fn a_cancelled_job_ends_and_the_others_are_made() {
    for mut renderer in renderers() {
        slow(&mut renderer);
        let jobs = (0..4).map(|_| request_frame(&mut renderer, target(SIZE).1)).collect::<Vec<_>>();
        jobs[2].cancel();
        jobs[1].wait(None, &mut |fraction| fraction == 0.0);
        let ends = jobs.iter().map(|job| wait(job).map_err(|error| error.kind)).collect::<Vec<_>>();
        assert!(ends[0].is_ok() && ends[3].is_ok(), "{ends:?}");
        assert_eq!(ends[2].err(), Some(ErrorKind::Cancelled));
        // The second may have been done before it heard.
        assert!(ends[1].as_ref().err().is_none_or(|kind| *kind == ErrorKind::Cancelled));
        wait(&request_frame(&mut renderer, target(SIZE).1)).unwrap();
    }
}

#[test]
fn dropping_the_renderer_finishes_its_jobs() {
    for mut renderer in renderers() {
        slow(&mut renderer);
        let jobs = (0..3).map(|_| request_frame(&mut renderer, target(SIZE).1)).collect::<Vec<_>>();
        drop(renderer);
        assert!(jobs.iter().all(|job| job.outcome().expect("an end").is_ok()));
    }
}

#[test]
fn jobs_and_frames_that_are_waited_for_take_turns() {
    let [mut renderer, _] = renderers();
    slow(&mut renderer);
    let jobs = (0..8).map(|_| request_frame(&mut renderer, target(SIZE).1)).collect::<Vec<_>>();
    let (_, mut image) = target(SIZE);
    renderer.render(&mut image, false, None, &mut |_| true).unwrap();
    assert!(jobs[7].outcome().is_none(), "a frame waited for all jobs, or too few were under way to tell");
    assert!(jobs.iter().all(|job| wait(job).is_ok()));
}

#[test]
fn a_device_that_is_lost_ends_every_job() {
    // Before the first job begins, perhaps, and while jobs are under way.
    for begun in [false, true] {
        let [mut renderer, _] = renderers();
        slow(&mut renderer);
        let jobs = (0..8).map(|_| request_frame(&mut renderer, target(SIZE).1)).collect::<Vec<_>>();
        if begun {
            wait(&jobs[0]).unwrap();
        }
        renderer.lose_device().unwrap();
        let lost = jobs.iter().filter_map(|job| wait(job).err()).collect::<Vec<_>>();
        assert!(!lost.is_empty() && lost.iter().all(|error| error.kind == ErrorKind::DeviceLost), "{lost:?}");
        renderer.recover().unwrap();
        renderer.scene = Default::default();
        wait(&request_frame(&mut renderer, target(SIZE).1)).unwrap();
    }
}
