/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* observatory_image.c -- images of matter that shines by synchrotron light, at some frequencies: Jy in each pixel as
 * FITS, false colour as PNG, both blurred by a telescope's beam.
 *
 * At the frequency nu the matter sends j0 (nu / 230 GHz)^-alpha n and absorbs a0 (nu / 230 GHz)^-(2.5 + alpha) n per
 * unit of length, as electrons with a power law of energies do (Rybicki and Lightman 1979, eqs. 6.36 and 6.53). a0 is
 * given; j0 follows from the flux at 230 GHz. */
#include "colour_bar.h"
#include "matter.h"
#include "fits.h"
#include "observatory.h"
#include "plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_FREQUENCIES 8u
#define REFERENCE_GHZ 230.0
#define DEFAULT_VOLUME \
    "halo,power-law,radius=5,thickness=0.5,outer-radius=60,spectral-index=0.7,absorption=0.06,infall=0.2"
#define PICTURE_WIDTH 640u /* pixels of a picture at least */
#define NAME_SIZE 64u

typedef struct Images {
    Settings   *s;
    BhrContext *context;
    BhrVolume   volumes[BHR_MAX_VOLUMES];
    uint32_t    volume_count;
    double      index;         /* alpha, the same for all volumes */
    double      frequencies[MOST_FREQUENCIES]; /* GHz */
    uint32_t    frequency_count;
    size_t      count;         /* pixels */
    double      pixel;         /* of the side of one, radians */
    double      emission;      /* W / m^2 / Hz / sr of 1 M of density 1 at 230 GHz; 0: not known yet */
    double     *light, *depth; /* I_nu where 1 M of density 1 sends 1, then Jy in each pixel; optical depth */
} Images;

/* One of them, in the units of telescopes. */
typedef struct Measured {
    double ghz;
    double flux, kept; /* Jy: before the beam, and within the frame after it */
    double peak;       /* K, of the brightest pixel after the beam: c^2 I / (2 k nu^2) */
    double depth;      /* mean optical depth of rays that escape, weighted by their light */
} Measured;

/* ---- input ---- */

static int read_frequencies(Images *images, const char *text) {
    const char *rest = text;
    for (;;) {
        double ghz;
        rest = option_read_double(rest, &ghz);
        if (rest == NULL || (*rest != ',' && *rest != '\0') || !(ghz >= 1.0 && ghz <= 1e5) ||
            images->frequency_count == MOST_FREQUENCIES) {
            fprintf(stderr, "observatory: '%s' is no value for --frequency, which takes 1 to %u numbers of GHz, "
                            "each 1 to 1e5, with commas between them\n", text, MOST_FREQUENCIES);
            return EXIT_USAGE;
        }
        for (uint32_t i = 0; i < images->frequency_count; i++) {
            char name[32], other[32];
            snprintf(name, sizeof name, "%g", ghz);
            snprintf(other, sizeof other, "%g", images->frequencies[i]);
            if (strcmp(name, other) == 0) {
                fprintf(stderr, "observatory: --frequency has %.17g and %.17g GHz, whose files would both be named %s; "
                                "they must differ in the first six digits\n", images->frequencies[i], ghz, name);
                return EXIT_USAGE;
            }
        }
        images->frequencies[images->frequency_count++] = ghz;
        if (*rest++ == '\0') {
            return 0;
        }
    }
}

static int read_volumes(Images *images, const TextList *texts) {
    const TextList one = {{DEFAULT_VOLUME}, 1};
    const int      result = volumes_read("observatory: --volume", texts->count > 0 ? texts : &one, 0.0, images->volumes,
                                         BHR_MAX_VOLUMES, &images->volume_count);
    for (uint32_t i = 0; result == 0 && i < images->volume_count; i++) {
        if (!(images->volumes[i].flags & BHR_VOLUME_POWER_LAW)) {
            fprintf(stderr, "observatory: volume %u is no power law of the frequency: add the word power-law\n",
                    (unsigned)i);
            return EXIT_USAGE;
        }
        /* The library sums them with one emission at the camera's frequency. */
        if (images->volumes[i].spectral_index != images->volumes[0].spectral_index) {
            fprintf(stderr, "observatory: spectral-index is %g in one volume and %g in another; it must be the same\n",
                    images->volumes[0].spectral_index, images->volumes[i].spectral_index);
            return EXIT_USAGE;
        }
    }
    images->index = images->volumes[0].spectral_index;
    return result;
}

/* ---- light ---- */

/* Traces the image at a frequency, into `light` and `depth`. */
static int trace(Images *images, double ghz, uint32_t number, uint32_t of) {
    BhrVolume volumes[BHR_MAX_VOLUMES];
    memcpy(volumes, images->volumes, sizeof volumes);
    for (uint32_t i = 0; i < images->volume_count; i++) {
        volumes[i].absorption *= pow(ghz / REFERENCE_GHZ, -(2.5 + images->index));
    }
    const BhrStatus status = bhr_set_volumes(images->context, volumes, sizeof *volumes, images->volume_count);
    if (status < 0) {
        char doing[64];
        snprintf(doing, sizeof doing, "set the matter at %g GHz", ghz);
        return report_failure(doing, status);
    }
    const Settings *s = images->s;
    const Grid      grid = grid_of_pixels(s->inclination, s->position_angle, s->observer,
                                          images->pixel * s->pixels / angle_of(&s->target), s->pixels, !s->plain);
    Transferred     out = {images->light, images->depth, &images->s->progress, (double)number / of, 1.0 / of};
    return grid_transfer(images->context, &grid, &out);
}

static double sum_of(const double *values, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum;
}

/* Finds j0 from the image at 230 GHz that was just traced. */
static int scale_emission(Images *images) {
    const double sum = sum_of(images->light, images->count) * images->pixel * images->pixel;
    if (!(sum > 0.0)) {
        fprintf(stderr, "observatory: no light arrives at 230 GHz, so that nothing can be scaled to --flux-230\n");
        return EXIT_FAILURE;
    }
    images->emission = images->s->flux * JANSKY / sum;
    return 0;
}

/* The share of a Gaussian's light that falls into the pixel `away` pixels from its centre's. */
static double share_of(double sigma, double away) {
    const double scale = sigma * sqrt(2.0);
    return 0.5 * (erf((away + 0.5) / scale) - erf((away - 0.5) / scale));
}

/* Spreads the light of each of `side` pixels that lie `stride` apart. `row` and `weights` have room for `side`. */
static void spread(double *pixels, size_t stride, uint32_t side, uint32_t reach, const double *weights, double *row) {
    for (uint32_t i = 0; i < side; i++) {
        const uint32_t first = i > reach ? i - reach : 0, last = side - 1 - i > reach ? i + reach : side - 1;
        row[i] = 0.0;
        for (uint32_t j = first; j <= last; j++) {
            row[i] += weights[j > i ? j - i : i - j] * pixels[stride * j];
        }
    }
    for (uint32_t i = 0; i < side; i++) {
        pixels[stride * i] = row[i];
    }
}

/* The beam, along rows and then along columns. Light that it puts outside the frame is lost. */
static int blur(double *pixels, uint32_t side, double sigma) {
    double *room = allocate_doubles((size_t)side * 2);
    if (room == NULL) {
        return EXIT_FAILURE;
    }
    /* The light beyond six sigma is 2e-9 of all. */
    const uint32_t reach = (uint32_t)fmin(ceil(6.0 * sigma), side - 1.0);
    for (uint32_t i = 0; i <= reach; i++) {
        room[i] = share_of(sigma, i);
    }
    for (uint32_t i = 0; i < side; i++) {
        spread(pixels + (size_t)i * side, 1, side, reach, room, room + side);
    }
    for (uint32_t i = 0; i < side; i++) {
        spread(pixels + i, side, side, reach, room, room + side);
    }
    free(room);
    return 0;
}

/* From what the rays have, to Jy in each pixel, blurred. */
static int measure(Images *images, double ghz, Measured *out) {
    const Settings *s = images->s;
    double          depth = 0.0, escaped = 0.0;
    for (size_t i = 0; i < images->count; i++) {
        if (isfinite(images->depth[i])) {
            depth += images->light[i] * images->depth[i];
            escaped += images->light[i];
        }
    }
    const double area = images->pixel * images->pixel;
    const double unit = images->emission * pow(ghz / REFERENCE_GHZ, -images->index) * area / JANSKY;
    for (size_t i = 0; i < images->count; i++) {
        images->light[i] *= unit;
    }
    out->ghz = ghz;
    out->depth = escaped > 0.0 ? depth / escaped : 0.0;
    out->flux = sum_of(images->light, images->count);
    if (s->beam > 0.0) {
        const double sigma = s->beam * MICROARCSECOND / images->pixel / sqrt(8.0 * log(2.0));
        const int    result = blur(images->light, s->pixels, sigma);
        if (result != 0) {
            return result;
        }
    }
    out->kept = sum_of(images->light, images->count);
    double peak = 0.0;
    for (size_t i = 0; i < images->count; i++) {
        peak = fmax(peak, images->light[i]);
    }
    const double wave = SPEED_OF_LIGHT / (ghz * 1e9);
    out->peak = peak * JANSKY / area * wave * wave / (2.0 * BOLTZMANN);
    return 0;
}

/* ---- FITS ---- */

static int write_fits(const Images *images, const Measured *found, const char *path) {
    const Settings *s = images->s;
    const double    degrees = images->pixel * 180.0 / PI, middle = 0.5 * (s->pixels + 1.0);
    const double    beam = s->beam / 3600e6;
    FitsCard        cards[36 + BHR_MAX_VOLUMES] = {
        {"OBJECT", FITS_TEXT, 0.0, s->target.object, "a model of it"},
        {"TELESCOP", FITS_TEXT, 0.0, "bhr", "examples-c/observatory.c"},
        /* Units are case-sensitive (FITS 4.0, section 4.3). */
        {"BUNIT", FITS_TEXT, 0.0, "Jy/pixel", "sums to the flux"},
        /* A model was observed on no day. Programs that compare it with observations want one, and an epoch for its
         * place: the day of the observation that it is a model of, which also makes equal runs write equal files. DATE,
         * when the file was written, is left out for that. ehtim reads MJD, other programs the standard's names. */
        {"DATE-OBS", FITS_TEXT, 0.0, s->target.date, "nominal: of the observation that is modelled"},
        {"MJD-OBS", FITS_NUMBER, s->target.day, NULL, "d, the same day"},
        {"MJD", FITS_NUMBER, s->target.day, NULL, "d, the same day, for ehtim"},
        {"FREQ", FITS_NUMBER, found->ghz * 1e9, NULL, "Hz"},
        {"BMAJ", FITS_NUMBER, beam, NULL, "deg, width at half of the peak; 0: no beam"},
        {"BMIN", FITS_NUMBER, beam, NULL, "deg"},
        {"BPA", FITS_NUMBER, 0.0, NULL, "deg"},
        {"CTYPE1", FITS_TEXT, 0.0, "RA---SIN", "east is left"},
        {"CRPIX1", FITS_NUMBER, middle, NULL, ""},
        {"CRVAL1", FITS_NUMBER, s->target.right_ascension, NULL, "deg, of the hole"},
        {"CDELT1", FITS_NUMBER, -degrees, NULL, "deg"},
        {"CUNIT1", FITS_TEXT, 0.0, "deg", ""},
        {"CTYPE2", FITS_TEXT, 0.0, "DEC--SIN", "north is up"},
        {"CRPIX2", FITS_NUMBER, middle, NULL, ""},
        {"CRVAL2", FITS_NUMBER, s->target.declination, NULL, "deg, of the hole"},
        {"CDELT2", FITS_NUMBER, degrees, NULL, "deg"},
        {"CUNIT2", FITS_TEXT, 0.0, "deg", ""},
        {"RADESYS", FITS_TEXT, 0.0, "ICRS", ""},
        {"FLUX", FITS_NUMBER, found->kept, NULL, "Jy, the sum of the pixels"},
        {"FLUXSRC", FITS_NUMBER, found->flux, NULL, "Jy, before the beam put light out of the frame"},
        {"TBPEAK", FITS_NUMBER, found->peak, NULL, "K, c^2 I / (2 k nu^2) of the brightest pixel"},
        {"MASS", FITS_NUMBER, s->target.mass, NULL, "of the hole, in those of the Sun"},
        {"DISTANCE", FITS_NUMBER, s->target.distance, NULL, "kpc"},
        {"SPIN", FITS_NUMBER, s->spin, NULL, "a / M"},
        {"INCLIN", FITS_NUMBER, s->inclination * 180.0 / PI, NULL, "deg, between spin and the way to us"},
        {"POSANGLE", FITS_NUMBER, s->position_angle * 180.0 / PI, NULL, "deg, of the spin, north over east"},
        {"EMISSION", FITS_NUMBER, images->emission, NULL, "W/m2/Hz/sr of M at density 1 and 230 GHz"},
        {NULL, FITS_HISTORY, 0.0, "Matter (bhr.h, BhrVolume; absorption per M at 230 GHz):", NULL},
    };
    const TextList one = {{DEFAULT_VOLUME}, 1}, *texts = s->volumes.count > 0 ? &s->volumes : &one;
    size_t         count = 0;
    while (count < COUNT_OF(cards) && (cards[count].name != NULL || cards[count].text != NULL)) {
        count++;
    }
    for (size_t i = 0; i < texts->count; i++) {
        const FitsCard card = {NULL, FITS_HISTORY, 0.0, texts->list[i], NULL};
        cards[count++] = card;
    }
    return fits_write(path, images->light, s->pixels, s->pixels, cards, count);
}

/* ---- the picture ---- */

static const Colour WHITE = {235, 235, 235};

/* Catmull and Rom 1974: a cubic through the values at -1, 0, 1, 2, at 0 <= t <= 1. */
static double cubic(const double v[4], double t) {
    return v[1] + 0.5 * t * (v[2] - v[0] + t * (2.0 * v[0] - 5.0 * v[1] + 4.0 * v[2] - v[3] +
                                                t * (3.0 * (v[1] - v[2]) + v[3] - v[0])));
}

static double value_at(const double *pixels, uint32_t side, double x, double y) {
    const double left = floor(x), top = floor(y);
    double       column[4];
    for (int i = 0; i < 4; i++) {
        double       row[4];
        const size_t at_y = (size_t)fmin(fmax(top + i - 1, 0.0), side - 1.0);
        for (int j = 0; j < 4; j++) {
            row[j] = pixels[at_y * side + (size_t)fmin(fmax(left + j - 1, 0.0), side - 1.0)];
        }
        column[i] = cubic(row, x - left);
    }
    return cubic(column, y - top);
}

static void draw_pixels(const Images *images, BhrImage *picture, uint32_t scale) {
    const uint32_t side = images->s->pixels;
    double         peak = 0.0;
    for (size_t i = 0; i < images->count; i++) {
        peak = fmax(peak, images->light[i]);
    }
    for (uint32_t y = 0; y < side * scale; y++) {
        for (uint32_t x = 0; x < side * scale; x++) {
            const double   value = value_at(images->light, side, (x + 0.5) / scale - 0.5, (y + 0.5) / scale - 0.5);
            unsigned char *pixel = (unsigned char *)picture->pixels + 4 * ((size_t)y * picture->width + x);
            colour_afmhot(peak > 0.0 ? value / peak : 0.0, pixel);
            pixel[3] = 255;
        }
    }
}

/* 1, 2 or 5 times a power of ten, at most `most`. */
static double round_length(double most) {
    const double power = pow(10.0, floor(log10(most))), factor = most / power;
    return power * (factor >= 5.0 ? 5.0 : factor >= 2.0 ? 2.0 : 1.0);
}

/* The size of text in a picture that is so wide. */
static uint32_t text_scale(uint32_t width) {
    return width >= 1280 ? 3 : 2;
}

/* The words in the corners, the scale bar, the beam's size, on the square that the pixels fill. */
static void annotate(const Images *images, BhrImage *picture, const Measured *found) {
    const Settings *s = images->s;
    const uint32_t  text = text_scale(picture->width), line = CELL_HEIGHT * text, edge = picture->width / 32;
    const double    uas = picture->width / (images->pixel * s->pixels / MICROARCSECOND); /* pixels */
    char            words[64];
    snprintf(words, sizeof words, "%s", s->target.object);
    picture_write(picture, edge, edge, text, words);
    snprintf(words, sizeof words, "%g GHz", found->ghz);
    picture_write(picture, edge, edge + line, text, words);
    snprintf(words, sizeof words, "%.4g Jy", found->flux);
    uint32_t right = picture->width - edge;
    picture_write(picture, right - (uint32_t)strlen(words) * CELL_WIDTH * text, edge, text, words);
    snprintf(words, sizeof words, "peak %.2g K", found->peak);
    picture_write(picture, right - (uint32_t)strlen(words) * CELL_WIDTH * text, edge + line, text, words);

    const double length = round_length(0.3 * picture->width / uas), bottom = picture->width - edge;
    draw_line(picture, right - length * uas, bottom, right, bottom, 3.0, WHITE);
    snprintf(words, sizeof words, "%g uas", length);
    const double wide = (double)(strlen(words) * CELL_WIDTH * text);
    picture_write(picture, (uint32_t)(right - 0.5 * (length * uas + wide)), (uint32_t)bottom - line - 4, text, words);
    if (s->beam > 0.0 && s->beam * uas < 0.5 * picture->width) {
        const double radius = 0.5 * s->beam * uas, x = edge + radius, y = bottom - radius;
        for (int i = 0; i < 64; i++) {
            const double from = 2.0 * PI * i / 64.0, to = 2.0 * PI * (i + 1) / 64.0;
            draw_line(picture, x + radius * cos(from), y + radius * sin(from), x + radius * cos(to),
                      y + radius * sin(to), 2.0, WHITE);
        }
    }
}

/* Colours are shares of the peak; numbers are K over a power of ten, which the title names. */
static void draw_bar(BhrImage *picture, double peak, uint32_t text) {
    char         title[64];
    const double power = peak > 0.0 ? floor(log10(peak)) : 0.0;
    ColourBar    bar = {.title = title, .colour = colour_afmhot};
    snprintf(title, sizeof title, "brightness temperature, 1e%g K", power);
    if (peak > 0.0) {
        colour_bar_mark(&bar, peak / pow(10.0, power));
    }
    colour_bar_draw(picture, &bar, text);
}

static int write_picture(const Images *images, const Measured *found, const char *name) {
    const uint32_t side = images->s->pixels, scale = side >= PICTURE_WIDTH ? 1 : (PICTURE_WIDTH + side - 1) / side;
    const uint32_t text = text_scale(side * scale);
    BhrImage       picture;
    if (!picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, side * scale,
                          side * scale + COLOUR_BAR_ROWS * text)) {
        return 0;
    }
    draw_pixels(images, &picture, scale);
    annotate(images, &picture, found);
    draw_bar(&picture, found->peak, text);
    const int saved = picture_save_into(&picture, images->s->output, name);
    free(picture.pixels);
    return saved;
}

/* ---- the command ---- */

static int write_files(const Images *images, const Measured *found) {
    char name[NAME_SIZE];
    snprintf(name, sizeof name, "%s-%gGHz.fits", images->s->target.name, found->ghz);
    char *path = output_path(images->s, name);
    if (path == NULL) {
        return EXIT_FAILURE;
    }
    const int written = write_fits(images, found, path);
    progress_clear(&images->s->progress);
    if (written) {
        printf("%7g GHz  flux %.6g Jy, %.6g Jy in the file; peak %.3g K; optical depth %.3g; %s\n", found->ghz,
               found->flux, found->kept, found->peak, found->depth, path);
        fflush(stdout);
    }
    free(path);
    snprintf(name, sizeof name, "%s-%gGHz.png", images->s->target.name, found->ghz);
    return written && write_picture(images, found, name) ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int finish_image(Images *images, double ghz) {
    Measured  found;
    const int result = measure(images, ghz, &found);
    return result != 0 ? result : write_files(images, &found);
}

/* The image at 230 GHz comes first, listed or not, because it scales the emission. */
static int make_images(Images *images) {
    const Settings *s = images->s;
    uint32_t        traced = 1, all = 1;
    int             listed = 0;
    for (uint32_t i = 0; i < images->frequency_count; i++) {
        listed |= images->frequencies[i] == REFERENCE_GHZ;
        all += images->frequencies[i] != REFERENCE_GHZ;
    }
    int result = trace(images, REFERENCE_GHZ, 0, all);
    if (result == 0) {
        result = scale_emission(images);
    }
    if (result != 0) {
        return result;
    }
    progress_clear(&images->s->progress);
    const double metres = metres_of(&s->target);
    printf("%s: %.4g solar masses at %.6g kpc; M is %.4g microarcseconds, %.4g m, %.4g s\n", s->target.object,
           s->target.mass, s->target.distance, angle_of(&s->target) / MICROARCSECOND, metres, seconds_of(&s->target));
    printf("emission at density 1 and 230 GHz: %.4g W/m^2/Hz/sr per M, %.4g erg/s/cm^3/Hz/sr\n", images->emission,
           images->emission / metres * 10.0); /* W / m^3 = 10 erg / s / cm^3 */
    if (listed) {
        result = finish_image(images, REFERENCE_GHZ);
    }
    for (uint32_t i = 0; result == 0 && i < images->frequency_count; i++) {
        if (images->frequencies[i] != REFERENCE_GHZ) {
            result = trace(images, images->frequencies[i], traced++, all);
            if (result == 0) {
                result = finish_image(images, images->frequencies[i]);
            }
        }
    }
    return result;
}

int observatory_image(BhrContext *context, Settings *s) {
    Images images = {.s = s, .context = context, .count = (size_t)s->pixels * s->pixels};
    images.pixel = s->fov * MICROARCSECOND / s->pixels;
    int result = read_frequencies(&images, s->frequencies);
    if (result == 0) {
        result = check_width(s, images.pixel * s->pixels / angle_of(&s->target));
    }
    if (result == 0) {
        result = read_volumes(&images, &s->volumes);
    }
    if (result == 0) {
        const BhrStatus status = bhr_set_spin(context, s->spin);
        result = status < 0 ? report_failure("set the spin", status) : prepare_output(s);
    }
    if (result != 0) {
        return result;
    }
    images.light = allocate_doubles(images.count);
    images.depth = images.light != NULL ? allocate_doubles(images.count) : NULL;
    result = images.depth != NULL ? make_images(&images) : EXIT_FAILURE;
    free(images.light);
    free(images.depth);
    return result;
}
