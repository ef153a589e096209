# SPDX-License-Identifier: MIT OR Apache-2.0
"""The package says what bhr.h and bhr_interop.h say: every constant with its value, every struct with its fields and
defaults, every function."""

import dataclasses
import enum
import re
from pathlib import Path

import bhr
import numpy as np
import pytest
from bhr import interop
from bhr._ffi import ffi
from bhr._library import lib
from conftest import HEADER, INTEROP_HEADER

CODE = re.sub(r"/\*.*?\*/", " ", HEADER, flags=re.DOTALL)
INTEROP_CODE = re.sub(r"/\*.*?\*/", " ", INTEROP_HEADER, flags=re.DOTALL)

#: The prefix of each enumeration's constants.
ENUMS = {
    "BHR_": bhr.Status,
    "BHR_BACKEND_": bhr.Backend,
    "BHR_ADAPTER_": bhr.AdapterFlags,
    "BHR_PROJECTION_": bhr.Projection,
    "BHR_MOTION_": bhr.Motion,
    "BHR_EYE_": bhr.Eye,
    "BHR_CHART_": bhr.Chart,
    "BHR_WORLD_LINE_": bhr.WorldLineEnd,
    "BHR_FORMAT_": bhr.Format,
    "BHR_SKY_": bhr.SkyFlags,
    "BHR_TONE_MAP_": bhr.ToneMap,
    "BHR_TRANSPORT_": bhr.Transport,
    "BHR_COLOUR_MAP_": bhr.ColourMap,
    "BHR_COLOUR_SPACE_": bhr.ColourSpace,
    "BHR_EFFECT_": bhr.Effects,
    "BHR_PRESET_": bhr.Preset,
    "BHR_PRESET_MATTER_": bhr.PresetMatter,
    "BHR_METHOD_": bhr.Method,
    "BHR_VOLUME_RESOLUTION_": bhr.VolumeResolution,
    "BHR_VIEW_": bhr.View,
    "BHR_OUTPUT_": bhr.OutputKind,
    "BHR_FATE_": bhr.Fate,
    "BHR_FLOW_": bhr.Flow,
    "BHR_HOT_SPOT_": bhr.HotSpotFlags,
    "BHR_MATRIX_": bhr.MatrixFlags,
}

#: Constants of C that Python has by other means: arguments, logging's levels, numpy's strides. Windows are left out.
ELSEWHERE = re.compile(
    r"BHR_(VERSION_\w+|ABI_VERSION|LOG_\w+|CONTEXT_VALIDATION|IMAGE_TRANSPARENT|IMAGE_BOTTOM_UP|IMAGE_LENSED"
    r"|MAX_CROSSINGS"
    r"|MAX_VOLUMES|MAX_IMAGE_ORDER|MAX_HOT_SPOTS|MAX_OUTPUTS|WINDOW_\w+|PRESENT_\w+)"
)

#: Functions for windows, which this package does not have; and what cffi or numpy do in their place.
LEFT_OUT = {
    "bhr_surface_create",
    "bhr_surface_destroy",
    "bhr_surface_resize",
    "bhr_surface_set_present_mode",
    "bhr_render_surface",
    "bhr_version",
    "bhr_status_name",
    "bhr_image_init",
    "bhr_camera_init",
    "bhr_disk_init",
    "bhr_sky_init",
    "bhr_film_init",
    "bhr_quality_init",
    "bhr_preset_options_init",
    "bhr_volume_init",
    "bhr_hot_spot_init",
    "bhr_output_init",
    "bhr_adapter_info_init",
    "bhr_body_init",
    "bhr_frame_stats_init",
    "bhr_hole_info_init",
    "bhr_projected_point_init",
    "bhr_region_init",
    "bhr_window_init",
    # Messages are read on the thread of the call that failed.
    "bhr_context_error_message",
    "bhr_job_error_message",
}

STRUCTS = [
    bhr.AdapterInfo,
    bhr.Camera,
    bhr.Disk,
    bhr.Film,
    bhr.FrameStats,
    bhr.HoleInfo,
    bhr.HotSpot,
    bhr.ProjectedPoint,
    bhr.Quality,
    bhr.Region,
    bhr.Sky,
    bhr.Volume,
]


#: A VkDevice of the host's is for hosts in C, and cffi clears structs.
INTEROP_LEFT_OUT = {
    "bhr_vulkan_requirements",
    "bhr_context_create_vulkan",
    "bhr_target_wrap_vulkan",
    "bhr_target_vulkan",
    "bhr_semaphore_wrap_vulkan",
    "bhr_semaphore_vulkan",
    "bhr_interop_info_init",
    "bhr_sync_init",
    "bhr_target_info_init",
    "bhr_vulkan_device_init",
    "bhr_vulkan_requirements_init",
}


def constants(code=CODE):
    found = re.findall(r"^#define (BHR_\w+) +(?:(\d+)u?|\(0 - (\d+)\)) *$", code, re.MULTILINE)
    return {name: int(value) if value else -int(negative) for name, value, negative in found}


def test_every_constant_has_a_member():
    header = constants()
    assert len(header) > 80
    members = {}
    for prefix, kind in ENUMS.items():
        for name, member in kind.__members__.items():
            error = kind is bhr.Status and member < 0
            members[f"{prefix}ERROR_{name}" if error else prefix + name] = int(member)
    # Enumerations share the prefixes of the disk's and the volumes' constants.
    for kind in bhr.DiskFlags, bhr.DiskReference, bhr.EmissionLaw:
        members.update({f"BHR_DISK_{name}": int(member) for name, member in kind.__members__.items()})
    for kind in bhr.VolumeFlags, bhr.VolumeShape:
        members.update({f"BHR_VOLUME_{name}": int(member) for name, member in kind.__members__.items()})
    assert {name: value for name, value in header.items() if not ELSEWHERE.fullmatch(name)} == members


def test_every_constant_of_the_interop_has_a_member():
    prefixes = {
        "BHR_HANDLE_": interop.HandleType,
        "BHR_TARGET_": interop.TargetKind,
        "BHR_SEMAPHORE_": interop.SemaphoreKind,
    }
    members = {}
    for prefix, kind in prefixes.items():
        members.update({prefix + name: int(member) for name, member in kind.__members__.items()})
    header = constants(INTEROP_CODE)
    assert header.pop("BHR_TARGET_COPY") == 256  # of images on a VkDevice of the host's
    assert header == members


@pytest.mark.parametrize("struct", [*STRUCTS, interop.Info, interop.TargetInfo], ids=lambda struct: struct.__name__)
def test_every_field_is_there(struct):
    left_out = {"struct_size", "reserved", "reserved2", "luid_valid"}
    fields = {name for name, _ in ffi.typeof(struct.c_name).fields} - left_out
    assert fields == {field.name for field in dataclasses.fields(struct)}
    for name, kind in getattr(struct, "c_enums", {}).items():
        assert name in fields and issubclass(kind, enum.Enum)


def test_every_struct_is_there():
    structs = set(re.findall(r"^typedef struct \w+ \{.*?^\} (\w+);", CODE, re.MULTILINE | re.DOTALL))
    others = {"BhrContextOptions", "BhrImage", "BhrRay", "BhrHit", "BhrCrossing", "BhrTransfer", "BhrWindow"}
    others |= {"BhrBody", "BhrOutput", "BhrPresetOptions"}  # arguments of methods
    assert structs == others | {struct.c_name for struct in STRUCTS}


@pytest.mark.parametrize("struct", [bhr.Camera, bhr.Disk, bhr.Film, bhr.HotSpot, bhr.Quality, bhr.Sky, bhr.Volume])
def test_defaults_are_the_librarys(struct):
    c = ffi.new(f"{struct.c_name} *")
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", struct.__name__).lower()
    assert getattr(lib, f"bhr_{name}_init")(c, ffi.sizeof(struct.c_name)) == 0
    assert struct.from_c(c) == struct()
    made = struct().to_c()
    assert made.struct_size == c.struct_size and struct.from_c(made) == struct()


#: The order of fields, which hosts may count on: a new one goes behind these.
POSITIONS = {
    bhr.Camera: (
        "position forward up fov_y projection motion velocity tan_left tan_right tan_down tan_up jitter "
        "eye_distance eye"
    ),
    bhr.Disk: (
        "inner_radius outer_radius temperature opacity brightness turbulence seed flags reference emission_law "
        "edge_softness"
    ),
    bhr.Film: (
        "tone_map exposure_ev bloom beam_fwhm colour_map spike_blades white_balance tint contrast saturation "
        "toe_strength toe_length shoulder_strength shoulder_length shoulder_angle vignette "
        "auto_exposure auto_percentile auto_target auto_least_ev auto_most_ev auto_adaptation highlights shadows "
        "grain grain_seed lut_strength spikes spike_angle spike_length streak streak_length streak_tint "
        "paper_white peak flare flare_ghosts"
    ),
    bhr.HotSpot: (
        "radius size azimuth flags absorption temperature spectral_index tint brightness position velocity time"
    ),
    bhr.Quality: "method samples_per_pixel max_steps step tolerance max_disk_order render_scale volume_resolution",
    bhr.Region: "full_width full_height x y",
    bhr.Sky: "flags stars_brightness map_brightness orientation seed",
    bhr.Volume: (
        "shape flow flags inner_radius outer_radius radius width thickness opening slope absorption temperature "
        "temperature_slope spectral_index tint brightness sub_keplerian infall angular_momentum speed turbulence "
        "clumping heating seed"
    ),
}


@pytest.mark.parametrize("struct", POSITIONS, ids=lambda struct: struct.__name__)
def test_fields_keep_their_positions(struct):
    known = POSITIONS[struct].split()
    assert [field.name for field in dataclasses.fields(struct)][: len(known)] == known


RAYS = [(bhr.RAY, "BhrRay"), (bhr.HIT, "BhrHit"), (bhr.CROSSING, "BhrCrossing"), (bhr.TRANSFER, "BhrTransfer")]
RAYS += [(bhr.PROJECTED, "BhrProjectedPoint"), (bhr.BODY, "BhrBody")]


@pytest.mark.parametrize(("dtype", "name"), RAYS)
def test_dtypes_have_the_layout_of_c(dtype, name):
    assert dtype.itemsize == ffi.sizeof(name)
    fields = ffi.typeof(name).fields
    assert list(dtype.names) == [field for field, _ in fields]
    for field, c in fields:
        kind, offset = dtype.fields[field][:2]
        assert (offset, kind.itemsize) == (c.offset, ffi.sizeof(c.type))


@pytest.mark.parametrize(
    ("code", "least", "left_out"), [(CODE, 60, LEFT_OUT), (INTEROP_CODE, 20, INTEROP_LEFT_OUT)], ids=["bhr", "interop"]
)
def test_every_function_is_called(code, least, left_out):
    functions = set(re.findall(r"\b(bhr_\w+)\(", code))
    assert len(functions) > least
    package = Path(bhr.__file__).parent
    source = "".join(file.read_text() for file in package.glob("*.py") if file.name != "_ffi.py")
    called = {name for name in functions if re.search(rf"lib\.{name}\b", source)}
    assert functions - called == left_out & functions
    for name in functions:
        assert getattr(lib, name)


def test_version():
    header = constants()
    assert bhr.__version__ == ".".join(str(header[f"BHR_VERSION_{part}"]) for part in ("MAJOR", "MINOR", "PATCH"))
    assert np.uint32(lib.bhr_version()) == sum(int(n) << s for n, s in zip(bhr.__version__.split("."), (16, 8, 0)))


def test_names_that_are_exported_are_there():
    assert {name for name in vars(bhr) if not name.startswith("_")} == set(bhr.__all__)
    assert all(hasattr(interop, name) for name in interop.__all__)
