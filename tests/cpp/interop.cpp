// SPDX-License-Identifier: MIT OR Apache-2.0
/* interop.cpp -- a C++ host of bhr/interop.hpp: frames into targets of bhr's and into memory of its own, semaphores,
 * handles on their way, what frames read, and a Vulkan device that it shares (tests/interop/vk.h). Compiled with and
 * without exceptions (tests/cpp/run). Prints what went wrong; the exit status is 0 if nothing did. */
#include <bhr/interop.hpp>

extern "C" {
#include "../interop/vk.h"
}

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <mutex>

static constexpr std::uint32_t width = 64, height = 48;
static constexpr std::size_t bytes = std::size_t(width) * height * 4;

static std::atomic<int> failures{0};

static void expect(bool good, int line, const char *text) {
    if (!good) {
        failures++;
        std::printf("line %d: %s: %s\n", line, text, bhr_error_message());
    }
}
#define EXPECT(...) expect(static_cast<bool>(__VA_ARGS__), __LINE__, #__VA_ARGS__)

using Pixels = std::vector<std::byte>;

static Pixels expected(bhr::Context &context) {
    bhr::Frame frame = context.render(width, height).value();
    return Pixels(frame.bytes().begin(), frame.bytes().end());
}

static bool is_open(int fd) { return ::fcntl(fd, F_GETFD) != -1; }

/* A block of the host's, as imports want it: whole pages. */
struct Pages {
    std::size_t size = (bytes + 65535) / 65536 * 65536;
    void *memory = std::aligned_alloc(65536, size);
    Pages() { std::memset(memory, 0, size); }
    Pages(const Pages &) = delete;
    Pages &operator=(const Pages &) = delete;
    ~Pages() { std::free(memory); }
    bool holds(const Pixels &pixels) const { return std::memcmp(memory, pixels.data(), pixels.size()) == 0; }
    void clear() { std::memset(memory, 0, size); }
};

/* A target over a block, whose pixels the host can see. */
static bhr::Result<bhr::Target> over(bhr::Context &context, const Pages &pages) {
    bhr::TargetInfo memory = {};
    memory.struct_size = sizeof memory;
    memory.allocation_size = pages.size;
    memory.row_stride = width * 4;
    const bhr::TargetOptions options(bhr::TargetKind::buffer, bhr::Format::rgba8_srgb, width, height);
    return bhr::Target::import_(context, options, memory, bhr::SharedHandle::host_pointer(pages.memory));
}

static void adapters(const bhr::Context &context) {
    const bhr::InteropInfo info = bhr::interop_info(context).value();
    std::array<std::uint8_t, 16> uuid;
    std::memcpy(uuid.data(), info.device_uuid, uuid.size());
    EXPECT(bhr::find_adapter(uuid).value() >= 0);
    EXPECT((info.import_buffers & static_cast<std::uint32_t>(bhr::HandleType::host_pointer)) != 0);
    const bhr::Result<std::int32_t> none = bhr::find_adapter(std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
    EXPECT(!none);
}

static void frames(bhr::Context &context) {
    const Pages pages;
    const Pixels pixels = expected(context);
    bhr::Target target = over(context, pages).value();
    bhr::Semaphore done = bhr::Semaphore::create(context).value();
    EXPECT(target.info().value().row_stride == width * 4);
    EXPECT(!done.wait_for(1, std::chrono::milliseconds(1)).value());

    const bhr::SemaphoreValue first[] = {done.at(1)};
    EXPECT(bhr::render_target(context, target, {{}, first}));
    EXPECT(done.wait(1) && pages.holds(pixels));

    /* The frame waits for the host, which signals when it has cleared the memory. */
    const_cast<Pages &>(pages).clear();
    const bhr::SemaphoreValue second[] = {done.at(2)}, third[] = {done.at(3)};
    bhr::Job job = bhr::render_target_async(context, target, {second, third}).value();
    EXPECT(!done.wait_for(3, std::chrono::seconds(0)).value());
    EXPECT(done.signal(2) && job.wait() && done.wait(3) && pages.holds(pixels));
    EXPECT(job.stats().value().rays > 0);
    EXPECT(bhr::render_target_job(context, target).value().wait());

    const bhr::Result<void> back = done.signal(2);
    EXPECT(back.status() == bhr::StatusCode::invalid_argument);
    const bhr::SemaphoreValue twice[] = {done.at(9), done.at(9)};
    EXPECT(bhr::render_target(context, target, {{}, twice}).status() == bhr::StatusCode::invalid_argument);
    const std::vector<bhr::SemaphoreValue> many(9, done.at(4));
    EXPECT(bhr::render_target(context, target, {many, {}}).status() == bhr::StatusCode::invalid_argument);

    /* An object that was moved from is refused; the one that it was moved to goes on. */
    bhr::Target moved = std::move(target);
    EXPECT(bhr::render_target(context, target).status() == bhr::StatusCode::invalid_argument);
    EXPECT(target.info().status() == bhr::StatusCode::invalid_argument && moved.get() != nullptr);
    bhr::Semaphore elsewhere = std::move(done);
    EXPECT(done.wait(3).status() == bhr::StatusCode::invalid_argument && elsewhere.wait(3));
}

static void outputs(bhr::Context &context) {
    const auto target = [&](bhr::Format format) {
        return bhr::Target::create(context, {bhr::TargetKind::buffer, format, width, height}).value();
    };
    const bhr::Target light = target(bhr::Format::rgba16f), depth = target(bhr::Format::r32f);
    const bhr::Output list[] = {bhr::output_into(bhr::OutputKind::light, light),
                                bhr::output_into(bhr::OutputKind::depth, depth)};
    bhr::Semaphore done = bhr::Semaphore::create(context).value();
    const bhr::SemaphoreValue one[] = {done.at(1)}, two[] = {done.at(2)};
    EXPECT(bhr::render_outputs_shared(context, list, {{}, one}) && done.wait(1));
    EXPECT(bhr::render_outputs_shared_job(context, list).value().wait());
    EXPECT(bhr::render_outputs_shared_async(context, list, {{}, two}).value().wait() && done.wait(2));
    const bhr::Output wrong[] = {bhr::output_into(bhr::OutputKind::sky, depth)};
    EXPECT(bhr::render_outputs_shared(context, wrong).status() == bhr::StatusCode::invalid_argument);
}

/* Descriptors: whoever has one closes it. */
static void handles(bhr::Context &context) {
    const bhr::InteropInfo info = bhr::interop_info(context).value();
    EXPECT((info.export_buffers & BHR_HANDLE_OPAQUE_FD) != 0);
    const int before = open_descriptors();
    {
        const bhr::TargetOptions options(bhr::TargetKind::buffer, bhr::Format::rgba8_srgb, width, height,
                                         bhr::HandleType::opaque_fd);
        bhr::Target target = bhr::Target::create(context, options).value();
        bhr::SharedHandle handle = target.export_().value();
        const int fd = handle.fd();
        EXPECT(handle.type() == bhr::HandleType::opaque_fd && is_open(fd));
        /* Refused: the handle keeps it. */
        bhr::TargetInfo memory = target.info().value();
        memory.allocation_size = 16;
        EXPECT(!bhr::Target::import_(context, options, memory, std::move(handle)));
        EXPECT(handle.fd() == fd && is_open(fd));
        bhr::Target same = bhr::Target::import_(context, options, target.info().value(), std::move(handle)).value();
        EXPECT(handle.fd() == -1 && handle.type() == bhr::HandleType::none);
        EXPECT(bhr::render_target_job(context, same).value().wait());
        handle = target.export_().value();
        bhr::SharedHandle other = std::move(handle);
        other = target.export_().value();
        const BhrHandle raw = other.release();
        EXPECT(is_open(raw.fd) && other.fd() == -1);
        const bhr::SharedHandle last(raw);
        /* Where semaphores are shared (lavapipe shares none) one goes out and comes back. */
        if ((info.semaphores[BHR_SEMAPHORE_TIMELINE] & BHR_HANDLE_OPAQUE_FD) != 0) {
            const auto timeline = bhr::SemaphoreKind::timeline;
            bhr::Semaphore out = bhr::Semaphore::create(context, timeline, bhr::HandleType::opaque_fd).value();
            bhr::SharedHandle shared = out.export_().value();
            bhr::Semaphore in = bhr::Semaphore::import_(context, timeline, std::move(shared)).value();
            EXPECT(shared.fd() == -1 && out.signal(7) && in.wait_for(7, std::chrono::seconds(5)).value());
        }
        const bhr::Result<bhr::Semaphore> wrong =
            bhr::Semaphore::import_(context, bhr::SemaphoreKind::timeline, bhr::SharedHandle::opaque_fd(-1));
        EXPECT(wrong.status() == bhr::StatusCode::invalid_argument || wrong.status() == bhr::StatusCode::unsupported);
        EXPECT(!bhr::Semaphore::create(context).value().export_());
        EXPECT(!bhr::Target::create(context, {bhr::TargetKind::buffer, bhr::Format::rgba8_srgb, width, height})
                    .value()
                    .export_());
    }
    EXPECT(open_descriptors() == before);
}

/* Frames read an occluder and a sky until they are taken away again. */
static void read_targets(bhr::Context &context) {
    const bhr::TargetOptions distances(bhr::TargetKind::buffer, bhr::Format::r32f, width, height);
    bhr::Target occluder = bhr::Target::create(context, distances).value();
    bhr::Target sky =
        bhr::Target::create(context, {bhr::TargetKind::buffer, bhr::Format::rgba16f, 2 * height, height}).value();
    EXPECT(bhr::set_occluder_target(context, &occluder, bhr::ImageFlags::lensed));
    EXPECT(bhr::set_sky_target(context, &sky));
    EXPECT(context.render(width, height));
    bhr::Target cube =
        bhr::Target::create(context, {bhr::TargetKind::buffer, bhr::Format::rgba16f, 6 * 16, 16}).value();
    EXPECT(bhr::set_sky_target_as(context, &cube, bhr::Projection::cube));
    EXPECT(!bhr::set_sky_target_as(context, &sky, bhr::Projection::cube));
    EXPECT(!bhr::set_sky_target_as(context, &sky, bhr::Projection::fisheye));
    EXPECT(context.render(width, height));
    EXPECT(bhr::set_occluder_target(context, &sky).status() == bhr::StatusCode::invalid_argument);
    EXPECT(bhr::set_sky_target(context, nullptr) && bhr::set_occluder_target(context, nullptr));
    EXPECT(context.render(width, height));
}

/* ---- a device of the host's ---- */

struct Counts {
    std::mutex queue;
    std::atomic<int> turns{0}, released{0};
};

static void adopted(const Pixels &pixels) {
    Counts counts;
    const auto device_released = std::make_shared<int>(0);
    const bhr::QueueLock queue = {[&] { counts.queue.lock(); counts.turns++; }, [&] { counts.queue.unlock(); }};
    const bhr::ReleaseFunction release = [&, device_released] { counts.released++; };
    bhr::ContextOptions options;
    options.backend = bhr::Backend::vulkan;

    /* A device that is refused is not released, and no functor is kept. */
    EXPECT(bhr::create_on_vulkan({}, options, queue, release).status() == bhr::StatusCode::invalid_argument);
    EXPECT(bhr::create_on_vulkan({}, options, {queue.lock, {}}).status() == bhr::StatusCode::invalid_argument);
    EXPECT(counts.released == 0 && device_released.use_count() == 2);

    Vk host;
    vk_open_instance(&host, nullptr, VK_API_VERSION_1_3, 0);
    const auto get = reinterpret_cast<BhrGetInstanceProcAddr>(vkGetInstanceProcAddr);
    EXPECT(bhr::vulkan_requirements(get).value().api_version >= VK_API_VERSION_1_2);
    const auto nothing = bhr::vulkan_requirements(nullptr, host.instance, host.physical);
    EXPECT(nothing.status() == bhr::StatusCode::invalid_argument);
    const bhr::VulkanRequirements needs = bhr::vulkan_requirements(get, host.instance, host.physical).value();
    vk_open_required(&host, &needs);
    {
        bhr::Context context = bhr::create_on_vulkan(vk_for_bhr(&host), options, queue, release).value();
        EXPECT(expected(context) == pixels && counts.turns > 0);

        int images_released = 0;
        VkPicture picture = vk_make_image(&host, VK_FORMAT_R16G16B16A16_SFLOAT, width, height,
                                          VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, nullptr);
        const bhr::TargetOptions shape(bhr::TargetKind::image, bhr::Format::rgba16f, width, height);
        const auto handle_of = [](auto handle) { return std::uint64_t(handle); };
        {
            const bhr::ReleaseFunction count = [&] { images_released++; };
            bhr::TargetOptions wrong = shape;
            wrong.width = 0;
            const std::uint64_t image = handle_of(picture.image);
            EXPECT(!bhr::Target::wrap_vulkan(context, wrong, image, picture.info.vk_usage, count));
            EXPECT(images_released == 0);
            bhr::Target target =
                bhr::Target::wrap_vulkan(context, shape, image, picture.info.vk_usage, count).value();
            EXPECT(target.vulkan().value().image == image && target.vulkan().value().buffer == 0);

            VkSemaphore timeline = vk_timeline(&host);
            {
                bhr::Semaphore done =
                    bhr::Semaphore::wrap_vulkan(context, bhr::SemaphoreKind::timeline, handle_of(timeline)).value();
                EXPECT(done.vulkan().value() == handle_of(timeline));
                const bhr::SemaphoreValue one[] = {done.at(1)};
                bhr::Job job = bhr::render_target_job(context, target, {{}, one}).value();
                EXPECT(job.wait() && done.wait(1));
            }
            vkDestroySemaphore(host.device, timeline, nullptr);
        }
        EXPECT(context.render(width, height) && images_released == 1);
        vk_drop(&host, &picture);
        EXPECT(counts.released == 0);
    }
    EXPECT(counts.released == 1);

    /* The callbacks in the struct count where there are no functors. */
    static std::mutex c_queue;
    static std::atomic<int> turns, released;
    {
        bhr::VulkanDevice device = vk_for_bhr(&host);
        device.lock = [](void *) { c_queue.lock(); turns++; };
        device.unlock = [](void *) { c_queue.unlock(); };
        device.release = [](void *user) { ++*static_cast<std::atomic<int> *>(user); };
        device.release_user = &released;
        bhr::Context context = bhr::create_on_vulkan(device, options).value();
        EXPECT(context.render(width, height) && turns > 0 && released == 0);
    }
    EXPECT(released == 1);
#ifndef BHR_NO_EXCEPTIONS
    /* An exception of a functor leaves the call that it ran in; a lock that threw is not given back. */
    std::atomic<int> locks{0}, unlocks{0};
    std::atomic<bool> throws{false};
    {
        const bhr::QueueLock wild = {[&] {
                                        if (throws)
                                            throw 5;
                                        counts.queue.lock();
                                        locks++;
                                    },
                                    [&] {
                                        unlocks++;
                                        counts.queue.unlock();
                                    }};
        bhr::Context context = bhr::create_on_vulkan(vk_for_bhr(&host), options, wild).value();
        bhr::Target target =
            bhr::Target::create(context, {bhr::TargetKind::buffer, bhr::Format::rgba8_srgb, width, height}).value();
        int caught = 0;
        throws = true;
        try {
            static_cast<void>(bhr::render_target(context, target));
        } catch (int thrown) {
            caught = thrown;
        }
        throws = false;
        EXPECT(caught == 5 && context.render(width, height));
    }
    EXPECT(locks > 0 && locks == unlocks);
#endif
    vk_close(&host);
}

int main() {
    {
        bhr::ContextOptions options(bhr::Backend::cpu);
        bhr::Context cpu = bhr::Context::create(options).value();
        EXPECT(bhr::Semaphore::create(cpu).status() == bhr::StatusCode::unsupported);
        EXPECT(bhr::Target::create(cpu, {bhr::TargetKind::buffer, bhr::Format::rgba8_srgb, width, height}).status() ==
               bhr::StatusCode::unsupported);
    }
    Pixels pixels;
    {
        bhr::Context context = bhr::Context::create(bhr::ContextOptions(bhr::Backend::vulkan)).value();
        pixels = expected(context);
        adapters(context);
        frames(context);
        outputs(context);
        handles(context);
        read_targets(context);
        /* Ends in any order. */
        bhr::Target after = bhr::Target::create(context, {bhr::TargetKind::image, bhr::Format::rgba16f, 8, 8}).value();
        bhr::Semaphore late = bhr::Semaphore::create(context).value();
        context = bhr::Context::create(bhr::ContextOptions(bhr::Backend::cpu)).value();
        EXPECT(late.wait(1).status() == bhr::StatusCode::surface_lost);
        EXPECT(after.export_().status() != bhr::StatusCode::ok);
    }
    adopted(pixels);
    std::printf("%d failed\n", failures.load());
    return failures == 0 ? 0 : 1;
}
