/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* vk.h -- a Vulkan device of the host's for the tests of bhr_interop.h: opened, with what bhr asks for or as any host
 * would, under the validation layers on request; imports memory, and reads buffers and images back. Knows of bhr only
 * what is in its structs; tests nothing by itself. A failure of Vulkan's own ends the program with a message. */
#ifndef BHR_TESTS_VK_H
#define BHR_TESTS_VK_H

#include <bhr_interop.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

typedef struct Vk {
    VkInstance               instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice         physical;
    VkDevice                 device;
    VkQueue                  queue;
    VkCommandPool            pool;
    VkCommandBuffer          commands;
    uint32_t                 api_version;
    uint8_t                  uuid[16];
    const char              *instance_extensions[8];
    const char              *device_extensions[64];
    uint32_t                 instance_extension_count, device_extension_count;
    int                      has_semaphore_fd;
    PFN_vkGetMemoryFdKHR     get_memory_fd;
    PFN_vkImportSemaphoreFdKHR import_semaphore_fd;
    PFN_vkGetSemaphoreFdKHR get_semaphore_fd;
} Vk;

#define VK(call) vk_check((call), #call, __FILE__, __LINE__)
void vk_check(VkResult result, const char *call, const char *file, int line);

/* Messages of the validation layers so far: about any Vk, and about contexts that log with vk_log. */
extern int vk_complaints;
/* For BhrContextOptions.log_fn, with BHR_CONTEXT_VALIDATION. */
void vk_log(void *user, BhrLogLevel level, const char *message);

/* An instance, with the layers if `validate`, and the first physical device, or that of `uuid`, unless NULL. */
void vk_open_instance(Vk *vk, const uint8_t *uuid, uint32_t api_version, int validate);
/* The device as a host that shares memory makes it. */
void vk_open_device(Vk *vk);
/* The device as bhr_vulkan_requirements says. */
void vk_open_required(Vk *vk, const BhrVulkanRequirements *required);
void vk_close(Vk *vk);

/* The device as bhr_context_create_vulkan is told of it. */
BhrVulkanDevice vk_for_bhr(const Vk *vk);

uint32_t vk_memory_type(const Vk *vk, uint32_t bits, VkMemoryPropertyFlags flags);

/* A picture in the host's hands: a buffer or an image, its memory, and what bhr is told about it. */
typedef struct VkPicture {
    VkBuffer       buffer;
    VkImage        image;
    VkDeviceMemory memory;
    BhrTargetInfo  info;
} VkPicture;

/* Imports the memory of a target of bhr's; takes the descriptor over. `bytes` of a buffer. */
VkPicture vk_import(Vk *vk, const BhrTargetInfo *info, int fd, uint64_t bytes);
/* Memory of the host's, exported into *fd unless that is NULL. */
VkPicture vk_make_buffer(Vk *vk, uint64_t bytes, int *fd);
VkPicture vk_make_image(Vk *vk, VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage, int *fd);
void      vk_drop(Vk *vk, VkPicture *picture);

/* Semaphores that a read waits for and signals; VK_NULL_HANDLE: none. */
typedef struct VkTurn {
    VkSemaphore wait, signal;
    uint64_t    wait_value, signal_value;
    void (*lock)(void *), (*unlock)(void *);
} VkTurn;

/* Copies a picture to `pixels`: `bytes` of a buffer, or rows without gaps of an image of `pixel_bytes`. Acquired from
 * the queue family `from` (VK_QUEUE_FAMILY_IGNORED: the same device), in the layout of picture->info. */
void vk_read(Vk *vk, const VkPicture *picture, uint32_t from, uint32_t pixel_bytes, uint64_t bytes, const VkTurn *turn,
             void *pixels);

/* Copies rows, `stride` bytes apart, into a picture: `bytes` of them all. The picture is released to the queue family
 * `to`, an image in the layout of picture->info. */
void vk_write(Vk *vk, const VkPicture *picture, uint32_t to, uint32_t pixel_bytes, uint64_t stride, uint64_t bytes,
              const void *rows);

/* A semaphore of the host's, exported into *fd unless that is NULL. */
VkSemaphore vk_semaphore(Vk *vk, VkSemaphoreType kind, int *fd);
VkSemaphore vk_timeline(Vk *vk);
/* One of bhr's; takes the descriptor over. Only where the Vk has_semaphore_fd. */
VkSemaphore vk_import_semaphore(Vk *vk, VkSemaphoreType kind, int fd);
/* How far pixels of one of BHR_FORMAT_* are apart: so many codes of 8 bits, units in the last place of half floats, or
 * millionths of floats (of 0.001, where they are smaller). */
double vk_apart(BhrFormat format, const void *some, const void *others, size_t bytes);
/* How far pixels of targets may be from those of bhr_render_image, by vk_apart: not at all in buffers, in images of
 * BGRA8, and on software drivers. Hardware drivers compile the kernels that write other images apart from those that
 * write to memory, and round differently. */
double vk_most_apart(const BhrContext *context, BhrTargetKind kind, BhrFormat format);
/* Open descriptors of the process. */
int open_descriptors(void);

#endif
