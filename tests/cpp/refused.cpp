/* refused.cpp -- lines that a compiler must not take (tests/cpp/run): with CASE 0 it compiles, with any other it does
 * not. */
#include <bhr.hpp>

void refused(bhr::Context &context, bhr::Camera &camera, bhr::Disk &disk);

void refused(bhr::Context &context, bhr::Camera &camera, bhr::Disk &disk) {
    camera.projection = bhr::Projection::fisheye;
    disk.flags = bhr::DiskFlags::retrograde;
    context.set_view(bhr::View::light).value();
#if CASE == 1 // a constant of C
    camera.projection = BHR_MOTION_ORBIT;
#elif CASE == 2 // a constant of another group
    camera.projection = bhr::Motion::orbit;
#elif CASE == 3 // the same as an argument
    context.set_view(bhr::Preset::physical).value();
#elif CASE == 4
    context.set_view(BHR_VIEW_STEPS).value();
#elif CASE == 5 // bits of another struct's
    disk.flags = bhr::SkyFlags::stars;
#elif CASE == 6
    disk.flags = bhr::DiskFlags::retrograde | bhr::SkyFlags::stars;
#elif CASE == 7 // values are no bits
    disk.reference = bhr::DiskReference::at_median | bhr::DiskReference::at_hottest;
#elif CASE == 8 // a result that nobody looks at
    context.set_spin(0.5);
#elif CASE == 9
    context.hole_info();
#elif CASE == 10 // handles have one owner
    bhr::Context copy = context;
#elif CASE == 11 // memory that is constant
    const unsigned char pixels[4] = {};
    bhr::Image image(pixels, 1, 1);
#elif CASE == 12 // a result is no value
    bhr::Camera other = context.camera();
#elif CASE == 13 // a time without a unit
    context.render_async(bhr::Image()).value().wait_for(1000).value();
#endif
}
