/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* tiles.c -- one large frame by many processes: each renders the next tile of a queue that all share, and puts it into
 * the frame of the first process, which saves it. Needs bhr and MPI 3. docs/farms.md.
 *
 *     mpicc tiles.c -o tiles -lbhr
 *     mpirun -n 8 ./tiles scene.toml 16384 8192 frame.png [TILE] [SECONDS] [BACKEND]
 *
 * TILE: the side of tiles, default 1024. BACKEND: a number of BHR_BACKEND_*, default 0. Frames of several GPUs of one
 * host: start a process a GPU with its own CUDA_VISIBLE_DEVICES, or its own adapter. */
#include <bhr.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

static void need(BhrStatus status) {
    if (status < 0) {
        fprintf(stderr, "tiles: %s\n", bhr_error_message());
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

static uint32_t number(int argc, char **argv, int index, uint32_t usual) {
    return index < argc ? (uint32_t)strtoul(argv[index], NULL, 10) : usual;
}

static uint32_t smaller(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* Renders a tile and puts its rows into the frame of process 0. */
static void make_tile(BhrContext *context, BhrRegion region, uint32_t side, unsigned char *pixels, MPI_Win frame) {
    BhrImage image;
    BHR_INIT(image);
    image.width = smaller(side, region.full_width - region.x);
    image.height = smaller(side, region.full_height - region.y);
    image.pixels = pixels;
    image.byte_size = (uint64_t)image.width * image.height * 4;
    need(bhr_set_region(context, &region));
    need(bhr_render_image(context, &image));
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, frame);
    for (uint32_t row = 0; row < image.height; row++) {
        const MPI_Aint place = ((MPI_Aint)region.y + row) * region.full_width + region.x;
        MPI_Put(pixels + (size_t)row * image.width * 4, (int)image.width, MPI_UINT32_T, 0, place, (int)image.width,
                MPI_UINT32_T, frame);
    }
    MPI_Win_unlock(0, frame);
}

int main(int argc, char **argv) {
    int rank = 0;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    BhrRegion region;
    BHR_INIT(region);
    region.full_width = number(argc, argv, 2, 0), region.full_height = number(argc, argv, 3, 0);
    const uint32_t side = number(argc, argv, 5, 1024);
    if (argc < 5 || region.full_width == 0 || region.full_height == 0 || side == 0) {
        fprintf(stderr, "usage: tiles SCENE WIDTH HEIGHT OUT.png [TILE] [SECONDS] [BACKEND]\n");
        MPI_Abort(MPI_COMM_WORLD, 64);
    }

    BhrContext       *context = NULL;
    BhrContextOptions options;
    BHR_INIT(options);
    options.backend = (BhrBackend)number(argc, argv, 7, BHR_BACKEND_AUTO);
    need(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    need(bhr_scene_load_file(context, argv[1]));
    need(bhr_scene_at(context, argc > 6 ? strtod(argv[6], NULL) : 0.0));

    /* The frame and the number of the next tile lie in process 0; the others have windows of nothing. */
    const MPI_Aint bytes = rank == 0 ? (MPI_Aint)region.full_width * region.full_height * 4 : 0;
    unsigned char *frame = NULL, *pixels = malloc((size_t)side * side * 4);
    int64_t       *next = NULL, tile = 0;
    const int64_t  one = 1;
    MPI_Win        frames, queue;
    MPI_Win_allocate(bytes, 4, MPI_INFO_NULL, MPI_COMM_WORLD, &frame, &frames);
    MPI_Win_allocate(rank == 0 ? 8 : 0, 8, MPI_INFO_NULL, MPI_COMM_WORLD, &next, &queue);
    if (rank == 0) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, queue);
        *next = 0;
        MPI_Win_unlock(0, queue);
    }
    if (pixels == NULL) {
        MPI_Abort(MPI_COMM_WORLD, 75);
    }
    MPI_Barrier(MPI_COMM_WORLD);

    const int64_t columns = (region.full_width + side - 1) / side;
    const int64_t tiles = columns * ((region.full_height + side - 1) / side);
    int           made = 0;
    for (;;) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, queue);
        MPI_Fetch_and_op(&one, &tile, MPI_INT64_T, 0, 0, MPI_SUM, queue);
        MPI_Win_unlock(0, queue);
        if (tile >= tiles) {
            break;
        }
        region.x = (uint32_t)(tile % columns) * side, region.y = (uint32_t)(tile / columns) * side;
        make_tile(context, region, side, pixels, frames);
        made++;
    }
    printf("process %d has made %d of %d tiles\n", rank, made, (int)tiles);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, frames);
        BhrImage image;
        BHR_INIT(image);
        image.width = region.full_width, image.height = region.full_height;
        image.pixels = frame;
        image.byte_size = (uint64_t)bytes;
        need(bhr_image_save(&image, argv[4]));
        MPI_Win_unlock(0, frames);
    }
    MPI_Win_free(&frames);
    MPI_Win_free(&queue);
    free(pixels);
    bhr_context_destroy(context);
    MPI_Finalize();
    return 0;
}
