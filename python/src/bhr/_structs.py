# SPDX-License-Identifier: MIT OR Apache-2.0
"""The structs of bhr.h as frozen dataclasses: a changed copy is made by `replace`, and takes effect when it is set.
Their defaults are those of the library. bhr.h says at length what each field means."""

from __future__ import annotations

import dataclasses
import enum
import operator
from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, TypeVar, Union

import numpy as np
import numpy.typing as npt

from ._constants import (
    AdapterFlags,
    Backend,
    ColourMap,
    ColourMapName,
    DiskFlags,
    DiskReference,
    DiskReferenceName,
    EmissionLaw,
    EmissionLawName,
    Eye,
    EyeName,
    Flow,
    FlowName,
    HotSpotFlags,
    MatrixFlags,
    Method,
    MethodName,
    Motion,
    MotionName,
    Projection,
    ProjectionName,
    SkyFlags,
    Status,
    ToneMap,
    ToneMapName,
    VolumeFlags,
    VolumeResolution,
    VolumeResolutionName,
    VolumeShape,
    VolumeShapeName,
)
from ._ffi import ffi
from ._library import begin, check, error, lib
from ._names import Named, flags as flags_of, member, named
from ._rays import RAY

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
VectorLike = Union[Sequence[float], npt.NDArray[Any]]

_Self = TypeVar("_Self", bound="_Struct")


def doubles(values: VectorLike, count: int, name: str) -> tuple[float, ...]:
    """The numbers as floats; cffi would take too few of them, and leave the rest 0."""
    numbers = tuple(float(value) for value in values)
    if len(numbers) != count:
        raise ValueError(f"{name} has {len(numbers)} numbers instead of {count}")
    return numbers


def _constant(kind: type[enum.IntEnum] | type[enum.IntFlag], value: object, name: str) -> enum.IntEnum | enum.IntFlag:
    return flags_of(kind, value, name) if issubclass(kind, enum.IntFlag) else member(kind, value, name)


def new(name: str) -> Any:
    """A C struct, cleared but for its size."""
    struct = ffi.new(f"{name} *")
    struct.struct_size = ffi.sizeof(name)
    return struct


class _Struct:
    """A dataclass whose fields are named as those of a C struct, and converted as that has them."""

    c_name: ClassVar[str]
    #: Fields that are enumerations.
    c_enums: ClassVar[dict[str, type[enum.IntEnum] | type[enum.IntFlag]]] = {}

    def __post_init__(self) -> None:
        types = dict(ffi.typeof(self.c_name).fields)
        for name in _names(type(self)):
            value = getattr(self, name)
            kind = types[name].type
            if name in self.c_enums:
                value = _constant(self.c_enums[name], value, name)
            elif kind.kind == "array" and kind.item.cname == "double":
                value = doubles(value, kind.length, name)
            elif kind.cname == "double":
                value = float(value)
            elif kind.kind == "primitive":
                value = operator.index(value)
            object.__setattr__(self, name, value)

    def replace(self: _Self, **changes: Any) -> _Self:
        """A copy with other values in these fields."""
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]

    @classmethod
    def c_of(cls, value: object, name: str, or_none: bool = False) -> Any:
        """The C struct of an argument, which `name` is for messages; NULL of None where None is allowed."""
        if or_none and value is None:
            return ffi.NULL
        if not isinstance(value, cls):
            wanted = f"bhr.{cls.__name__}" + (" or None" if or_none else "")
            raise TypeError(f"{name} is a {wanted}, not {type(value).__name__}")
        return value.to_c()

    @classmethod
    def array_of(cls, values: object, name: str) -> Any:
        """The C array of an argument that is a sequence of these structs."""
        if isinstance(values, _Struct) or not isinstance(values, Iterable):
            raise TypeError(f"{name} are a list of bhr.{cls.__name__}, not {type(values).__name__}")
        return ffi.new(f"{cls.c_name}[]", [cls.c_of(value, f"each of {name}")[0] for value in values])

    def to_c(self) -> Any:
        struct = new(self.c_name)
        for name in _names(type(self)):
            setattr(struct, name, getattr(self, name))
        return struct

    @classmethod
    def from_c(cls: type[_Self], struct: Any) -> _Self:
        types = dict(ffi.typeof(cls.c_name).fields)
        values = {}
        for name in _names(cls):
            value, kind = getattr(struct, name), types[name].type
            if kind.kind == "array":
                text = kind.item.cname == "char"
                value = ffi.string(value).decode("utf-8", "replace") if text else tuple(value)
            values[name] = value
        return cls(**values)


def _names(cls: type[_Struct]) -> list[str]:
    return [field.name for field in dataclasses.fields(cls)]  # type: ignore[arg-type]


#: The largest elevation of an orbit, with room for the rounding of single precision.
_POLE = 0.5 * np.pi + 1e-6


@dataclasses.dataclass(frozen=True)
class Camera(_Struct):
    """An observer with a lens. Lengths in scene units, angles in radians."""

    c_name: ClassVar[str] = "BhrCamera"
    c_enums = {"projection": Projection, "motion": Motion, "eye": Eye}

    position: Vector = (0.0, 26.0, 2.5)
    #: Any non-zero length.
    forward: Vector = (0.0, -26.0, -2.5)
    up: Vector = (0.0, 0.0, 1.0)
    #: The full vertical angle of PERSPECTIVE, (0, pi); across the circle of FISHEYE, (0, 2 pi].
    fov_y: float = 0.25 * np.pi
    projection: Named[Projection, ProjectionName] = named(Projection.PERSPECTIVE)
    motion: Named[Motion, MotionName] = named(Motion.STATIC)
    #: v / c for VELOCITY, against the local static observer (ZAMO).
    velocity: Vector = (0.0, 0.0, 0.0)
    #: The borders of a FRUSTUM's picture on the plane at distance 1 ahead, to the right and up.
    tan_left: float = -1.0
    tan_right: float = 1.0
    tan_down: float = -1.0
    tan_up: float = 1.0
    #: The picture of a PERSPECTIVE or a FRUSTUM moves by so many pixels to the right and down, each within +-1.
    jitter: tuple[float, float] = (0.0, 0.0)
    #: For EQUIRECT: the distance of two eyes, and for which of them the picture is.
    eye_distance: float = 0.0
    eye: Named[Eye, EyeName] = named(Eye.MIDDLE)

    @classmethod
    def orbit(cls, distance: float, azimuth: float, elevation: float, **fields: Any) -> Camera:
        """A camera that looks at the hole, at this distance from it, azimuth from +x towards +y, and elevation from the
        xy plane towards +z, -pi/2 .. pi/2. Angles are in radians: math.radians(20) makes them of degrees."""
        if abs(elevation) > _POLE:
            raise error(
                Status.INVALID_ARGUMENT,
                f"elevation is {elevation:g}, outside -pi/2 .. pi/2; angles are in radians: for degrees,"
                f" math.radians({elevation:g})",
            )
        struct = cls(**fields).to_c()
        check(lib.bhr_camera_orbit(struct, distance, azimuth, elevation))
        return cls.from_c(struct)

    @classmethod
    def look_at(
        cls, position: VectorLike, target: VectorLike = (0.0, 0.0, 0.0), up: VectorLike = (0.0, 0.0, 1.0), **fields: Any
    ) -> Camera:
        """A camera at a position that looks towards a target, by default the hole."""
        struct = cls(**fields).to_c()
        vectors = doubles(position, 3, "position"), doubles(target, 3, "target"), doubles(up, 3, "up")
        check(lib.bhr_camera_look_at(struct, *vectors))
        return cls.from_c(struct)

    @classmethod
    def from_matrices(
        cls, view: npt.ArrayLike, projection: npt.ArrayLike, flags: int | str = MatrixFlags(0), **fields: Any
    ) -> Camera:
        """A camera from the matrices of a rasteriser, 4 x 4, as they multiply column vectors."""
        struct = cls(**fields).to_c()
        matrices = [doubles(np.asarray(m, float).ravel(), 16, "a matrix") for m in (view, projection)]
        layout = flags_of(MatrixFlags, flags, "flags") | MatrixFlags.ROW_MAJOR
        check(lib.bhr_camera_from_matrices(struct, *matrices, layout))
        return cls.from_c(struct)

    def matrices(
        self, width: int, height: int, near_z: float, far_z: float = np.inf, flags: int | str = MatrixFlags(0)
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """View and projection, 4 x 4, as they multiply column vectors, for frames of this size."""
        view, projection = np.zeros((4, 4)), np.zeros((4, 4))
        outs = [ffi.cast("double *", m.ctypes.data) for m in (view, projection)]
        layout = flags_of(MatrixFlags, flags, "flags") | MatrixFlags.ROW_MAJOR
        check(lib.bhr_camera_matrices(self.to_c(), width, height, near_z, far_z, layout, *outs))
        return view, projection


@dataclasses.dataclass(frozen=True)
class Disk(_Struct):
    """A thin accretion disk in the equatorial plane, by default the golden one of the preset CINEMATIC."""

    c_name: ClassVar[str] = "BhrDisk"
    c_enums = {"flags": DiskFlags, "reference": DiskReference, "emission_law": EmissionLaw}

    #: In M; the disk does not begin inside the ISCO, or with PLUNGES inside the horizon.
    inner_radius: float = 0.0
    #: In M.
    outer_radius: float = 17.0
    #: Kelvin, at the ring that `reference` says.
    temperature: float = 3500.0
    opacity: float = 1.0
    #: The luminance of that ring at rest.
    brightness: float = 0.6
    #: The contrast of the structure that orbits with the matter, 0 .. 1.
    turbulence: float = 1.0
    seed: int = 0
    flags: Named[DiskFlags, str] = named(DiskFlags(0))
    reference: Named[DiskReference, DiskReferenceName] = named(DiskReference.AT_MEDIAN)
    emission_law: Named[EmissionLaw, EmissionLawName] = named(EmissionLaw.ISOTROPIC)
    edge_softness: float = 0.4


@dataclasses.dataclass(frozen=True)
class Volume(_Struct):
    """Matter with depth, which shines and absorbs; by default a soft disk. Radii are in M."""

    c_name: ClassVar[str] = "BhrVolume"
    c_enums = {"flags": VolumeFlags, "shape": VolumeShape, "flow": Flow}

    shape: Named[VolumeShape, VolumeShapeName] = named(VolumeShape.DISK)
    flow: Named[Flow, FlowName] = named(Flow.KEPLERIAN)
    flags: Named[VolumeFlags, str] = named(VolumeFlags(0))
    #: DISK, JET: the inner edge; OUTFLOW: where matter is at rest. 0: the ISCO.
    inner_radius: float = 0.0
    #: Nothing is beyond it.
    outer_radius: float = 17.0
    #: TORUS: the ring's; HALO: the scale; JET: where it opens by `opening`.
    radius: float = 8.0
    #: TORUS: its Gaussian width in R.
    width: float = 2.0
    #: The Gaussian width in cos th; TORUS: in z, over `radius`.
    thickness: float = 0.05
    #: JET: half the angle of its cone, radians.
    opening: float = 0.3
    #: DISK, JET: density goes as r^-slope.
    slope: float = 0.7
    #: Per M at density 1.
    absorption: float = 3.0
    #: Kelvin, at the inner edge or at `radius`.
    temperature: float = 4800.0
    #: The temperature goes as r^-temperature_slope.
    temperature_slope: float = 0.35
    #: POWER_LAW.
    spectral_index: float = 1.0
    #: POWER_LAW: its colour, linear Rec. 709.
    tint: Vector = (1.0, 1.0, 1.0)
    #: The luminance of opaque matter at rest; of a power law, of 1 M of density 1.
    brightness: float = 1.0
    sub_keplerian: float = 1.0
    #: 0 circular .. 1 free fall.
    infall: float = 0.0
    angular_momentum: float = 1.0
    #: OUTFLOW: far away, in units of c.
    speed: float = 0.9
    #: The contrast of structure that the matter carries along; 0: even.
    turbulence: float = 1.0
    #: Density goes as pattern^clumping.
    clumping: float = 1.8
    #: The temperature goes as pattern^heating.
    heating: float = 0.15
    seed: int = 0


@dataclasses.dataclass(frozen=True)
class HotSpot(_Struct):
    """A glowing blob on a circular geodesic in the equatorial plane. Lengths are in M."""

    c_name: ClassVar[str] = "BhrHotSpot"
    c_enums = {"flags": HotSpotFlags}

    radius: float = 8.0
    #: Its Gaussian width.
    size: float = 0.8
    #: At scene time 0, radians.
    azimuth: float = 0.0
    flags: Named[HotSpotFlags, str] = named(HotSpotFlags(0))
    #: Per M at the centre.
    absorption: float = 0.0
    #: Kelvin.
    temperature: float = 10000.0
    #: Without THERMAL.
    spectral_index: float = 1.0
    #: Without THERMAL: its colour, linear Rec. 709.
    tint: Vector = (1.0, 1.0, 1.0)
    brightness: float = 1.0


@dataclasses.dataclass(frozen=True)
class Sky(_Struct):
    """Everything that lies at infinity."""

    c_name: ClassVar[str] = "BhrSky"
    c_enums = {"flags": SkyFlags}

    flags: Named[SkyFlags, str] = named(SkyFlags.STARS | SkyFlags.MILKY_WAY)
    stars_brightness: float = 1.0
    #: A factor on the light of the Milky Way and of the map.
    map_brightness: float = 1.0
    #: The unit quaternion x y z w that takes J2000 equatorial axes to scene axes.
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    seed: int = 0


@dataclasses.dataclass(frozen=True)
class Film(_Struct):
    """How light becomes the pixels of 8-bit formats."""

    c_name: ClassVar[str] = "BhrFilm"
    c_enums = {"tone_map": ToneMap, "colour_map": ColourMap}

    tone_map: Named[ToneMap, ToneMapName] = named(ToneMap.ACES)
    #: Stops, -20 .. 20.
    exposure_ev: float = 0.0
    #: Glare, 0 .. 1: the share of the light that optics scatter.
    bloom: float = 0.25
    #: The full width at half maximum of a telescope's beam, in frame heights; 0: off.
    beam_fwhm: float = 0.0
    colour_map: Named[ColourMap, ColourMapName] = named(ColourMap.NONE)


@dataclasses.dataclass(frozen=True)
class Quality(_Struct):
    """How exactly to trace."""

    c_name: ClassVar[str] = "BhrQuality"
    c_enums = {"method": Method, "volume_resolution": VolumeResolution}

    method: Named[Method, MethodName] = named(Method.AUTO)
    #: 1 .. 256.
    samples_per_pixel: int = 1
    #: Steps of an integrated ray, 16 .. 100000.
    max_steps: int = 2000
    #: RK4: 1e-3 .. 0.5; 0 means the default, 0.1.
    step: float = 0.0
    #: ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0 means the default, 1e-10.
    tolerance: float = 0.0
    #: Images of the disk to follow, 0 .. 15.
    max_disk_order: int = 3
    #: For windows, which this package does not have.
    render_scale: float = 1.0
    #: HALF: a quarter of the rays where matter with depth is smooth.
    volume_resolution: Named[VolumeResolution, VolumeResolutionName] = named(VolumeResolution.FULL)


@dataclasses.dataclass(frozen=True)
class ProjectedPoint(_Struct):
    """Where on the screen a point of the scene appears."""

    c_name: ClassVar[str] = "BhrProjectedPoint"

    #: 0: there is no such image, or none was found.
    found: int
    #: 1: it lies within the image.
    on_screen: int
    #: 1: none was found, though there may be one.
    lost: int
    #: Pixels; NaN behind a flat picture.
    x: float
    y: float
    #: The ray to the point: a record of the dtype RAY.
    ray: Any
    #: Solid angle by that in flat space; negative where the image is mirrored.
    magnification: float
    #: Coordinate time since the light left, scene lengths.
    delay: float
    #: nu(camera) / nu(observer at rest at the point).
    redshift: float
    #: Straight, from the camera to the point: the depth that belongs to the image.
    distance: float
    #: As far from the camera as the point, in the direction in which it is seen: where a rasteriser draws it.
    apparent: tuple[float, float, float]

    @classmethod
    def from_c(cls: type[_Self], struct: Any) -> _Self:
        names = [name for name in _names(cls) if name not in ("ray", "apparent")]
        ray = np.frombuffer(ffi.buffer(ffi.addressof(struct.ray)), RAY)[0].copy()
        values: dict[str, Any] = {name: getattr(struct, name) for name in names}
        values.update(ray=ray, apparent=tuple(struct.apparent))
        return cls(**values)


@dataclasses.dataclass(frozen=True)
class Region(_Struct):
    """The part of a larger frame that an image holds: for tiles, dome walls and render farms."""

    c_name: ClassVar[str] = "BhrRegion"

    full_width: int
    full_height: int
    x: int = 0
    y: int = 0


@dataclasses.dataclass(frozen=True)
class HoleInfo(_Struct):
    """Numbers about the hole and the camera's observer, in scene lengths; NaN where not defined."""

    c_name: ClassVar[str] = "BhrHoleInfo"

    horizon_radius: float
    ergosphere_equatorial_radius: float
    photon_orbit_prograde: float
    photon_orbit_retrograde: float
    isco_prograde: float
    isco_retrograde: float
    #: Without spin; NaN with spin.
    critical_impact_parameter: float
    #: Without spin, as the camera's observer sees the shadow, radians; NaN with spin.
    shadow_angular_radius: float
    camera_radius: float
    #: d tau / d t of the camera's observer.
    camera_time_rate: float


@dataclasses.dataclass(frozen=True)
class FrameStats(_Struct):
    """Numbers about a finished frame. Times in nanoseconds."""

    c_name: ClassVar[str] = "BhrFrameStats"

    frame_index: int
    rays: int
    steps: int
    cpu_ns: int
    gpu_ns: int
    readback_ns: int
    device_bytes: int
    #: Lens tables made for the frame; 0 where those of an earlier one served.
    lens_tables: int


@dataclasses.dataclass(frozen=True)
class AdapterInfo(_Struct):
    """Hardware, or a software driver, that can trace."""

    c_name: ClassVar[str] = "BhrAdapterInfo"
    c_enums = {"backend": Backend, "flags": AdapterFlags}

    name: str
    driver: str
    backend: Backend
    flags: AdapterFlags
    vendor_id: int
    device_id: int


def adapters() -> list[AdapterInfo]:
    """The adapters of this machine; the position in the list is Context's adapter_index. The CPU tracer is the last."""
    begin()
    count = ffi.new("uint32_t *")
    check(lib.bhr_adapter_count(count))
    found = []
    for index in range(count[0]):
        info = new("BhrAdapterInfo")
        check(lib.bhr_adapter_info(index, info))
        found.append(AdapterInfo.from_c(info))
    return found
