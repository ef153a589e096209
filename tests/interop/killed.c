/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* killed.c -- two processes share a target and one of them is killed in the middle of its work. Where the importer
 * dies, the exporter's context goes on: right pixels, no descriptor and no memory more, and a frame that waits for the
 * dead one is freed by a signal of the host's. Where the exporter dies, the importer reads what was there last, and a
 * context of bhr's that imported the memory renders into it; nobody hangs. The other process is this program again.
 * Arguments: vulkan [importer | exporter]. */
#include "share.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define WIDTH 160u
#define HEIGHT 90u
#define BYTES (WIDTH * HEIGHT * 8u)

/* The other process's end of the socket. */
#define SOCKET 20

static unsigned char expected[BYTES], seen[BYTES], again[BYTES];

/* A target as one process tells the other of it. The descriptors go along: the memory's, and the timeline's if any. */
typedef struct Passed {
    BhrTargetInfo info;
    uint8_t       uuid[16];
    int32_t       has_timeline;
} Passed;

static void give(int socket, const Passed *passed, const int *fds) {
    union {
        char           bytes[CMSG_SPACE(2 * sizeof(int))];
        struct cmsghdr aligned;
    } control;
    size_t        size = (passed->has_timeline ? 2 : 1) * sizeof(int);
    struct iovec  data = {(void *)passed, sizeof *passed};
    struct msghdr message = {.msg_iov = &data, .msg_iovlen = 1, .msg_control = control.bytes};
    memset(&control, 0, sizeof control);
    message.msg_controllen = CMSG_SPACE(size);
    struct cmsghdr *head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET, head->cmsg_type = SCM_RIGHTS, head->cmsg_len = CMSG_LEN(size);
    memcpy(CMSG_DATA(head), fds, size);
    if (sendmsg(socket, &message, 0) != (ssize_t)sizeof *passed)
        perror("sendmsg"), exit(3);
}

static Passed take(int socket, int fds[2]) {
    union {
        char           bytes[CMSG_SPACE(2 * sizeof(int))];
        struct cmsghdr aligned;
    } control;
    Passed        passed;
    struct iovec  data = {&passed, sizeof passed};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1, .msg_control = control.bytes, .msg_controllen = sizeof control.bytes};
    if (recvmsg(socket, &message, 0) != (ssize_t)sizeof passed || !CMSG_FIRSTHDR(&message))
        perror("recvmsg"), exit(3);
    memcpy(fds, CMSG_DATA(CMSG_FIRSTHDR(&message)), (passed.has_timeline ? 2 : 1) * sizeof(int));
    return passed;
}

/* One byte: something has been done. 0: the other process has ended. */
static int told(int socket) {
    char byte;
    return read(socket, &byte, 1) == 1;
}

static pid_t other_process(const char *role, int *socket) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        perror("socketpair"), exit(3);
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], SOCKET);
        execl("/proc/self/exe", "killed", "vulkan", role, (char *)NULL);
        _exit(127);
    }
    if (child < 0)
        perror("fork"), exit(3);
    close(ends[1]);
    *socket = ends[0];
    return child;
}

static void kill_it(pid_t child, const char *role) {
    int status = 0;
    CHECK(kill(child, SIGKILL) == 0, "%s: kill: %s", role, strerror(errno));
    CHECK(waitpid(child, &status, 0) == child, "%s: waitpid: %s", role, strerror(errno));
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL, "the %s had ended by itself, status %#x", role, status);
}

/* The other process as importer: reads the target again and again, until it is killed. */
static int importer(void) {
    Vk     vk;
    int    fds[2];
    Passed passed = take(SOCKET, fds);
    memset(&vk, 0, sizeof vk);
    vk_open_instance(&vk, passed.uuid, VK_API_VERSION_1_3, 0);
    vk_open_device(&vk);
    VkPicture picture = vk_import(&vk, &passed.info, fds[0], BYTES);
    if (passed.has_timeline)
        vk_import_semaphore(&vk, VK_SEMAPHORE_TYPE_TIMELINE, fds[1]);
    for (;;) {
        vk_read(&vk, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
        if (write(SOCKET, "r", 1) != 1)
            return 1;
    }
}

/* A target and a timeline, exported as far as the device does. */
typedef struct Shared {
    BhrTarget    *target;
    BhrSemaphore *timeline;
    Passed        passed;
    int           fds[2];
} Shared;

static Shared share(BhrTargetKind kind) {
    Shared           shared = {.passed = {.info = {.struct_size = sizeof(BhrTargetInfo)}}, .fds = {-1, -1}};
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, kind, WIDTH, HEIGHT, 0);
    BhrHandle        handle;
    memcpy(shared.passed.uuid, can.device_uuid, sizeof can.device_uuid);
    shared.target = share_make(&options);
    CHECK_OK(bhr_target_info(shared.target, &shared.passed.info));
    CHECK_OK(bhr_target_export(shared.target, &handle));
    shared.fds[0] = handle.fd;
    shared.timeline = share_timeline(&shared.fds[1]);
    shared.passed.has_timeline = shared.fds[1] >= 0;
    return shared;
}

/* Gives the descriptors away: the other process has its own. */
static void pass(int socket, Shared *shared) {
    give(socket, &shared->passed, shared->fds);
    for (int i = 0; i < 2; i++)
        if (shared->fds[i] >= 0)
            close(shared->fds[i]);
}

/* The other process as exporter: renders again and again, until it is killed. */
static int exporter(void) {
    Shared shared = share(BHR_TARGET_BUFFER);
    pass(SOCKET, &shared);
    for (int frame = 0;; frame++) {
        BhrJob *job;
        if (bhr_set_time(context, 5.0 * frame) < 0 || bhr_render_target(context, shared.target, NULL, &job) < 0 ||
            bhr_job_wait(job, UINT64_MAX, NULL) < 0)
            return 1;
        bhr_job_destroy(job);
        if (write(SOCKET, "f", 1) != 1)
            return 1;
    }
}

static uint64_t expect(void) {
    BhrFrameStats stats = {.struct_size = sizeof stats};
    BhrImage      image = image_of(BHR_FORMAT_RGBA16F, WIDTH, HEIGHT, expected, sizeof expected);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_frame_stats(context, &stats));
    return stats.device_bytes;
}

static void compare(BhrTargetKind kind, const char *what) {
    double apart = memcmp(seen, expected, BYTES) ? vk_apart(BHR_FORMAT_RGBA16F, seen, expected, BYTES) : 0;
    CHECK(apart <= vk_most_apart(context, kind, BHR_FORMAT_RGBA16F), "%s: pixels differ by up to %g", what, apart);
}

static void render(BhrTarget *target) {
    BhrJob *job;
    if (CHECK_OK(bhr_render_target(context, target, NULL, &job)))
        share_finish(job);
}

/* A frame waits for a signal that the dead process does not give; the host gives it. */
static void free_the_frame(Shared *shared) {
    BhrSemaphoreValue wait = {shared->timeline, 2}, signal = {shared->timeline, 3};
    BhrSync           sync = {
        .struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait, .signals = &signal};
    BhrJob *job;
    if (!CHECK_OK(bhr_render_target(context, shared->target, &sync, &job)))
        return;
    CHECK(bhr_job_wait(job, 50000000, NULL) == BHR_NOT_READY, "the frame did not wait");
    CHECK_OK(bhr_semaphore_signal(shared->timeline, 2));
    CHECK_OK(bhr_semaphore_wait(shared->timeline, 3, UINT64_MAX));
    share_finish(job);
}

/* The importer is killed while bhr renders, some ms later each time. */
static uint64_t importer_dies(BhrTargetKind kind, int round) {
    Shared    shared = share(kind);
    int       socket;
    pid_t     child = other_process("importer", &socket);
    pass(socket, &shared);
    VkPicture picture = share_import(shared.target, BYTES);
    render(shared.target);
    CHECK(told(socket), "the importer ended");
    for (int frame = 0; frame < 3; frame++) {
        CHECK_OK(bhr_set_time(context, 7.0 * frame));
        CHECK_OK(bhr_render_target(context, shared.target, NULL, NULL));
    }
    pause_ms(3 * round);
    kill_it(child, "importer");
    for (int frame = 0; frame < 5; frame++) {
        CHECK_OK(bhr_set_time(context, 11.0 * frame));
        render(shared.target);
        expect();
        vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
        compare(kind, "after the importer's death");
    }
    free_the_frame(&shared);
    vk_drop(&host, &picture);
    close(socket);
    bhr_semaphore_destroy(shared.timeline);
    bhr_target_destroy(shared.target);
    return expect();
}

/* The exporter is killed while it renders. */
static void exporter_dies(int round) {
    int              socket, fds[2], frames = 0;
    pid_t            child = other_process("exporter", &socket);
    Passed           passed = take(socket, fds);
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_BUFFER, WIDTH, HEIGHT, 0);
    BhrHandle        handle = {BHR_HANDLE_OPAQUE_FD, dup(fds[0]), NULL};
    BhrTarget       *target = NULL;
    VkPicture        picture = vk_import(&host, &passed.info, fds[0], BYTES);
    CHECK_OK(bhr_target_import(context, &options, &passed.info, &handle, &target));
    while (frames < 3 && told(socket))
        frames++;
    CHECK(frames == 3, "the exporter ended after %d frames", frames);
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
    pause_ms(2 * round);
    kill_it(child, "exporter");
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, again);
    uint32_t lit = 0;
    for (uint32_t i = 0; i < BYTES; i++)
        lit += seen[i] != 0;
    CHECK(memcmp(seen, again, BYTES) == 0, "the pixels of a dead exporter change");
    CHECK(lit > BYTES / 8, "%u bytes of %u are left of the last frame", lit, BYTES);
    if (passed.has_timeline) {
        VkSemaphore         timeline = vk_import_semaphore(&host, VK_SEMAPHORE_TYPE_TIMELINE, fds[1]);
        uint64_t            never = 1;
        VkSemaphoreWaitInfo wait = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                    .semaphoreCount = 1,
                                    .pSemaphores = &timeline,
                                    .pValues = &never};
        CHECK(vkWaitSemaphores(host.device, &wait, 100000000) != VK_SUCCESS, "a signal that nobody gave");
        vkDestroySemaphore(host.device, timeline, NULL);
    }
    /* The memory is everybody's who has it. */
    CHECK_OK(bhr_set_time(context, 40.0 + round));
    render(target);
    expect();
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
    compare(BHR_TARGET_BUFFER, "in a dead process's memory");
    bhr_target_destroy(target);
    vk_drop(&host, &picture);
    close(socket);
}

int main(int argc, char **argv) {
    if (argc > 2 && strcmp(argv[2], "importer") == 0)
        return importer();
    share_begin(argc, argv);
    if (argc > 2)
        return exporter();
    /* Whoever writes to a process that has ended hears of it from write. */
    signal(SIGPIPE, SIG_IGN);
    int      descriptors = 0;
    uint64_t bytes = 0;
    /* The first two are a warm-up. */
    const int rounds = check_runs_all() ? 6 : 3;
    for (int round = 0; round < rounds; round++) {
        uint64_t now = importer_dies(round % 2 ? BHR_TARGET_BUFFER : BHR_TARGET_IMAGE, round);
        exporter_dies(round);
        if (round == 1)
            descriptors = open_descriptors(), bytes = now;
        CHECK(round < 2 || open_descriptors() <= descriptors, "round %d: %d descriptors, before %d", round,
              open_descriptors(), descriptors);
        /* Frames on their way have a few numbers each. */
        CHECK(round < 2 || now < bytes + 4096, "round %d: %llu bytes of the device, before %llu", round,
              (unsigned long long)now, (unsigned long long)bytes);
    }
    return share_end();
}
