-- SPDX-License-Identifier: MIT OR Apache-2.0
-- hole.lua -- a frame of a spinning black hole as hole.png, from LuaJIT. bhr.json declares the library; dkjson reads it
-- (Debian: luajit lua-dkjson).
--
--     luajit hole.lua include/bhr.json [path of libbhr.so]
local ffi, json = require "ffi", require "dkjson"
local api = assert(json.decode(assert(io.open(arg[1])):read "*a"))
ffi.cdef(table.concat(api.declarations, "\n"))
local bhr, C = ffi.load(arg[2] or "bhr"), {}
for _, constant in ipairs(api.constants) do C[constant.name] = constant.value end

local function check(status)
    if status < 0 then error(ffi.string(bhr.bhr_error_message()), 2) end
end

local made, camera, image = ffi.new "BhrContext *[1]", ffi.new "BhrCamera", ffi.new "BhrImage"
check(bhr.bhr_context_create(C.BHR_ABI_VERSION, nil, made))
local context = ffi.gc(made[0], bhr.bhr_context_destroy)
check(bhr.bhr_camera_init(camera, ffi.sizeof(camera)))
check(bhr.bhr_camera_orbit(camera, 25, 0, 0.15))
check(bhr.bhr_set_camera(context, camera))
check(bhr.bhr_set_spin(context, 0.9))
local width, height = 640, 360
local pixels = ffi.new("uint8_t[?]", width * height * 4) -- must live as long as image points to it
check(bhr.bhr_image_init(image, ffi.sizeof(image)))
image.width, image.height, image.pixels, image.byte_size = width, height, pixels, ffi.sizeof(pixels)
check(bhr.bhr_render_image(context, image))
check(bhr.bhr_image_save(image, "hole.png"))
