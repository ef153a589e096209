/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* vulkan_host.c -- bhr on a VkDevice of the host's: the host makes instance, device, window, swapchain and image, bhr
 * renders into the image, and one timeline semaphore says whose turn it is. Each frame is then the host's: here it is
 * drawn over the whole window, into an image of the swapchain. With --out there is no window, and the last frame is
 * read back and written. (bhr also fills images of a swapchain itself: wrapped with BHR_TARGET_COPY and left in
 * VK_IMAGE_LAYOUT_PRESENT_SRC_KHR. A host that draws more than bhr's picture has an image between, as here.)
 *
 *     cc vulkan_host.c -lbhr -lvulkan -lglfw -o vulkan_host && ./vulkan_host
 *     ./vulkan_host --frames 60 --out hole.ppm
 *
 * --frames N: ends after N frames; 60 without a window, else until the window is closed. */
#include <bhr_interop.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h> /* after Vulkan's header, whose types it then takes */

#define WIDTH 640
#define HEIGHT 360

static VkInstance       instance;
static VkPhysicalDevice physical;
static VkDevice         device;
static VkQueue          queue;
static VkCommandBuffer  commands;
static VkImage          image; /* bhr's frames, in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL */

/* The window, NULL without; and what is made anew when its size changes. */
#define MOST_IMAGES 8
static GLFWwindow    *window;
static VkSurfaceKHR   surface;
static VkSwapchainKHR swapchain;
static VkExtent2D     extent;
static VkImage        shown[MOST_IMAGES];
static VkSemaphore    acquired, drawn[MOST_IMAGES];

static void stop(const char *what, const char *why) {
    fprintf(stderr, "vulkan_host: %s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

static void vk(VkResult result, const char *what) {
    if (result != VK_SUCCESS)
        stop(what, "Vulkan refused it");
}

static void bhr(BhrStatus status, const char *what) {
    if (status < BHR_OK)
        stop(what, bhr_error_message());
}

#define MOST_NAMES 64

/* The names that bhr asks for, and then the host's own. */
static uint32_t joined(const char **all, const char *const *some, uint32_t count, const char **more, uint32_t others) {
    if (count + others > MOST_NAMES)
        stop("extensions", "too many");
    for (uint32_t i = 0; i < count + others; i++)
        all[i] = i < count ? some[i] : more[i - count];
    return count + others;
}

static VkSemaphore new_semaphore(VkSemaphoreType kind) {
    VkSemaphoreTypeCreateInfo type = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO, .semaphoreType = kind};
    VkSemaphoreCreateInfo     create = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore               made;
    vk(vkCreateSemaphore(device, &create, NULL, &made), "a semaphore");
    return made;
}

/* Instance, device and queue with what bhr needs, and what the window does. Returns what bhr is to be told of them. */
static BhrVulkanDevice make_device(void) {
    static const char    *of_instance[MOST_NAMES], *of_the_device[MOST_NAMES];
    const char           *for_window = VK_KHR_SWAPCHAIN_EXTENSION_NAME, **for_surfaces = NULL;
    uint32_t              surfaces = 0;
    BhrVulkanRequirements needs;
    BHR_INIT(needs);
    bhr(bhr_vulkan_requirements(NULL, NULL, NULL, &needs), "what bhr needs");
    if (window && !(for_surfaces = glfwGetRequiredInstanceExtensions(&surfaces)))
        stop("a window", "Vulkan does not draw in windows here");
    VkApplicationInfo    app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = needs.api_version};
    VkInstanceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                   .pApplicationInfo = &app,
                                   .enabledExtensionCount =
                                       joined(of_instance, needs.instance_extensions, needs.instance_extension_count,
                                              for_surfaces, surfaces),
                                   .ppEnabledExtensionNames = of_instance};
    vk(vkCreateInstance(&create, NULL, &instance), "an instance");
    if (window)
        vk(glfwCreateWindowSurface(instance, window, NULL, &surface), "a surface");
    uint32_t one = 1;
    if (vkEnumeratePhysicalDevices(instance, &one, &physical) < 0 || one == 0)
        stop("a GPU", "Vulkan has none");

    BhrGetInstanceProcAddr  find = (BhrGetInstanceProcAddr)vkGetInstanceProcAddr;
    BhrVulkanRequirements   of_device;
    BHR_INIT(of_device);
    float                   priority = 1;
    VkDeviceQueueCreateInfo queues = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    bhr(bhr_vulkan_requirements(find, instance, physical, &of_device), "what bhr needs of the GPU");
    VkDeviceCreateInfo make = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .pNext = of_device.features,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queues,
                               .enabledExtensionCount =
                                   joined(of_the_device, of_device.device_extensions,
                                          of_device.device_extension_count, &for_window, window != NULL),
                               .ppEnabledExtensionNames = of_the_device};
    vk(vkCreateDevice(physical, &make, NULL, &device), "a device");
    vkGetDeviceQueue(device, 0, 0, &queue);
    /* A host that uses the queue on several threads gives lock and unlock here. */
    BhrVulkanDevice told = {.struct_size = sizeof told,
                            .api_version = needs.api_version,
                            .get_instance_proc_addr = find,
                            .instance = instance,
                            .physical_device = physical,
                            .device = device,
                            .instance_extensions = of_instance,
                            .instance_extension_count = create.enabledExtensionCount,
                            .device_extensions = of_the_device,
                            .device_extension_count = make.enabledExtensionCount};
    return told;
}

/* ---- the host's swapchain ---- */

/* For the window's present size; 0 while that is nothing. */
static int make_swapchain(void) {
    VkSurfaceCapabilitiesKHR can;
    VkSurfaceFormatKHR       formats[64];
    VkBool32                 presents = VK_FALSE;
    uint32_t                 count = 64, chosen = 0;
    int                      width, height;
    vk(vkGetPhysicalDeviceSurfaceSupportKHR(physical, 0, surface, &presents), "a surface's queue");
    if (!presents)
        stop("a window", "the GPU's first queue does not present to it");
    vk(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(physical, surface, &can), "what the window can");
    if (vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, &count, formats) < 0 || count == 0)
        stop("a window", "it has no format");
    /* bhr's image holds sRGB codes: a format that encodes again would do so twice. */
    while (chosen < count && formats[chosen].format != VK_FORMAT_B8G8R8A8_UNORM &&
           formats[chosen].format != VK_FORMAT_R8G8B8A8_UNORM)
        chosen++;
    if (chosen == count || !(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
        stop("a window", "it takes no codes of 8 bits by a copy");
    glfwGetFramebufferSize(window, &width, &height);
    extent = can.currentExtent;
    if (extent.width == UINT32_MAX)
        extent = (VkExtent2D){(uint32_t)width, (uint32_t)height};
    if (extent.width == 0 || extent.height == 0)
        return 0;
    VkSwapchainKHR           old = swapchain;
    VkSwapchainCreateInfoKHR create = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = surface,
        .minImageCount = can.minImageCount + (can.maxImageCount != can.minImageCount),
        .imageFormat = formats[chosen].format,
        .imageColorSpace = formats[chosen].colorSpace,
        .imageExtent = extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .preTransform = can.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE,
        .oldSwapchain = old};
    vk(vkDeviceWaitIdle(device), "the GPU's rest");
    vk(vkCreateSwapchainKHR(device, &create, NULL, &swapchain), "a swapchain");
    vkDestroySwapchainKHR(device, old, NULL);
    count = MOST_IMAGES;
    if (vkGetSwapchainImagesKHR(device, swapchain, &count, shown) != VK_SUCCESS)
        stop("a swapchain", "it has too many images");
    for (uint32_t i = 0; i < count; i++)
        drawn[i] = drawn[i] ? drawn[i] : new_semaphore(VK_SEMAPHORE_TYPE_BINARY);
    return 1;
}

static void change_layout(VkImage of, VkImageLayout from, VkImageLayout to, VkAccessFlags before, VkAccessFlags after) {
    VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .srcAccessMask = before,
                                    .dstAccessMask = after,
                                    .oldLayout = from,
                                    .newLayout = to,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = of,
                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL,
                         1, &barrier);
}

/* The host's picture, into an image of the swapchain: bhr's frame over all of it. */
static void record_drawing(uint32_t index) {
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkImageBlit whole = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                         .srcOffsets = {{0, 0, 0}, {WIDTH, HEIGHT, 1}},
                         .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                         .dstOffsets = {{0, 0, 0}, {(int32_t)extent.width, (int32_t)extent.height, 1}}};
    vk(vkBeginCommandBuffer(commands, &begin), "commands");
    change_layout(shown[index], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
                  VK_ACCESS_TRANSFER_WRITE_BIT);
    vkCmdBlitImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, shown[index],
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole, VK_FILTER_LINEAR);
    change_layout(shown[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                  VK_ACCESS_TRANSFER_WRITE_BIT, 0);
    vk(vkEndCommandBuffer(commands), "commands");
}

/* The next image to draw into; 0: none now, and the window's events come first. */
static int next_image(uint32_t *index) {
    VkResult result = VK_ERROR_OUT_OF_DATE_KHR;
    if (swapchain)
        result = vkAcquireNextImageKHR(device, swapchain, UINT64_MAX, acquired, VK_NULL_HANDLE, index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        if (!make_swapchain())
            glfwWaitEventsTimeout(0.1);
        return 0;
    }
    if (result != VK_SUBOPTIMAL_KHR)
        vk(result, "an image of the swapchain");
    return 1;
}

static void present(uint32_t index) {
    VkPresentInfoKHR present = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .waitSemaphoreCount = 1,
                                .pWaitSemaphores = &drawn[index],
                                .swapchainCount = 1,
                                .pSwapchains = &swapchain,
                                .pImageIndices = &index};
    VkResult result = vkQueuePresentKHR(queue, &present);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
        make_swapchain();
    else
        vk(result, "presenting");
}

static void end_window(void) {
    vk(vkDeviceWaitIdle(device), "the GPU's rest");
    for (int i = 0; i < MOST_IMAGES; i++)
        vkDestroySemaphore(device, drawn[i], NULL);
    vkDestroySemaphore(device, acquired, NULL);
    vkDestroySwapchainKHR(device, swapchain, NULL);
    vkDestroySurfaceKHR(instance, surface, NULL);
}

/* ---- frames ---- */

static VkDeviceMemory memory_of(VkMemoryRequirements needs, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties all;
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    VkDeviceMemory       memory;
    vkGetPhysicalDeviceMemoryProperties(physical, &all);
    while (!(needs.memoryTypeBits >> allocate.memoryTypeIndex & 1) ||
           (all.memoryTypes[allocate.memoryTypeIndex].propertyFlags & flags) != flags)
        if (++allocate.memoryTypeIndex == all.memoryTypeCount)
            stop("memory", "no type fits");
    vk(vkAllocateMemory(device, &allocate, NULL, &memory), "memory");
    return memory;
}

int main(int argc, char **argv) {
    int         frames = 0;
    const char *out = NULL;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--frames") == 0)
            frames = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--out") == 0)
            out = argv[i + 1];
    }
    if (!out) {
        if (!glfwInit())
            stop("a window", "there is no display; --out FILE needs none");
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
        if (!(window = glfwCreateWindow(WIDTH, HEIGHT, "vulkan_host", NULL, NULL)))
            stop("a window", "GLFW makes none");
    } else if (frames <= 0) {
        frames = 60;
    }
    BhrVulkanDevice told = make_device();
    BhrContext     *context;
    bhr(bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, &told, &context), "a context on the device");
    bhr(bhr_set_spin(context, 0.9), "a spinning hole");

    /* The host's image, in which bhr leaves frames as copies want them. */
    VkImageCreateInfo shape = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = VK_FORMAT_R8G8B8A8_UNORM,
                               .extent = {WIDTH, HEIGHT, 1},
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    VkMemoryRequirements needs;
    vk(vkCreateImage(device, &shape, NULL, &image), "an image");
    vkGetImageMemoryRequirements(device, image, &needs);
    VkDeviceMemory memory = memory_of(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    vk(vkBindImageMemory(device, image, memory, 0), "the image's memory");
    BhrTargetOptions options;
    BhrTarget       *target;
    bhr(bhr_target_options_init(&options, sizeof options), "options");
    options.width = WIDTH;
    options.height = HEIGHT;
    options.layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    bhr(bhr_target_wrap_vulkan(context, &options, (uint64_t)image, shape.usage, NULL, NULL, &target), "the target");

    /* Odd values: bhr has rendered. Even ones: the host has read. */
    VkSemaphore   turn = new_semaphore(VK_SEMAPHORE_TYPE_TIMELINE);
    BhrSemaphore *shared;
    bhr(bhr_semaphore_wrap_vulkan(context, BHR_SEMAPHORE_TIMELINE, (uint64_t)turn, &shared), "the semaphore");

    /* Without a window each frame is copied to where the CPU can read it. */
    VkBufferCreateInfo room = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = WIDTH * HEIGHT * 4,
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkBuffer           buffer;
    vk(vkCreateBuffer(device, &room, NULL, &buffer), "a buffer");
    vkGetBufferMemoryRequirements(device, buffer, &needs);
    VkDeviceMemory visible =
        memory_of(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    vk(vkBindBufferMemory(device, buffer, visible, 0), "the buffer's memory");
    VkCommandPoolCreateInfo     pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                             .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    VkCommandPool               pool;
    VkCommandBufferAllocateInfo one = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                       .commandBufferCount = 1};
    VkCommandBufferBeginInfo    begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_SIMULTANEOUS_USE_BIT};
    VkBufferImageCopy           whole = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                         .imageExtent = {WIDTH, HEIGHT, 1}};
    VkMemoryBarrier             to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                           .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                           .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vk(vkCreateCommandPool(device, &pool_info, NULL, &pool), "a command pool");
    one.commandPool = pool;
    vk(vkAllocateCommandBuffers(device, &one, &commands), "commands");
    if (window)
        acquired = new_semaphore(VK_SEMAPHORE_TYPE_BINARY);
    vk(vkBeginCommandBuffer(commands, &begin), "commands");
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &whole);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, NULL,
                         0, NULL);
    vk(vkEndCommandBuffer(commands), "commands");

    uint64_t value = 0;
    int      frame = 0;
    while (window ? !glfwWindowShouldClose(window) && (frames == 0 || frame < frames) : frame < frames) {
        uint32_t index = 0;
        /* The commands and the semaphore of the last frame are free again. */
        bhr(bhr_semaphore_wait(shared, value, UINT64_MAX), "waiting for the last frame");
        if (window) {
            glfwPollEvents();
            if (!next_image(&index))
                continue;
            record_drawing(index);
        }
        BhrCamera camera;
        bhr(bhr_camera_init(&camera, sizeof camera), "a camera");
        bhr(bhr_camera_orbit(&camera, 24, 0.05 * frame, 0.12), "an orbit");
        bhr(bhr_set_camera(context, &camera), "the camera");
        BhrSemaphoreValue wait = {shared, value}, signal = {shared, value + 1};
        BhrSync           sync = {.struct_size = sizeof sync,
                                  .wait_count = 1,
                                  .signal_count = 1,
                                  .waits = &wait,
                                  .signals = &signal};
        bhr(bhr_render_target(context, target, &sync, NULL), "a frame");
        /* Binary semaphores have no values, but places in the lists. */
        uint64_t                      rendered[] = {value + 1, 0}, read[] = {value + 2, 0};
        VkSemaphore                   waits[] = {turn, acquired}, signals[] = {turn, drawn[index]};
        VkPipelineStageFlags          stages[] = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT};
        uint32_t                      count = window ? 2 : 1;
        VkTimelineSemaphoreSubmitInfo values = {.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
                                                .waitSemaphoreValueCount = count,
                                                .pWaitSemaphoreValues = rendered,
                                                .signalSemaphoreValueCount = count,
                                                .pSignalSemaphoreValues = read};
        VkSubmitInfo                  submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                                .pNext = &values,
                                                .waitSemaphoreCount = count,
                                                .pWaitSemaphores = waits,
                                                .pWaitDstStageMask = stages,
                                                .commandBufferCount = 1,
                                                .pCommandBuffers = &commands,
                                                .signalSemaphoreCount = count,
                                                .pSignalSemaphores = signals};
        vk(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "a submission");
        value += 2;
        frame++;
        if (window)
            present(index);
    }
    bhr(bhr_semaphore_wait(shared, value, UINT64_MAX), "waiting for the last frame");

    if (out) {
        const unsigned char *pixels;
        FILE                *file = fopen(out, "wb");
        vk(vkMapMemory(device, visible, 0, VK_WHOLE_SIZE, 0, (void **)&pixels), "the pixels");
        if (!file)
            stop(out, "cannot be written");
        fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            fwrite(pixels + 4 * i, 1, 3, file);
        if (fclose(file) != 0)
            stop(out, "cannot be written");
    }
    printf("%d frames on the host's device; %s%s\n", frame, out ? "the last one is " : "shown in its window",
           out ? out : "");

    bhr_target_destroy(target);
    bhr_semaphore_destroy(shared);
    bhr_context_destroy(context); /* after it all that was bhr's to use is the host's again */
    if (window)
        end_window();
    vkDestroySemaphore(device, turn, NULL);
    vkDestroyCommandPool(device, pool, NULL);
    vkDestroyBuffer(device, buffer, NULL);
    vkDestroyImage(device, image, NULL);
    vkFreeMemory(device, visible, NULL);
    vkFreeMemory(device, memory, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    if (window) {
        glfwDestroyWindow(window);
        glfwTerminate();
    }
    return 0;
}
