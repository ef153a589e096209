// SPDX-License-Identifier: MIT OR Apache-2.0
/* refused.cpp -- lines that a compiler must not take, each marked so (tests/cpp/run). Without REFUSED it compiles. */
#include <bhr.hpp>

void right(bhr::Context &context, bhr::Camera &camera, bhr::Disk &disk);

void right(bhr::Context &context, bhr::Camera &camera, bhr::Disk &disk) {
    camera.projection = bhr::Projection::fisheye;
    disk.flags = bhr::DiskFlags::retrograde | bhr::DiskFlags::plunges;
    context.set_view(bhr::View::light).value();
}

#ifdef REFUSED
void wrong(bhr::Context &context, bhr::Camera &camera, bhr::Disk &disk) {
    /* Constants of C, and constants of another group. */
    camera.projection = BHR_MOTION_ORBIT; // refused
    camera.projection = bhr::Motion::orbit; // refused
    context.set_view(BHR_VIEW_STEPS).value(); // refused
    context.set_view(bhr::Preset::physical).value(); // refused
    /* Bits of another struct's, and values that are no bits. */
    disk.flags = bhr::SkyFlags::stars; // refused
    disk.flags = bhr::DiskFlags::retrograde | bhr::SkyFlags::stars; // refused
    disk.reference = bhr::DiskReference::at_median | bhr::DiskReference::at_hottest; // refused
    /* Results that nobody looks at, or that are taken for values. */
    context.set_spin(0.5); // refused
    context.hole_info(); // refused
    bhr::Camera other = context.camera(); // refused
    /* A handle has one owner. */
    bhr::Context copy = context; // refused
    /* Constant memory for pixels. */
    const unsigned char pixels[4] = {};
    bhr::Image image(pixels, 1, 1); // refused
    /* A time without a unit. */
    context.render_async(bhr::Image()).value().wait_for(1000).value(); // refused
}
#endif
