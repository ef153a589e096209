// SPDX-License-Identifier: MIT OR Apache-2.0
// hole.js -- a frame of a spinning black hole as hole.png, from Node. bhr.json declares the library to koffi (npm
// install koffi).
//
//     node hole.js include/bhr.json path/of/libbhr.so
const koffi = require("koffi");
const api = JSON.parse(require("node:fs").readFileSync(process.argv[2], "utf8"));
const library = koffi.load(process.argv[3]), bhr = {}, C = {};
for (const constant of api.constants) C[constant.name] = constant.value;
for (const type of api.enumerations) koffi.alias(type.name, type.type);
for (const type of api.opaque_types) koffi.opaque(type.name);
for (const { name, result, parameters } of api.callbacks)
  koffi.alias(name, koffi.pointer(koffi.proto(`${name} function`, result.type, parameters.map((p) => p.type))));
const member = (field) => [field.name, field.array ? koffi.array(field.type, field.array) : field.type];
for (const type of api.structs) koffi.struct(type.name, Object.fromEntries(type.fields.map(member)));
const passed = { in: (type) => type, out: (type) => koffi.out(type), inout: (type) => koffi.inout(type) };
for (const { name, result, parameters } of api.functions)
  bhr[name] = library.func(name, result.type, parameters.map((p) => passed[p.direction](p.type)));

const check = (status) => { if (status < 0) throw new Error(bhr.bhr_error_message()); };
const context = [null], camera = {}, image = {}, pixels = Buffer.alloc(640 * 360 * 4);
check(bhr.bhr_context_create(C.BHR_ABI_VERSION, null, context));
check(bhr.bhr_camera_init(camera, koffi.sizeof("BhrCamera")));
check(bhr.bhr_camera_orbit(camera, 25, 0, 0.15));
check(bhr.bhr_set_camera(context[0], camera));
check(bhr.bhr_set_spin(context[0], 0.9));
check(bhr.bhr_image_init(image, koffi.sizeof("BhrImage")));
Object.assign(image, { width: 640, height: 360, pixels, byte_size: pixels.length });
check(bhr.bhr_render_image(context[0], image));
check(bhr.bhr_image_save(image, "hole.png"));
bhr.bhr_context_destroy(context[0]);
