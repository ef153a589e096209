/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene_files.h -- where the scene files of examples-c/scenes are, and what they say of themselves. Knows no context
 * and makes no frame. */
#ifndef EXAMPLES_SCENE_FILES_H
#define EXAMPLES_SCENE_FILES_H

#define MOST_PATH 4096 /* bytes of a path with its NUL */
#define MOST_ABOUT 512

/* For --help. */
#define SCENES_DEFAULT "else scenes beside the program, or ../share/bhr/scenes"

/* Puts the path of FOLDER/NAME.toml into `path`, of MOST_PATH bytes. `folder`: NULL where the program shall find it:
 * scenes beside the program, where builds put them, else share/bhr/scenes, where packages do. 1, or 0 after a
 * message. */
int scene_file_path(const char *folder, const char *name, char *path);

/* Puts the sentence that a scene file begins with into `about`, of MOST_ABOUT bytes: the comment below its licence. 1,
 * or 0 after a message. */
int scene_file_about(const char *path, char *about);

#endif
