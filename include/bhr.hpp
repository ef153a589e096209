// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr.hpp -- bhr for C++17 and later: the whole of bhr.h with ownership, types and errors of C++. Header only; it needs
 * the library that bhr.h needs, and nothing else. Compiles with and without exceptions and RTTI.
 *
 * Example
 *   #include <bhr.hpp>
 *
 *   int main() {
 *       bhr::Context context = bhr::Context::create().value(); // value() throws bhr::Error; see below
 *       bhr::Camera camera;                                    // the defaults of bhr_camera_init
 *       camera.orbit(20.0, 0.0, 0.1).value();
 *       context.set_spin(0.9).value();
 *       context.set_camera(camera).value();
 *       context.render(640, 360).value().save("hole.png").value();
 *   }
 *
 * Errors
 *   Every call that can fail returns a bhr::Result, which holds its value or a bhr::Error with status and message. A
 *   compiler warns of one that is ignored. Two styles, which may be mixed:
 *     - ask it:     auto result = context.set_spin(2.0);  if (!result) puts(result.error().what());
 *     - value():    returns the value, or throws the bhr::Error. Without exceptions (-fno-exceptions, or with
 *                   BHR_NO_EXCEPTIONS defined) it calls bhr::failure_hook with the error, and then std::abort.
 *   The message is taken on the thread of the call, so that it is never another call's. Memory that the C++ library
 *   cannot get is std::bad_alloc, as anywhere. All files of a program are to be compiled alike, with or without
 *   exceptions.
 *
 * Names
 *   A constant BHR_GROUP_NAME is bhr::Group::name, an enum class: a constant of another group does not compile. Bits
 *   join by |. A struct BhrName is bhr::Name with the same fields in the same places; c() gives the C struct. Handles
 *   are move-only and end themselves: bhr::Context, bhr::Job, bhr::Surface; get() gives the C handle, for bhr.h's own
 *   functions. What a function does, its ranges and its errors stand in bhr.h at the C function, which each comment
 *   names.
 *
 * Callbacks
 *   Progress and log callbacks are functors. An exception in one does not cross C: the progress callback's cancels the
 *   work; the exception is thrown again by the outermost call of bhr that the thread is in, whether or not value() is
 *   called. One from a log callback on a thread of the library's is dropped, because nobody waits there. Do not end a
 *   context, job or surface inside a callback: as in C that is ignored, and it is never freed.
 *
 * Threads
 *   As in bhr.h: any thread may call, and calls on one context wait for each other. Two things change a C++ object and
 *   must not run beside other uses of it: moving it, and Context::on_progress.
 */
#ifndef BHR_HPP
#define BHR_HPP

#include "bhr/camera.hpp"
#include "bhr/context.hpp"
#include "bhr/image.hpp"
#include "bhr/output.hpp"
#include "bhr/result.hpp"
#include "bhr/scene.hpp"

#endif
