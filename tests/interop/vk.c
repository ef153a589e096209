/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* vk.c -- see vk.h. */
#include "vk.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int vk_complaints;

void vk_check(VkResult result, const char *call, const char *file, int line) {
    if (result == VK_SUCCESS)
        return;
    fprintf(stderr, "%s:%d: %s returned %d\n", file, line, call, (int)result);
    exit(3);
}

static VKAPI_ATTR VkBool32 VKAPI_CALL complain(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                               VkDebugUtilsMessageTypeFlagsEXT types,
                                               const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)severity, (void)types, (void)user;
    vk_complaints++;
    fprintf(stderr, "VALIDATION %s: %s\n", data->pMessageIdName ? data->pMessageIdName : "", data->pMessage);
    return VK_FALSE;
}

void vk_log(void *user, BhrLogLevel level, const char *message) {
    (void)user, (void)level;
    if (!strstr(message, "VALIDATION") && !strstr(message, "Validation"))
        return;
    vk_complaints++;
    fprintf(stderr, "bhr's device: %s\n", message);
}

void vk_open_instance(Vk *vk, const uint8_t *uuid, uint32_t api_version, int validate) {
    memset(vk, 0, sizeof *vk);
    vk->api_version = api_version;
    const char *layer = "VK_LAYER_KHRONOS_validation";
    vk->instance_extensions[vk->instance_extension_count++] = "VK_KHR_get_physical_device_properties2";
    vk->instance_extensions[vk->instance_extension_count++] = "VK_KHR_surface";
    if (validate)
        vk->instance_extensions[vk->instance_extension_count++] = "VK_EXT_debug_utils";
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = complain};
    VkApplicationInfo    app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = api_version};
    VkInstanceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                   .pNext = validate ? &messenger : NULL,
                                   .pApplicationInfo = &app,
                                   .enabledLayerCount = validate ? 1 : 0,
                                   .ppEnabledLayerNames = &layer,
                                   .enabledExtensionCount = vk->instance_extension_count,
                                   .ppEnabledExtensionNames = vk->instance_extensions};
    VK(vkCreateInstance(&create, NULL, &vk->instance));
    if (validate) {
        PFN_vkCreateDebugUtilsMessengerEXT make =
            (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(vk->instance, "vkCreateDebugUtilsMessengerEXT");
        VK(make(vk->instance, &messenger, NULL, &vk->messenger));
    }
    VkPhysicalDevice all[16];
    uint32_t         count = 16;
    vkEnumeratePhysicalDevices(vk->instance, &count, all);
    for (uint32_t i = 0; i < count && !vk->physical; i++) {
        VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
        VkPhysicalDeviceProperties2  both = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &id};
        if (api_version >= VK_API_VERSION_1_1)
            vkGetPhysicalDeviceProperties2(all[i], &both);
        if (uuid && memcmp(uuid, id.deviceUUID, 16) != 0)
            continue;
        vk->physical = all[i];
        memcpy(vk->uuid, id.deviceUUID, 16);
    }
    if (!vk->physical) {
        fprintf(stderr, "no physical device with bhr's UUID\n");
        exit(3);
    }
}

static void make_device(Vk *vk, const void *features) {
    float                   priority = 1;
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                 .pNext = features,
                                 .queueCreateInfoCount = 1,
                                 .pQueueCreateInfos = &queue,
                                 .enabledExtensionCount = vk->device_extension_count,
                                 .ppEnabledExtensionNames = vk->device_extensions};
    VK(vkCreateDevice(vk->physical, &create, NULL, &vk->device));
    vkGetDeviceQueue(vk->device, 0, 0, &vk->queue);
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                    .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    VK(vkCreateCommandPool(vk->device, &pool, NULL, &vk->pool));
    VkCommandBufferAllocateInfo one = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = vk->pool, .commandBufferCount = 1};
    VK(vkAllocateCommandBuffers(vk->device, &one, &vk->commands));
    vk->get_memory_fd = (PFN_vkGetMemoryFdKHR)vkGetDeviceProcAddr(vk->device, "vkGetMemoryFdKHR");
    vk->import_semaphore_fd =
        (PFN_vkImportSemaphoreFdKHR)vkGetDeviceProcAddr(vk->device, "vkImportSemaphoreFdKHR");
    vk->get_semaphore_fd = (PFN_vkGetSemaphoreFdKHR)vkGetDeviceProcAddr(vk->device, "vkGetSemaphoreFdKHR");
}

static int has_extension(const Vk *vk, const char *name) {
    static VkExtensionProperties known[512];
    uint32_t                     count = 512;
    vkEnumerateDeviceExtensionProperties(vk->physical, NULL, &count, known);
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(known[i].extensionName, name) == 0)
            return 1;
    return 0;
}

void vk_open_device(Vk *vk) {
    vk->device_extensions[vk->device_extension_count++] = "VK_KHR_external_memory_fd";
    vk->has_semaphore_fd = has_extension(vk, "VK_KHR_external_semaphore_fd");
    if (vk->has_semaphore_fd)
        vk->device_extensions[vk->device_extension_count++] = "VK_KHR_external_semaphore_fd";
    VkPhysicalDeviceTimelineSemaphoreFeatures timeline = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES, .timelineSemaphore = VK_TRUE};
    make_device(vk, &timeline);
}

void vk_open_required(Vk *vk, const BhrVulkanRequirements *required) {
    for (uint32_t i = 0; i < required->device_extension_count && i < 64; i++)
        vk->device_extensions[vk->device_extension_count++] = required->device_extensions[i];
    make_device(vk, required->features);
}

void vk_close(Vk *vk) {
    if (vk->device) {
        vkDestroyCommandPool(vk->device, vk->pool, NULL);
        vkDestroyDevice(vk->device, NULL);
    }
    if (vk->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT end = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            vk->instance, "vkDestroyDebugUtilsMessengerEXT");
        end(vk->instance, vk->messenger, NULL);
    }
    vkDestroyInstance(vk->instance, NULL);
}

BhrVulkanDevice vk_for_bhr(const Vk *vk) {
    BhrVulkanDevice device;
    memset(&device, 0, sizeof device);
    device.struct_size = sizeof device;
    device.api_version = vk->api_version;
    device.get_instance_proc_addr = (BhrGetInstanceProcAddr)vkGetInstanceProcAddr;
    device.instance = vk->instance;
    device.physical_device = vk->physical;
    device.device = vk->device;
    device.instance_extensions = vk->instance_extensions;
    device.instance_extension_count = vk->instance_extension_count;
    device.device_extensions = vk->device_extensions;
    device.device_extension_count = vk->device_extension_count;
    return device;
}

uint32_t vk_memory_type(const Vk *vk, uint32_t bits, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties all;
    vkGetPhysicalDeviceMemoryProperties(vk->physical, &all);
    for (uint32_t i = 0; i < all.memoryTypeCount; i++)
        if ((bits >> i & 1) && (all.memoryTypes[i].propertyFlags & flags) == flags)
            return i;
    fprintf(stderr, "no memory type of %#x has %#x\n", bits, flags);
    exit(3);
}

static VkBuffer new_buffer(Vk *vk, uint64_t bytes, int shared, VkMemoryRequirements *needs) {
    VkExternalMemoryBufferCreateInfo outside = {.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO,
                                                .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
    VkBufferCreateInfo create = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                 .pNext = shared ? &outside : NULL,
                                 .size = bytes,
                                 .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkBuffer buffer;
    VK(vkCreateBuffer(vk->device, &create, NULL, &buffer));
    vkGetBufferMemoryRequirements(vk->device, buffer, needs);
    return buffer;
}

static VkImage new_image(Vk *vk, const BhrTargetInfo *info, int shared, VkMemoryRequirements *needs) {
    VkExternalMemoryImageCreateInfo outside = {.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO,
                                               .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
    VkImageCreateInfo create = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                .pNext = shared ? &outside : NULL,
                                .flags = info->vk_flags,
                                .imageType = VK_IMAGE_TYPE_2D,
                                .format = (VkFormat)info->vk_format,
                                .extent = {info->width, info->height, 1},
                                .mipLevels = 1,
                                .arrayLayers = 1,
                                .samples = VK_SAMPLE_COUNT_1_BIT,
                                .tiling = (VkImageTiling)info->vk_tiling,
                                .usage = info->vk_usage};
    VkImage image;
    VK(vkCreateImage(vk->device, &create, NULL, &image));
    vkGetImageMemoryRequirements(vk->device, image, needs);
    return image;
}

static void bind(Vk *vk, VkPicture *picture, uint64_t offset) {
    if (picture->image)
        VK(vkBindImageMemory(vk->device, picture->image, picture->memory, offset));
    else
        VK(vkBindBufferMemory(vk->device, picture->buffer, picture->memory, offset));
}

VkPicture vk_import(Vk *vk, const BhrTargetInfo *info, int fd, uint64_t bytes) {
    VkPicture            picture = {.info = *info};
    VkMemoryRequirements needs;
    if (info->kind == BHR_TARGET_IMAGE)
        picture.image = new_image(vk, info, 1, &needs);
    else
        picture.buffer = new_buffer(vk, bytes, 1, &needs);
    VkMemoryDedicatedAllocateInfo dedicated = {.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO,
                                               .image = picture.image,
                                               .buffer = picture.buffer};
    VkImportMemoryFdInfoKHR       import = {.sType = VK_STRUCTURE_TYPE_IMPORT_MEMORY_FD_INFO_KHR,
                                            .pNext = info->dedicated ? &dedicated : NULL,
                                            .handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT,
                                            .fd = fd};
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .pNext = &import,
                                     .allocationSize = info->allocation_size,
                                     .memoryTypeIndex = info->memory_type};
    VK(vkAllocateMemory(vk->device, &allocate, NULL, &picture.memory));
    bind(vk, &picture, info->offset);
    return picture;
}

static void own_memory(Vk *vk, VkPicture *picture, const VkMemoryRequirements *needs, int *fd) {
    VkExportMemoryAllocateInfo export = {.sType = VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO,
                                         .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
    VkMemoryAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .pNext = fd ? &export : NULL,
        .allocationSize = needs->size,
        .memoryTypeIndex = vk_memory_type(vk, needs->memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    VK(vkAllocateMemory(vk->device, &allocate, NULL, &picture->memory));
    bind(vk, picture, 0);
    picture->info.struct_size = sizeof picture->info;
    picture->info.allocation_size = needs->size;
    picture->info.memory_type = allocate.memoryTypeIndex;
    if (fd) {
        VkMemoryGetFdInfoKHR get = {.sType = VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR,
                                    .memory = picture->memory,
                                    .handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
        VK(vk->get_memory_fd(vk->device, &get, fd));
    }
}

VkPicture vk_make_buffer(Vk *vk, uint64_t bytes, int *fd) {
    VkPicture            picture = {.info = {.kind = BHR_TARGET_BUFFER}};
    VkMemoryRequirements needs;
    picture.buffer = new_buffer(vk, bytes, fd != NULL, &needs);
    own_memory(vk, &picture, &needs, fd);
    return picture;
}

VkPicture vk_make_image(Vk *vk, VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage, int *fd) {
    VkPicture picture = {.info = {.kind = BHR_TARGET_IMAGE,
                                  .width = width,
                                  .height = height,
                                  .vk_format = (uint32_t)format,
                                  .vk_usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                  .layout = VK_IMAGE_LAYOUT_GENERAL}};
    VkMemoryRequirements needs;
    picture.image = new_image(vk, &picture.info, fd != NULL, &needs);
    own_memory(vk, &picture, &needs, fd);
    return picture;
}

void vk_drop(Vk *vk, VkPicture *picture) {
    vkDestroyBuffer(vk->device, picture->buffer, NULL);
    vkDestroyImage(vk->device, picture->image, NULL);
    vkFreeMemory(vk->device, picture->memory, NULL);
    memset(picture, 0, sizeof *picture);
}

static void acquire(Vk *vk, const VkPicture *picture, uint32_t from) {
    uint32_t              to = from == VK_QUEUE_FAMILY_IGNORED ? VK_QUEUE_FAMILY_IGNORED : 0;
    VkBufferMemoryBarrier buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
                                    .srcQueueFamilyIndex = from,
                                    .dstQueueFamilyIndex = to,
                                    .buffer = picture->buffer,
                                    .size = VK_WHOLE_SIZE};
    VkImageMemoryBarrier  image = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                   .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
                                   .oldLayout = (VkImageLayout)picture->info.layout,
                                   .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   .srcQueueFamilyIndex = from,
                                   .dstQueueFamilyIndex = to,
                                   .image = picture->image,
                                   .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    int is_image = picture->image != VK_NULL_HANDLE;
    vkCmdPipelineBarrier(vk->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL,
                         !is_image, &buffer, is_image, &image);
}

/* Ends the commands, submits them and waits. */
static void submit_and_wait(Vk *vk, const VkTurn *turn) {
    VK(vkEndCommandBuffer(vk->commands));
    static const VkTurn  none;
    VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    turn = turn ? turn : &none;
    VkTimelineSemaphoreSubmitInfo values = {.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
                                            .waitSemaphoreValueCount = 1,
                                            .pWaitSemaphoreValues = &turn->wait_value,
                                            .signalSemaphoreValueCount = 1,
                                            .pSignalSemaphoreValues = &turn->signal_value};
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                           .pNext = turn->wait || turn->signal ? &values : NULL,
                           .waitSemaphoreCount = turn->wait != VK_NULL_HANDLE,
                           .pWaitSemaphores = &turn->wait,
                           .pWaitDstStageMask = &stage,
                           .commandBufferCount = 1,
                           .pCommandBuffers = &vk->commands,
                           .signalSemaphoreCount = turn->signal != VK_NULL_HANDLE,
                           .pSignalSemaphores = &turn->signal};
    VkFenceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkFence           fence;
    VK(vkCreateFence(vk->device, &create, NULL, &fence));
    if (turn->lock)
        turn->lock(NULL);
    VK(vkQueueSubmit(vk->queue, 1, &submit, fence));
    if (turn->unlock)
        turn->unlock(NULL);
    VK(vkWaitForFences(vk->device, 1, &fence, VK_TRUE, 120000000000u));
    vkDestroyFence(vk->device, fence, NULL);
}

/* A buffer that the host's memory is copied to and from. */
static VkPicture host_visible(Vk *vk, uint64_t bytes) {
    VkMemoryRequirements needs;
    VkPicture            staging = {.buffer = new_buffer(vk, bytes, 0, &needs)};
    VkMemoryAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = vk_memory_type(vk, needs.memoryTypeBits,
                                          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)};
    VK(vkAllocateMemory(vk->device, &allocate, NULL, &staging.memory));
    bind(vk, &staging, 0);
    return staging;
}

void vk_read(Vk *vk, const VkPicture *picture, uint32_t from, uint32_t pixel_bytes, uint64_t bytes, const VkTurn *turn,
             void *pixels) {
    if (picture->image)
        bytes = (uint64_t)picture->info.width * picture->info.height * pixel_bytes;
    VkPicture staging = host_visible(vk, bytes);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VK(vkResetCommandBuffer(vk->commands, 0));
    VK(vkBeginCommandBuffer(vk->commands, &begin));
    acquire(vk, picture, from);
    if (picture->image) {
        VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                  .imageExtent = {picture->info.width, picture->info.height, 1}};
        vkCmdCopyImageToBuffer(vk->commands, picture->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.buffer, 1,
                               &copy);
    } else {
        VkBufferCopy copy = {.size = bytes};
        vkCmdCopyBuffer(vk->commands, picture->buffer, staging.buffer, 1, &copy);
    }
    VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                               .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                               .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(vk->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0,
                         NULL, 0, NULL);
    submit_and_wait(vk, turn);
    void *mapped;
    VK(vkMapMemory(vk->device, staging.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    memcpy(pixels, mapped, (size_t)bytes);
    vkUnmapMemory(vk->device, staging.memory);
    vk_drop(vk, &staging);
}

void vk_write(Vk *vk, const VkPicture *picture, uint32_t to, uint32_t pixel_bytes, uint64_t stride, uint64_t bytes,
              const void *rows) {
    VkPicture staging = host_visible(vk, bytes);
    void     *mapped;
    VK(vkMapMemory(vk->device, staging.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    memcpy(mapped, rows, (size_t)bytes);
    vkUnmapMemory(vk->device, staging.memory);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VK(vkResetCommandBuffer(vk->commands, 0));
    VK(vkBeginCommandBuffer(vk->commands, &begin));
    uint32_t own = to == VK_QUEUE_FAMILY_IGNORED ? VK_QUEUE_FAMILY_IGNORED : 0;
    if (picture->image) {
        VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                        .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = picture->image,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
        VkBufferImageCopy    copy = {.bufferRowLength = (uint32_t)(stride / pixel_bytes),
                                     .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                     .imageExtent = {picture->info.width, picture->info.height, 1}};
        vkCmdPipelineBarrier(vk->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                             NULL, 0, NULL, 1, &barrier);
        vkCmdCopyBufferToImage(vk->commands, staging.buffer, picture->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                               &copy);
        barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.dstAccessMask = 0;
        barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.newLayout = (VkImageLayout)picture->info.layout;
        barrier.srcQueueFamilyIndex = own;
        barrier.dstQueueFamilyIndex = to;
        vkCmdPipelineBarrier(vk->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                             NULL, 0, NULL, 1, &barrier);
    } else {
        VkBufferCopy          copy = {.size = bytes};
        VkBufferMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER,
                                         .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                         .srcQueueFamilyIndex = own,
                                         .dstQueueFamilyIndex = to,
                                         .buffer = picture->buffer,
                                         .size = VK_WHOLE_SIZE};
        vkCmdCopyBuffer(vk->commands, staging.buffer, picture->buffer, 1, &copy);
        vkCmdPipelineBarrier(vk->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                             NULL, 1, &barrier, 0, NULL);
    }
    submit_and_wait(vk, NULL);
    vk_drop(vk, &staging);
}

VkSemaphore vk_semaphore(Vk *vk, VkSemaphoreType kind, int *fd) {
    VkExportSemaphoreCreateInfo outside = {.sType = VK_STRUCTURE_TYPE_EXPORT_SEMAPHORE_CREATE_INFO,
                                           .handleTypes = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT};
    VkSemaphoreTypeCreateInfo   type = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                        .pNext = fd ? &outside : NULL,
                                        .semaphoreType = kind};
    VkSemaphoreCreateInfo       create = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore                 made;
    VK(vkCreateSemaphore(vk->device, &create, NULL, &made));
    if (fd) {
        VkSemaphoreGetFdInfoKHR get = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_GET_FD_INFO_KHR,
                                       .semaphore = made,
                                       .handleType = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT};
        VK(vk->get_semaphore_fd(vk->device, &get, fd));
    }
    return made;
}

VkSemaphore vk_timeline(Vk *vk) { return vk_semaphore(vk, VK_SEMAPHORE_TYPE_TIMELINE, NULL); }

VkSemaphore vk_import_semaphore(Vk *vk, VkSemaphoreType kind, int fd) {
    VkSemaphore                made = vk_semaphore(vk, kind, NULL);
    VkImportSemaphoreFdInfoKHR import = {.sType = VK_STRUCTURE_TYPE_IMPORT_SEMAPHORE_FD_INFO_KHR,
                                         .semaphore = made,
                                         .handleType = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT,
                                         .fd = fd};
    VK(vk->import_semaphore_fd(vk->device, &import));
    return made;
}

int open_descriptors(void) {
    DIR *folder = opendir("/proc/self/fd");
    int  count = -1; /* opendir's own */
    if (!folder)
        return -1;
    for (struct dirent *entry; (entry = readdir(folder));)
        count += entry->d_name[0] != '.';
    closedir(folder);
    return count;
}

double vk_apart(BhrFormat format, const void *some, const void *others, size_t bytes) {
    const unsigned char *a = some, *b = others;
    double               most = 0;
    if (format == BHR_FORMAT_RGBA8_SRGB || format == BHR_FORMAT_BGRA8_SRGB) {
        for (size_t i = 0; i < bytes; i++)
            most = fmax(most, abs(a[i] - b[i]));
        return most;
    }
    size_t each = format == BHR_FORMAT_RGBA16F ? 2 : 4;
    for (size_t i = 0; i + each <= bytes; i += each) {
        uint16_t half[2];
        float    x[2];
        if (memcmp(a + i, b + i, each) == 0)
            continue;
        if (each == 2) {
            memcpy(&half[0], a + i, 2), memcpy(&half[1], b + i, 2);
            /* Half floats of one sign are in the order of their bits. */
            most = fmax(most, (half[0] ^ half[1]) >> 15 ? INFINITY : abs(half[0] - half[1]));
        } else {
            memcpy(&x[0], a + i, 4), memcpy(&x[1], b + i, 4);
            double off = 1e6 * fabs((double)x[0] - x[1]) / fmax(fmax(fabs(x[0]), fabs(x[1])), 1e-3);
            most = isnan(off) ? INFINITY : fmax(most, off);
        }
    }
    return most;
}

double vk_most_apart(const BhrContext *context, BhrTargetKind kind, BhrFormat format) {
    BhrAdapterInfo adapter = {.struct_size = sizeof adapter};
    if (bhr_context_adapter(context, &adapter) != BHR_OK || adapter.flags & BHR_ADAPTER_SOFTWARE ||
        kind == BHR_TARGET_BUFFER || format == BHR_FORMAT_BGRA8_SRGB)
        return 0;
    return format == BHR_FORMAT_RGBA16F ? 4 : format == BHR_FORMAT_RGBA32F || format == BHR_FORMAT_R32F ? 3000 : 1;
}
