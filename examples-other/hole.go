// SPDX-License-Identifier: MIT OR Apache-2.0
// hole.go -- a frame of a spinning black hole as hole.png, from Go through cgo, which reads bhr.h itself.
//
//	CGO_CFLAGS=-Iinclude CGO_LDFLAGS="-Ltarget/release -Wl,-rpath,$PWD/target/release" go run examples-other/hole.go
package main

// #cgo LDFLAGS: -lbhr
// #include <bhr.h>
// #include <stdlib.h>
import "C"
import "runtime"

func check(status C.BhrStatus) {
	if status < 0 {
		panic(C.GoString(C.bhr_error_message()))
	}
}

func main() {
	runtime.LockOSThread() // a message belongs to the thread that the call failed on
	var context *C.BhrContext
	var camera C.BhrCamera
	var image C.BhrImage
	check(C.bhr_context_create(C.BHR_ABI_VERSION, nil, &context))
	defer C.bhr_context_destroy(context)
	check(C.bhr_camera_init(&camera, C.sizeof_BhrCamera))
	check(C.bhr_camera_orbit(&camera, 25, 0, 0.15))
	check(C.bhr_set_camera(context, &camera))
	check(C.bhr_set_spin(context, 0.9))
	check(C.bhr_image_init(&image, C.sizeof_BhrImage))
	image.width, image.height, image.byte_size = 640, 360, 640*360*4
	image.pixels = C.calloc(1, 640*360*4) // memory of C's: what is passed to C must not point to Go's
	defer C.free(image.pixels)
	check(C.bhr_render_image(context, &image))
	check(C.bhr_image_save(&image, C.CString("hole.png")))
}
