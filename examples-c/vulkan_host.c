/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* vulkan_host.c -- bhr on a VkDevice of the host's: the host makes instance, device and image, bhr renders into the
 * image, and one timeline semaphore says whose turn it is. The last frame is read back and written, as there is no
 * window here. A host with a swapchain does the same with an image of its own that it then draws or copies, or with the
 * swapchain's images, wrapped with BHR_TARGET_COPY and left in VK_IMAGE_LAYOUT_PRESENT_SRC_KHR.
 *
 *     cc vulkan_host.c -lbhr -lvulkan -o vulkan_host && ./vulkan_host --frames 60 --out hole.ppm */
#include <bhr_interop.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

#define WIDTH 640
#define HEIGHT 360

static VkInstance       instance;
static VkPhysicalDevice physical;
static VkDevice         device;
static VkQueue          queue;
static VkCommandBuffer  commands;

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

/* Instance, device and queue with what bhr needs; a host adds its own. Returns what bhr is to be told of them. */
static BhrVulkanDevice make_device(void) {
    BhrVulkanRequirements needs = {.struct_size = sizeof needs};
    bhr(bhr_vulkan_requirements(NULL, NULL, NULL, &needs), "what bhr needs");
    VkApplicationInfo    app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = needs.api_version};
    VkInstanceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                   .pApplicationInfo = &app,
                                   .enabledExtensionCount = needs.instance_extension_count,
                                   .ppEnabledExtensionNames = needs.instance_extensions};
    vk(vkCreateInstance(&create, NULL, &instance), "an instance");
    uint32_t one = 1;
    if (vkEnumeratePhysicalDevices(instance, &one, &physical) < 0 || one == 0)
        stop("a GPU", "Vulkan has none");

    BhrGetInstanceProcAddr  find = (BhrGetInstanceProcAddr)vkGetInstanceProcAddr;
    BhrVulkanRequirements   of_device = {.struct_size = sizeof of_device};
    float                   priority = 1;
    VkDeviceQueueCreateInfo queues = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    bhr(bhr_vulkan_requirements(find, instance, physical, &of_device), "what bhr needs of the GPU");
    VkDeviceCreateInfo make = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .pNext = of_device.features,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queues,
                               .enabledExtensionCount = of_device.device_extension_count,
                               .ppEnabledExtensionNames = of_device.device_extensions};
    vk(vkCreateDevice(physical, &make, NULL, &device), "a device");
    vkGetDeviceQueue(device, 0, 0, &queue);
    /* A host that uses the queue on several threads gives lock and unlock here. */
    BhrVulkanDevice told = {.struct_size = sizeof told,
                            .api_version = needs.api_version,
                            .get_instance_proc_addr = find,
                            .instance = instance,
                            .physical_device = physical,
                            .device = device,
                            .instance_extensions = needs.instance_extensions,
                            .instance_extension_count = needs.instance_extension_count,
                            .device_extensions = of_device.device_extensions,
                            .device_extension_count = of_device.device_extension_count};
    return told;
}

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
    int         frames = 60;
    const char *out = "vulkan_host.ppm";
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--frames") == 0)
            frames = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--out") == 0)
            out = argv[i + 1];
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
    VkImage              image;
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
    VkSemaphoreTypeCreateInfo timeline = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                          .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    VkSemaphoreCreateInfo     create = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &timeline};
    VkSemaphore               turn;
    BhrSemaphore             *shared;
    vk(vkCreateSemaphore(device, &create, NULL, &turn), "a semaphore");
    bhr(bhr_semaphore_wrap_vulkan(context, BHR_SEMAPHORE_TIMELINE, (uint64_t)turn, &shared), "the semaphore");

    /* The host's own work with each frame: here it is copied to where the CPU can read it. */
    VkBufferCreateInfo room = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = WIDTH * HEIGHT * 4,
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkBuffer           buffer;
    vk(vkCreateBuffer(device, &room, NULL, &buffer), "a buffer");
    vkGetBufferMemoryRequirements(device, buffer, &needs);
    VkDeviceMemory visible =
        memory_of(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    vk(vkBindBufferMemory(device, buffer, visible, 0), "the buffer's memory");
    VkCommandPoolCreateInfo     pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
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
    vk(vkBeginCommandBuffer(commands, &begin), "commands");
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &whole);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, NULL,
                         0, NULL);
    vk(vkEndCommandBuffer(commands), "commands");

    uint64_t value = 0;
    for (int frame = 0; frame < frames; frame++) {
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
        uint64_t                      rendered = value + 1, read = value + 2;
        VkTimelineSemaphoreSubmitInfo values = {.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
                                                .waitSemaphoreValueCount = 1,
                                                .pWaitSemaphoreValues = &rendered,
                                                .signalSemaphoreValueCount = 1,
                                                .pSignalSemaphoreValues = &read};
        VkPipelineStageFlags          stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
        VkSubmitInfo                  submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                                .pNext = &values,
                                                .waitSemaphoreCount = 1,
                                                .pWaitSemaphores = &turn,
                                                .pWaitDstStageMask = &stage,
                                                .commandBufferCount = 1,
                                                .pCommandBuffers = &commands,
                                                .signalSemaphoreCount = 1,
                                                .pSignalSemaphores = &turn};
        vk(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "a submission");
        value += 2;
    }
    bhr(bhr_semaphore_wait(shared, value, UINT64_MAX), "waiting for the last frame");

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
    printf("%d frames on the host's device; the last one is %s\n", frames, out);

    bhr_target_destroy(target);
    bhr_semaphore_destroy(shared);
    bhr_context_destroy(context); /* after it all that was bhr's to use is the host's again */
    vkDestroySemaphore(device, turn, NULL);
    vkDestroyCommandPool(device, pool, NULL);
    vkDestroyBuffer(device, buffer, NULL);
    vkDestroyImage(device, image, NULL);
    vkFreeMemory(device, visible, NULL);
    vkFreeMemory(device, memory, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    return 0;
}
