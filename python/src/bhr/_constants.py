# SPDX-License-Identifier: MIT OR Apache-2.0
"""The constants of bhr.h as enumerations. bhr.h says at length what each one means."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """The result of a call of the C library; an Error has one below 0."""

    OK = 0
    NOT_READY = 1
    FRAME_SKIPPED = 2
    INVALID_ARGUMENT = -1
    INVALID_STATE = -2
    INCOMPATIBLE_ABI = -3
    UNSUPPORTED = -4
    NO_ADAPTER = -5
    OUT_OF_MEMORY = -6
    CANCELLED = -7
    SURFACE_LOST = -8
    DEVICE_LOST = -9
    IO = -10
    INTERNAL = -99


class Backend(enum.IntEnum):
    """The interface to an adapter. AUTO takes the best that there is, at last the CPU tracer."""

    AUTO = 0
    CPU = 1
    VULKAN = 2
    METAL = 3
    D3D12 = 4
    GL = 5


class AdapterFlags(enum.IntFlag):
    """Kinds of adapters."""

    DISCRETE = 1
    SOFTWARE = 2


class Projection(enum.IntEnum):
    """The camera's lens."""

    PERSPECTIVE = 0
    FISHEYE = 1
    EQUIRECT = 2
    CUBE = 3
    FRUSTUM = 4


class Eye(enum.IntEnum):
    """The eye for which an EQUIRECT picture is made, for stereo all round."""

    MIDDLE = 0
    LEFT = 1
    RIGHT = 2


class MatrixFlags(enum.IntFlag):
    """How a host's matrices and its clip space are: see BHR_MATRIX_* in bhr.h. Arrays of numpy are ROW_MAJOR."""

    ROW_MAJOR = 1
    Y_DOWN = 2
    ZERO_TO_ONE = 4
    REVERSED = 8
    FORWARD_Z = 16


class Motion(enum.IntEnum):
    """How the camera's observer moves."""

    STATIC = 0
    FREE_FALL = 1
    ORBIT = 2
    VELOCITY = 3


class DiskFlags(enum.IntFlag):
    """RETROGRADE: the matter orbits towards -ph. PLUNGES: it shines on its way from the ISCO to the horizon, too."""

    RETROGRADE = 1
    PLUNGES = 2


class DiskReference(enum.IntEnum):
    """The ring at whose radius a disk has the stated temperature and brightness."""

    AT_HOTTEST = 0
    AT_MEDIAN = 1


class EmissionLaw(enum.IntEnum):
    """How the disk's light depends on the angle to its normal."""

    ISOTROPIC = 0
    LIMB_DARKENED = 1


class VolumeFlags(enum.IntFlag):
    """RETROGRADE: the matter moves towards -ph. POWER_LAW: its light is a power law of the frequency, not a
    blackbody's."""

    RETROGRADE = 1
    POWER_LAW = 2


class VolumeShape(enum.IntEnum):
    """Where the matter of a volume is."""

    DISK = 0
    TORUS = 1
    HALO = 2
    JET = 3


class Flow(enum.IntEnum):
    """How the matter of a volume moves."""

    KEPLERIAN = 0
    ANGULAR_MOMENTUM = 1
    OUTFLOW = 2


class HotSpotFlags(enum.IntFlag):
    """RETROGRADE: the spot moves towards -ph. THERMAL: its light is a blackbody's, not a power law of the frequency."""

    RETROGRADE = 1
    THERMAL = 2


class Format(enum.IntEnum):
    """A pixel's bytes in memory. Float formats hold linear light; R32F holds the value of a view."""

    RGBA8_SRGB = 1
    BGRA8_SRGB = 2
    RGBA16F = 3
    RGBA32F = 4
    R32F = 5


class SkyFlags(enum.IntFlag):
    """The parts of the sky; MAP needs Context.set_sky_map."""

    STARS = 1
    PROCEDURAL = 2
    MILKY_WAY = 4
    MAP = 8
    GRID = 16


class ToneMap(enum.IntEnum):
    """The curve from light to pixels."""

    NONE = 0
    ACES = 1
    AGX = 2


class ColourMap(enum.IntEnum):
    """The colours of a picture: those of its light, or its luminance in a map of colours."""

    NONE = 0
    AFMHOT = 1


class Effects(enum.IntFlag):
    """Relativistic effects that colour the light. Lensing cannot be switched off."""

    DOPPLER_SHIFT = 1
    GRAVITY_SHIFT = 2
    BEAMING = 4
    LIGHT_DELAY = 8
    ALL = 4294967295


class Preset(enum.IntEnum):
    """A named look: values for disk, sky, film and effects."""

    CINEMATIC = 0
    PHYSICAL = 1
    OBSERVATORY = 2
    TEACHING = 3


class PresetMatter(enum.IntEnum):
    """The matter that a preset shows: a thin disk, or a volume in its place."""

    AUTO = 0
    THIN = 1
    DEEP = 2


class VolumeResolution(enum.IntEnum):
    """The rays that matter with depth is summed along."""

    FULL = 0
    HALF = 1


class Method(enum.IntEnum):
    """How light is followed."""

    AUTO = 0
    RK4 = 1
    ADAPTIVE = 2


class View(enum.IntEnum):
    """The quantity that pixels show: light, or a value."""

    LIGHT = 0
    REDSHIFT = 1
    ORDER = 2
    DEFLECTION = 3
    STEPS = 4
    METRIC = 5
    OPTICAL_DEPTH = 6
    INTENSITY = 7


class OutputKind(enum.IntEnum):
    """The kinds of outputs of a frame; all but LIGHT are numbers of the one ray through a pixel's centre."""

    LIGHT = 0
    DEPTH = 1
    SKY = 2
    TRANSMISSION = 3
    POSITION = 4
    DISK = 5
    VIEW = 6


class Fate(enum.IntEnum):
    """How a ray ends."""

    CAPTURED = 0
    ESCAPED = 1
    UNRESOLVED = 2
    INVALID = 3
