/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* matter.h -- volumes and hot spots from text, as options of the example programs have them:
 * "torus,radius=9,infall=0.2" and "radius=7,size=0.7". Knows no context and makes no frame. */
#ifndef EXAMPLES_MATTER_H
#define EXAMPLES_MATTER_H

#include "options.h"

#include <bhr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The values of --volume and --hot-spot, as --help names them. */
#define VOLUME_VALUE "KIND,FIELD=X,..."
#define HOT_SPOT_VALUE "FIELD=X,..."

extern const Choice VOLUME_KINDS[];

/* A volume that suits its kind, where the library's defaults are those of a disk. Errors: as the library's. */
BhrStatus volume_begin(BhrVolume *volume, BhrVolumeShape kind);

/* Reads a volume: a kind (disk, torus, halo, jet), then fields by BhrVolume's names with - for _, angles in degrees,
 * colours R/G/B, and the words retrograde, power-law and thermal. `name`: of the option, for messages; `turbulence`:
 * where the text does not say. 0, or an exit status after a message on stderr. Ranges are left to the library. */
int volume_read(const char *name, const char *text, double turbulence, BhrVolume *out);

/* Reads a hot spot, as volume_read reads a volume, but without a kind; its words are retrograde and thermal. */
int hot_spot_read(const char *name, const char *text, BhrHotSpot *out);

/* All texts of an option, in their order. *out_count: how many; more than `most` are refused. 0, or an exit status. */
int volumes_read(const char *name, const TextList *texts, double turbulence, BhrVolume *out, uint32_t most,
                 uint32_t *out_count);
int hot_spots_read(const char *name, const TextList *texts, BhrHotSpot *out, uint32_t most, uint32_t *out_count);

#ifdef __cplusplus
}
#endif

#endif
